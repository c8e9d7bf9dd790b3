// SPDX-License-Identifier: Apache-2.0
#include "tuina/telemetry/report/page.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include "tests/telemetry/sample_report.hpp"
#include "tests/telemetry/words.hpp"
#include "tuina/telemetry/plot/session_strip.hpp"
#include "tuina/telemetry/report/figures.hpp"

using namespace tuina;
using namespace tuina::telemetry;
using tests::count;
using tests::holds;
using tests::words_of;

namespace {

/// Made once: its pictures take most of the time of this suite.
const std::string& sample_page() {
  static const std::string page = report_page(tests::sample_report());
  return page;
}

ReportData sample_without_pictures() {
  ReportData data = tests::sample_report();
  data.scan_in_couch = {};
  return data;
}

}  // namespace

TEST_CASE("the report is one file of less than 3 MB that needs no network and no script") {
  const std::string& page = sample_page();
  CHECK(page.size() < 3'000'000);
  CHECK(page.starts_with("<!doctype html>"));
  CHECK(page.ends_with("</html>\n"));
  CHECK_FALSE(holds(page, "<script"));
  CHECK_FALSE(holds(page, "<link"));
  CHECK_FALSE(holds(page, "@import"));
  CHECK_FALSE(holds(page, "src="));
  CHECK(count(page, "http") == count(page, "http://www.w3.org/2000/svg"));
  CHECK(count(page, "href=") == count(page, "href=\"data:image/png;base64,"));
}

TEST_CASE("a path that got another force than asked for is told with its reason, no other is") {
  ReportData data = sample_without_pictures();
  REQUIRE(data.paths.size() >= 2);
  for (PerformedPath& path : data.paths) path.programme_n = path.ordered_n = path.given_n = 22.0;
  CHECK(holds(report_page(data), "Every place was given the force that the plan orders"));
  CHECK_FALSE(holds(report_page(data), "Given otherwise than asked for"));
  data.paths[0].ordered_n = data.paths[0].given_n = 18.0;
  data.paths[0].lowered_by = {"kidney"};
  data.paths[1].given_n = 18.1;
  data.paths[1].why = {"the person asked for it: softer"};
  const std::string page = report_page(data);
  CHECK(holds(page, "Given otherwise than asked for"));
  CHECK(holds(page, "lowered for kidney"));
  CHECK(holds(page, "the person asked for it: softer"));
  CHECK(holds(page, fmt::format("another force than ordered: 1 of {}", data.paths.size())));
}

TEST_CASE("the report says which arm has worked") {
  ReportData data = sample_without_pictures();
  for (PerformedPath& path : data.paths) path.arm = Arm::right;
  CHECK(holds(report_page(data), "The right arm pressed"));
  data.paths.front().arm = Arm::left;
  CHECK(holds(report_page(data), "Two arms pressed"));
  for (PerformedPath& path : data.paths) path.arm = Arm::left;
  CHECK(holds(report_page(data), "The left arm pressed"));
}

TEST_CASE(
    "the report shows every acupoint, technique, tissue with its truth, and the configuration") {
  const ReportData data = tests::sample_report();
  const std::string& page = sample_page();
  for (const FoundAcupoint& found : data.acupoints) {
    CHECK(holds(page, figures::spoken(found.acupoint.name)));
  }
  for (const char* words : {"Pressing", "Rubbing", "Root mean square error 1.21 N, peak 27.4 N",
                            "simulation only", "not settled", "hard muscle", "force_n = 25.0",
                            "had no cause to stop", "Nothing had to be stopped"}) {
    CAPTURE(words);
    CHECK(holds(page, words));
  }
  const auto moments = moments_of(data).size();
  CHECK(moments == 5);
  CHECK(count(page, "data:image/png;base64,") == 2 + moments);
}

TEST_CASE("before and after shows what changed, and that a change too small to tell is none") {
  const std::string page = words_of(sample_page());
  CHECK(holds(page, "SI11 left 3.00 2.70 -10.0 % 4.0 % softer"));
  CHECK(holds(page, "SI11 right 3.00 2.95 -1.7 % 4.0 % no detectable change"));
  ReportData once = sample_without_pictures();
  once.changes.clear();
  CHECK_FALSE(holds(report_page(once), "Before and after"));
}

TEST_CASE("the body condition is shown as probabilities with a caution, or not at all") {
  CHECK(holds(sample_page(), "medium build with 62 %"));
  CHECK(holds(sample_page(), "With caution"));
  ReportData data = sample_without_pictures();
  data.condition.reset();
  CHECK_FALSE(holds(report_page(data), "Body condition"));
}

TEST_CASE("a stop is on the page with its time and cause") {
  ReportData data = sample_without_pictures();
  data.stops = {{12.345, "contact force 68.4 N above the limit of 60 N"}};
  const std::string page = report_page(data);
  CHECK(holds(page, "12.345 s"));
  CHECK(holds(page,
              "stopped for safety after 12 seconds: contact force 68.4 N above the limit of 60 N"));
  CHECK_FALSE(holds(page, "Nothing had to be stopped"));
}

TEST_CASE("a path that was not carried out as planned is named with its trouble") {
  ReportData data = sample_without_pictures();
  CHECK_FALSE(holds(report_page(data), "Not carried out as planned"));
  data.paths[2].contact_fault = "no skin found";
  CHECK(holds(report_page(data), "right arm, press SI11_R: no skin found"));
}

