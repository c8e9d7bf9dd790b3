// SPDX-License-Identifier: Apache-2.0
#include "tuina/telemetry/plot/session_strip.hpp"

#include <doctest/doctest.h>

#include "tests/telemetry/sample_report.hpp"
#include "tests/telemetry/words.hpp"
#include "tuina/telemetry/report/figures.hpp"

using namespace tuina;
using namespace tuina::telemetry;
using tests::count;

namespace {

PerformedPath done(Arm arm, double begin_s, double end_s) {
  return {.arm = arm, .begin_s = begin_s, .path = {.name = "press"}, .end_s = end_s};
}

}  // namespace

TEST_CASE("what both arms did together is one moment, what they did in turn are two") {
  ReportData data;
  data.paths = {done(Arm::right, 1.0, 5.0), done(Arm::left, 1.5, 5.5), done(Arm::left, 8.0, 12.0),
                done(Arm::right, 11.0, 15.0), done(Arm::right, 20.0, 24.0)};
  const auto moments = moments_of(data);
  REQUIRE(moments.size() == 4);
  REQUIRE(moments[0].paths.size() == 2);
  CHECK(moments[0].paths[0]->arm == Arm::left);
  CHECK(moments[0].end_s == 5.5);
  CHECK(moments[1].paths.size() == 1);
  CHECK(moments[2].begin_s == 11.0);
  CHECK(moments[3].begin_s == 20.0);
}

TEST_CASE("a path is called by its place as people say it") {
  CHECK(figures::place_of({.name = "press SI11_L", .acupoints = {"SI11_L"}}) == "SI11 left");
  CHECK(figures::place_of({.name = "stroke bladder_inner_R"}) == "bladder inner right");
  CHECK(figures::place_of(
            {.name = "stroke SI11_R to BL50_R", .acupoints = {"SI11_R", "BL47_R", "BL50_R"}}) ==
        "SI11 right to BL50 right");
}

TEST_CASE("a long session shows a dozen of its moments, the first and the last among them") {
  ReportData data = tests::sample_report();
  // A picture of a few points is quickly made.
  PointCloud fewer;
  for (std::size_t i = 0; i < data.scan_in_couch.points.size(); i += 3)
    fewer.points.push_back(data.scan_in_couch.points[i]);
  data.scan_in_couch = fewer;
  CHECK(count(session_strip(data), "<figure>") == moments_of(data).size());
  const ContactPath path = data.paths.front().path;
  data.paths.clear();
  for (int i = 0; i < 30; ++i)
    data.paths.push_back({.arm = Arm::left, .begin_s = 10.0 * i, .path = path});
  const std::string strip = session_strip(data);
  CHECK(count(strip, "<figure>") == max_pictures);
  CHECK(strip.find("<b>0:00</b>") != std::string::npos);
  CHECK(strip.find("<b>4:50</b>") != std::string::npos);
}

TEST_CASE("an arm in a picture changes it, and only while it is there") {
  ReportData data = tests::sample_report();
  data.paths.resize(1);
  const std::string without = session_strip(data);
  CHECK(session_strip(data) == without);
  ArmsPose pose{.time_s = 3.0};
  pose.links[Arm::left] = {{Vector3(0.1, 0.5, 0.4), Vector3(0.1, 0.12, 0.4), 0.04}};
  data.poses = {pose};
  CHECK(session_strip(data) != without);
}

TEST_CASE("a timeline shows where an arm moved through the air and not where it stood still") {
  ReportData data{.duration_s = 10.0};
  data.paths = {done(Arm::left, 6.0, 8.0)};
  for (int i = 0; i <= 1000; ++i) {
    const double t = 0.01 * i;
    const double y = t < 2.0 ? 0.5 : std::max(0.5 - 0.1 * (t - 2.0), 0.3);
    data.trace.push_back({.time_s = t, .arm = Arm::left, .tool_in_couch = {0.0, y, 0.0}});
  }
  const std::string svg = figures::timeline(data);
  REQUIRE(count(svg, "moves through the air") == 1);
  const auto at = svg.find("moves through the air");
  CHECK(svg.substr(at, 40).find("(2.0 – 4.") != std::string::npos);
}
