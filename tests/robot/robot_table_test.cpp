// SPDX-License-Identifier: Apache-2.0
#include "tuina/robot/table/robot_table.hpp"

#include <doctest/doctest.h>

#include "tests/folder.hpp"

using namespace tuina;
using namespace tuina::robot;

namespace {

std::string toml_of(std::string_view name) {
  for (const ShippedRobot& robot : shipped_robots()) {
    if (robot.name == name) return std::string(robot.toml);
  }
  return "";
}

/// The table of the thesis with one stretch of text changed.
Result<RobotModel> changed(const std::string& from, const std::string& to) {
  std::string text = toml_of("thesis");
  const auto at = text.find(from);
  REQUIRE(at != std::string::npos);
  text.replace(at, from.size(), to);
  return parse_robot(text, "mine.toml");
}

void refused(const std::string& from, const std::string& to, const std::string& sentence) {
  const auto model = changed(from, to);
  CAPTURE(to);
  REQUIRE_FALSE(model.has_value());
  CHECK(model.error().fault == Fault::config);
  CAPTURE(model.error().message);
  CHECK(model.error().message.find("mine.toml:") == 0);
  CHECK(model.error().message.find(sentence) != std::string::npos);
}

}  // namespace

TEST_CASE("the table of the thesis holds the numbers of its tables, to the last bit") {
  const ArmTable arm = load_robot("thesis")->arm;
  REQUIRE(arm.joints == 6);
  CHECK(arm.links[2].d_m == -300_mm);
  CHECK(arm.links[4].offset_rad == -180_deg);
  CHECK(arm.links[3].min_rad == -85_deg);
  CHECK(arm.links[3].max_rad == 60_deg);
  CHECK(arm.links[5].a_m == 100_mm);
  // The upper arm is a cylinder of 3.3 kg, 300 mm long and 100 mm thick.
  CHECK(arm.links[2].inertia_kg_m2[0] == 3.3 * (3.0 * 50_mm * 50_mm + 300_mm * 300_mm) / 12.0);
  CHECK(arm.links[2].inertia_kg_m2[2] == 3.3 * 50_mm * 50_mm / 2.0);
  // The fist: a handle of 0.34 kg up to the sphere of 0.16 kg at 100 mm.
  CHECK(arm.links[5].com_in_joint[0] ==
        doctest::Approx((0.34 * 41.5_mm + 0.16 * 100_mm) / 0.5).epsilon(1e-12));
  const ArmTable seven = load_robot("successor")->arm;
  REQUIRE(seven.joints == 7);
  CHECK(seven.links[6].com_in_joint == arm.links[5].com_in_joint);
  CHECK(seven.links[6].inertia_kg_m2 == arm.links[5].inertia_kg_m2);
}

TEST_CASE("a table that is written is read as the same robot") {
  for (const ShippedRobot& shipped : shipped_robots()) {
    CAPTURE(shipped.name);
    const RobotModel model = load_robot(shipped.name).value();
    const test::Folder folder;
    const auto again = load_robot(folder.with("again.toml", to_toml(model)));
    REQUIRE(again.has_value());
    for (std::size_t i = 0; i < max_joints; ++i) {
      const Link &one = model.arm.links[i], &other = again->arm.links[i];
      CHECK(one.name == other.name);
      CHECK(one.offset_rad == other.offset_rad);
      CHECK(one.d_m == other.d_m);
      CHECK(one.min_rad == other.min_rad);
      CHECK(one.gear_nm_per_rad == other.gear_nm_per_rad);
      CHECK(one.com_in_joint == other.com_in_joint);
      CHECK(one.inertia_products_kg_m2 == other.inertia_products_kg_m2);
    }
    CHECK(to_toml(*again) == to_toml(model));
    for (const BodyPosture position : {BodyPosture::sitting, BodyPosture::prone}) {
      const RobotMount one = place_robot(model, position).mount;
      const RobotMount other = place_robot(*again, position).mount;
      CHECK(one.base_from_couch.matrix() == other.base_from_couch.matrix());
      CHECK(one.ready_from_shoulder == other.ready_from_shoulder);
      for (const Arm arm : both_arms) {
        CHECK(one.base_from_shoulder[arm].matrix() == other.base_from_shoulder[arm].matrix());
      }
    }
  }
}

TEST_CASE("a robot that is not there is refused, and a near miss is told") {
  const auto near = load_robot("thesiss");
  REQUIRE_FALSE(near.has_value());
  CHECK(near.error().fault == Fault::usage);
  CHECK(near.error().message.find("is `thesis` meant?") != std::string::npos);
  CHECK(load_robot("absent/robot.toml").error().fault == Fault::file);
}

TEST_CASE("what no arm can be is refused with file, line, key, value and limit") {
  refused("mass_kg = 3.3", "mass_kg = -3.5", "mass_kg = -3.5 is not a number from 0.001 to 100");
  refused("limits_deg = [-85, 60]", "limits_deg = [60, -85]", "limits_deg = [60, -85] are not two");
  refused("alpha_deg = 90", "alfa_deg = 90", "is `alpha_deg` meant?");
  refused("name = \"elbow\"", "name = \"wrist\"", "is there twice");
  refused("name = \"elbow\"", "name = \"el<bow\"", "letters, digits");
  refused("inertia_kg_m2 = [", "inertia_kg_m2 = [9.0, 0.1, 0.1] #", "is that of no solid");
  refused("rotor_inertia_kg_m2 = 0.15", "rotor_inertia_kg_m2 = 0", "is no drive's");
  refused("left_shoulder_x = [0, 0, -1]", "left_shoulder_x = [0, -1, 0]", "right angle");
  refused("rail_mm = [-300, 350]", "rail_mm = [100, 350]", "does not hold zero");
  refused("carrier = \"linear_base\"", "carrier = \"balloon\"", "carrier = \"balloon\" is unknown");
  refused("edges_mm = [70, 400, 160]", "edges_mm = [70, 0, 160]", "lengths above zero");
  refused("mass_kg = 0.16", "mass_kg = 0.6", "is less than the tool's 0.6 kg");
  refused("torque_limit_nm = 120\n", "", "torque_limit_nm is missing");
}

TEST_CASE("all that is wrong is told at once, and an arm of five joints is one of it") {
  std::string text = toml_of("thesis");
  text.resize(text.rfind("[[link]]"));  // the wrist and all that comes after it
  const auto model = parse_robot("colour = \"red\"\n" + text, "mine.toml");
  REQUIRE_FALSE(model.has_value());
  for (const char* fault : {"`colour`", "[[link]]: 5 tables, 6 or 7 needed", "sitting, prone are"})
    CHECK(model.error().message.find(fault) != std::string::npos);
}