TEST_CASE("what the plan has lowered or left out is on the page, with the reason") {
  ReportData data = sample_without_pictures();
  CHECK_FALSE(holds(report_page(data), "Planned otherwise than ordered"));
  data.plan_notes = {{"press BL23_L: 18 N instead of 25 N: the arm is felt as 5.1 kg there"}};
  CHECK(holds(report_page(data), "18 N instead of 25 N"));

  for (PerformedPath& path : data.paths) {
    path.ordered_n = path.given_n = 10.0;
    path.why = {};
    path.contact_fault.clear();
  }
  const std::string all_given = "Every place was given the force that the plan orders";
  CHECK(holds(report_page(data), all_given));
  data.left_out = {{"press BL47_L is left out: it is out of reach"}};
  const std::string page = report_page(data);
  CHECK_FALSE(holds(page, all_given));
  CHECK(holds(page, fmt::format("left out: 1 of {}", data.paths.size() + 1)));
  CHECK(holds(page, "press BL47_L is left out: it is out of reach"));
}

TEST_CASE("the mean error is that of the seven points, whatever further ones were found") {
  ReportData data = sample_without_pictures();
  data.acupoints.push_back({{.name = "BL13_L"}, 0.1});
  data.acupoints.push_back({{.name = "BL13_R"}, std::nullopt});
  const std::string page = words_of(report_page(data));
  CHECK(holds(page, "Acupoints 4.0 mm mean distance of 7 to the truth"));
  CHECK(holds(page, "the main seven were 4"));
}

TEST_CASE("points that no path goes to stand below the others") {
  ReportData data = sample_without_pictures();
  CHECK_FALSE(holds(report_page(data), "Found as well"));
  for (const char* name : {"BL13_L", "BL13_R", "BL15_L", "BL15_R"})
    data.acupoints.push_back({{.name = name}, 4e-3});
  const std::string page = report_page(data);
  CHECK(page.find("Found as well") < page.find("BL13 left"));
  CHECK(page.find(">SI11 left") < page.find("Found as well"));
  for (const char* name : {"BL13 left", "BL13 right", "BL15 left", "BL15 right"})
    CHECK(count(page, name) == 1);
}

TEST_CASE("text from outside cannot become markup") {
  ReportData data = sample_without_pictures();
  const std::string evil = "<img src=x onerror=alert(1)>\"'&\x01";
  data.person = data.programme = data.config_toml = data.version = evil;
  data.acupoints[0].acupoint.name = data.tissue[0].name = data.tissue[0].tissue_class = evil;
  data.paths[0].path.acupoints = {evil};
  data.stops = {{1.0, evil}};
  data.numbers = {{evil, evil, evil, evil}};
  const std::string page = report_page(data);
  CHECK_FALSE(holds(page, "<img"));
  CHECK_FALSE(holds(page, "\x01"));
  CHECK(holds(page, "&lt;img src=x onerror=alert(1)&gt;&quot;&#39;&amp;"));
}

TEST_CASE("a session that ended before anything was seen still gives a page that says so") {
  const std::string page = report_page(ReportData{.person = "nobody"});
  for (const char* words :
       {"There is no scan to show", "No acupoint was located", "No path was carried out",
        "There is no record of forces", "No tissue was estimated"}) {
    CAPTURE(words);
    CHECK(holds(page, words));
  }
}

TEST_CASE("the same session gives the same page byte for byte") {
  CHECK(report_page(tests::sample_report()) == sample_page());
}

TEST_CASE("the report shows what the tissue decided and how far the arms stayed apart") {
  ReportData data = sample_without_pictures();
  CHECK_FALSE(holds(report_page(data), "What the tissue decided"));
  data.decisions = {{.time_s = 9.8,
                     .arm = Arm::right,
                     .path = "press GV4 <b>",
                     .rule = "A3",
                     .reason = "hard enough",
                     .from_n = 22.0,
                     .to_n = 17.5}};
  data.distances = {{0.0, 0.2}, {1.0, 0.08}, {2.0, 0.2}};
  data.stopping_distance_m = 0.025;
  const std::string page = report_page(data);
  CHECK(holds(page, "What the tissue decided"));
  CHECK(holds(words_of(page), "press GV4 <b>"));
  data.decisions[0].path = data.paths[0].path.name;
  CHECK(holds(words_of(report_page(data)), "right press SI11 left A3"));
  CHECK(holds(page, "hard enough"));
  CHECK(holds(page, "arm to arm"));
  CHECK_FALSE(holds(page, "arm to person"));
  data.distances = {{0.0, 0.2, 0.15}, {1.0, 0.08, 0.09}};
  CHECK(holds(report_page(data), "arm to person"));
  CHECK_FALSE(holds(report_page(data), "arm to couch"));
  data.distances = {{0.0, 0.2, 0.15, 0.3, 0.1}, {1.0, 0.08, 0.09, 0.25, 0.07}};
  CHECK(holds(words_of(report_page(data)),
              "At the least: arm to arm 80 mm, arm to person 90 mm, arm to couch 250 mm, "
              "arm to the robot's body 70 mm."));
}
