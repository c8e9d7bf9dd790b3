// SPDX-License-Identifier: Apache-2.0
#include "tuina/record/plan_file.hpp"

#include <doctest/doctest.h>

#include "tests/massage/backs.hpp"
#include "tests/reason.hpp"
#include "tuina/record/acupoint_file.hpp"

using namespace tuina;
using namespace tuina::record;

namespace {

std::string acupoints_text(
    const std::string& gv4 =
        R"({"position_m": [0, 0.1, 0.28], "normal": [0, 1, 0], "uncertainty_mm": 6})") {
  std::string points;
  for (const char* name : seven_acupoints) {
    if (std::string(name) == "GV4") continue;
    points += fmt::format(
        R"("{}": {{"position_m": [0.08, 0.1, 0.4], "normal": [0, 1, 0], "uncertainty_mm": 8.5}},)",
        name);
  }
  return R"({"method": "surface", "position": "sitting", "acupoints": {)" + points +
         "\"GV4\": " + gv4 + R"(}, "landmarks": {"C7": [0, 0.1, 0.65]}})";
}

std::string fault_of(const std::string& text) {
  const auto back = parse_acupoints(text, "points.json");
  REQUIRE_FALSE(back.has_value());
  CHECK(back.error().fault == Fault::bad_input);
  return back.error().message;
}

}  // namespace

TEST_CASE("acupoints.json says position, points and landmarks") {
  const auto back = parse_acupoints(acupoints_text(), "points.json");
  REQUIRE_MESSAGE(back.has_value(), test::reason(back));
  CHECK(back->position == BodyPosture::sitting);
  REQUIRE(back->acupoints.size() == 7);
  CHECK(back->acupoints[0].name == "BL47_L");
  CHECK(back->acupoints[0].uncertainty_m == doctest::Approx(0.0085));
  REQUIRE(back->landmarks.size() == 1);
  CHECK(back->landmarks[0].at_in_couch == Vector3(0.0, 0.1, 0.65));
}

TEST_CASE("a wrong acupoints.json is refused with the name of what is wrong") {
  CHECK(fault_of("{").find("points.json:1: the JSON ends too early") != std::string::npos);
  CHECK(fault_of("[]").find("no object `acupoints`") != std::string::npos);
  CHECK(fault_of(R"({"acupoints": {}})").find("lacks SI11_L, SI11_R") != std::string::npos);
  CHECK(fault_of(R"({"acupoints": {}, "position": "lying"})").find("\"sitting\" or \"prone\"") !=
        std::string::npos);
  CHECK(fault_of(acupoints_text("3")).find("acupoints.GV4 has no position_m") != std::string::npos);
  CHECK(fault_of(acupoints_text(
                     R"({"position_m": [0, null, 1], "normal": [0, 1, 0], "uncertainty_mm": 6})"))
            .find("GV4.position_m is not three numbers") != std::string::npos);
  CHECK(fault_of(acupoints_text(
                     R"({"position_m": [0, 100, 280], "normal": [0, 1, 0], "uncertainty_mm": 6})"))
            .find("metres are needed") != std::string::npos);
  CHECK(fault_of(acupoints_text(
                     R"({"position_m": [0, 0.1, 0.28], "normal": [0, 2, 0], "uncertainty_mm": 6})"))
            .find("normal has length 2.000") != std::string::npos);
  CHECK(
      fault_of(acupoints_text(
                   R"({"position_m": [0, 0.1, 0.28], "normal": [0, 1, 0], "uncertainty_mm": -6})"))
          .find("uncertainty_mm is not a number from 0 to 1000") != std::string::npos);
}

TEST_CASE("a plan that is written is the plan that is read, to a micrometre and a microsecond") {
  const body::BackSurface back = test::back_of(test::barrel_y, 0.7_mm);
  const auto points = test::seven_points(back, 8_mm);
  const PlanFile file{
      .plan = massage::plan(back, points, {}, massage::load_programme("relax").value()).value(),
      .reachable = true,
      .min_arm_distance_m = 0.0714,
      .rail_m = -0.02,
      .compute_ms = 12.5};
  const auto again = parse_plan(to_json(file), "plan.json");
  REQUIRE_MESSAGE(again.has_value(), test::reason(again));
  CHECK(to_json(*again) == to_json(file));
  REQUIRE(again->plan.paths.size() == file.plan.paths.size());
  for (std::size_t i = 0; i < file.plan.paths.size(); ++i) {
    const auto& one = file.plan.paths[i];
    const auto& two = again->plan.paths[i];
    CHECK(one.path.name == two.path.name);
    CHECK(one.zone == two.zone);
    CHECK(one.arm == two.arm);
    CHECK((one.path.points.back().at_in_couch - two.path.points.back().at_in_couch).norm() < 2e-6);
  }
}

TEST_CASE("what is no plan is refused") {
  for (const char* text : {"", "{", "[]", "{}", R"({"programme": 3})"}) {
    CHECK(parse_plan(text, "plan.json").error().message.starts_with("plan.json:"));
  }
}
