// SPDX-License-Identifier: Apache-2.0
#include "tuina/robot/table/read_urdf.hpp"

#include <doctest/doctest.h>

#include "tuina/core/random.hpp"
#include "tuina/robot/arm_model.hpp"
#include "tuina/robot/robot_model.hpp"
#include "tuina/robot/table/robot_table.hpp"

using namespace tuina;
using namespace tuina::robot;

namespace {

std::string urdf_of(const char* name) {
  const RobotModel model = load_robot(name).value();
  return to_urdf(
      describe(place_robot(model, BodyPosture::sitting).mount, {.of = {model.arm, model.arm}}));
}

std::string with(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  REQUIRE(at != std::string::npos);
  return text.replace(at, from.size(), to);
}

void refused(const std::string& text, const std::string& sentence, const char* tip = "left_tool") {
  const auto arm = read_urdf(text, "arm.urdf", "rail", tip);
  REQUIRE_FALSE(arm.has_value());
  CAPTURE(arm.error().message);
  CHECK(arm.error().message.starts_with("arm.urdf:"));
  CHECK(arm.error().message.find(sentence) != std::string::npos);
}

/// Where a joint of an arm stands on the one before, about whose z it turns.
struct Step {
  Vector3 xyz, rpy;
};

std::string urdf_of(const std::vector<Step>& steps) {
  std::string text = "<robot name=\"steps\"><link name=\"rail\"/>";
  for (std::size_t i = 1; i <= steps.size(); ++i) {
    const auto& [xyz, rpy] = steps[i - 1];
    text += fmt::format(
        "<link name=\"l{0}\"><inertial><mass value=\"1\"/><inertia ixx=\"0.02\" ixy=\"0\" "
        "ixz=\"0\" iyy=\"0.02\" iyz=\"0\" izz=\"0.02\"/></inertial></link><joint name=\"j{0}\" "
        "type=\"revolute\"><origin xyz=\"{2} {3} {4}\" rpy=\"{5} {6} {7}\"/><parent "
        "link=\"{1}\"/><child link=\"l{0}\"/><axis xyz=\"0 0 1\"/><limit lower=\"-3\" upper=\"3\" "
        "effort=\"150\" velocity=\"2\"/></joint>",
        i, i == 1 ? "rail" : fmt::format("l{}", i - 1), xyz.x(), xyz.y(), xyz.z(), rpy.x(), rpy.y(),
        rpy.z());
  }
  return text + "</robot>";
}

/// How far the tip of the read arm is at the most from where the file's own chain has it.
double worst_tip_m(const std::vector<Step>& steps, const UrdfArm& arm) {
  RobotMount mount;
  mount.base_from_shoulder[Arm::left] = arm.link_from_shoulder;
  const ArmModel model(arm.table, mount, Arm::left);
  Random random = make_random(6, "steps");
  double worst_m = 0.0;
  for (int n = 0; n < 2'000; ++n) {
    JointVector q(6);
    for (double& angle : q) angle = uniform(random, -3.0, 3.0);
    Transform tip = Transform::Identity();
    for (std::size_t i = 0; i < steps.size(); ++i) {
      const Vector3& rpy = steps[i].rpy;
      tip = tip * Eigen::Translation3d(steps[i].xyz) *
            Eigen::AngleAxisd(rpy.z(), Vector3::UnitZ()) *
            Eigen::AngleAxisd(rpy.y(), Vector3::UnitY()) *
            Eigen::AngleAxisd(rpy.x(), Vector3::UnitX()) *
            Eigen::AngleAxisd(q[static_cast<Eigen::Index>(i)], Vector3::UnitZ());
    }
    worst_m =
        std::max(worst_m, (tip.translation() - model.base_from_tool(q, 0.0).translation()).norm());
    CHECK((tip.linear() - model.base_from_tool(q, 0.0).linear()).cwiseAbs().maxCoeff() < 1e-3);
  }
  return worst_m;
}

/// An arm whose upper arm, forearm and wrist turn about parallel axes, as CAD exports it.
std::vector<Step> arm_of(double half_turn, double skew) {
  const double quarter = 0.5 * half_turn;
  return {
      {{0.0, 0.0, 0.122}, {0.0, 0.0, half_turn}},   {{0.0, 0.1215, 0.0}, {-quarter, -quarter, 0.0}},
      {{0.408, 0.0, 0.0}, {-half_turn, skew, 0.0}}, {{0.376, 0.0, 0.0}, {half_turn, 0.0, quarter}},
      {{0.0, 0.1025, 0.0}, {-quarter, 0.0, 0.0}},   {{0.0, -0.094, 0.0}, {quarter, 0.0, 0.0}}};
}

}  // namespace

TEST_CASE("axes that are too far from parallel for a table are refused by the names of joints") {
  const std::pair<double, const char*> angles[] = {
      {3.14, "joints 3 and 4 are 0.0913 degrees from parallel, and their common normal lies"},
      {3.142, "joints 3 and 4 are 0.0233 degrees from parallel, and their common normal lies"}};
  for (const auto& [half_turn, sentence] : angles)
    refused(urdf_of(arm_of(half_turn, 0.0)), sentence, "l6");
}

TEST_CASE("axes that are parallel but for the rounding of their angles are taken as parallel") {
  struct Case {
    double half_turn, skew, max_off_m;
    const char* note;
  };
  for (
      const auto& [half_turn, skew, max_off_m, note] :
      {Case{pi, 0.0, 1e-9, ""},
       {3.1416, 0.0, 0.01e-3,
        "joints 2 and 3 are 0.00042, 3 and 4 are 0.00042 degrees from parallel: taken as parallel"},
       {3.141593, 0.0, 1e-6,
        "joints 2 and 3 are 0.00002, 3 and 4 are 0.00002 degrees from parallel: taken as parallel"},
       // The fourth is exactly parallel to the third, and follows it.
       {pi, 9e-5, 0.2e-3, "joints 2 and 3 are 0.00516 degrees from parallel: taken as parallel"}}) {
    const std::vector<Step> steps = arm_of(half_turn, skew);
    const auto arm = read_urdf(urdf_of(steps), "arm.urdf", "rail", "l6");
    REQUIRE_MESSAGE(arm.has_value(), arm.error().message);
    CHECK(arm->note == note);
    const double off_m = worst_tip_m(steps, *arm);
    MESSAGE("at most ", 1e3 * off_m, " mm off");
    CHECK(off_m < max_off_m);
    // What is written is read again.
    RobotModel model = load_robot("thesis").value();
    model.arm = arm->table;
    for (Link& link : model.arm.links) link.rotor_inertia_kg_m2 = 0.1;
    const auto again = parse_robot(to_toml(model), "arm.toml");
    CHECK_MESSAGE(again.has_value(), again.error().message);
  }
}

TEST_CASE("every shipped arm, written as URDF and read again, moves and weighs as before") {
  for (const char* name : {"thesis", "successor", "panda", "ur"}) {
    CAPTURE(name);
    RobotModel model = load_robot(name).value();
    model.carrier = Carrier::linear_base;
    const RobotMount mount = place_robot(model, BodyPosture::sitting).mount;
    const std::string text = to_urdf(describe(mount, {.of = {model.arm, model.arm}}));
    auto read = read_urdf(text, "arm.urdf", "rail", "right_tool");
    REQUIRE_MESSAGE(read.has_value(), read.error().message);
    ArmTable& table = read->table;
    for (int i = 0; i < table.joints; ++i) {
      const auto k = static_cast<std::size_t>(i);
      const Link& link = model.arm.links[k];
      CHECK(table.links[k].max_rad == link.max_rad);
      CHECK(table.links[k].torque_limit_nm == link.torque_limit_nm);
      CHECK(table.links[k].coulomb_nm == link.coulomb_nm);
      for (const double m : table.links[k].com_in_joint)  // nothing that rounding has left
        CHECK((m == 0.0 || std::abs(m) > 1e-9));
      table.links[k].rotor_inertia_kg_m2 = link.rotor_inertia_kg_m2;  // URDF has no place for it
    }
    RobotMount mounted;
    mounted.base_from_shoulder[Arm::right] = read->link_from_shoulder;
    const ArmModel before(model.arm, mount, Arm::right), after(table, mounted, Arm::right);
    Random random = make_random(4, "urdf round trip");
    double worst = 0.0;
    for (int n = 0; n < 1'000; ++n) {
      JointVector q(table.joints), dq(table.joints);
      for (int i = 0; i < table.joints; ++i) {
        q[i] = uniform(random, -pi, pi);
        dq[i] = uniform(random, -3.0, 3.0);
      }
      const ArmDynamics one = before.evaluate(q, dq, 0.0), other = after.evaluate(q, dq, 0.0);
      const auto differ = [&](const auto& a, const auto& b) {
        worst = std::max(worst, (a - b).cwiseAbs().maxCoeff());
      };
      differ(one.base_from_tool.matrix(), other.base_from_tool.matrix());
      differ(one.jacobian, other.jacobian);
      differ(one.jacobian_dot_dq, other.jacobian_dot_dq);
      differ(one.mass_kg_m2, other.mass_kg_m2);
      differ(one.coriolis_nm, other.coriolis_nm);
      differ(one.gravity_nm, other.gravity_nm);
    }
    CHECK(worst < 1e-9);
  }
}

TEST_CASE("joints about any axis, fixed ones between them and turned inertias are understood") {
  // The first joint turns about x, and the hand is a link of its own behind a fixed joint.
  std::string text = "<robot name=\"odd\"><link name=\"rail\"/>";
  for (int i = 1; i <= 6; ++i) {
    text += fmt::format(
        "<link name=\"l{0}\"><inertial><origin xyz=\"0.01 0.02 0.1\" rpy=\"0.3 0.1 0.2\"/><mass "
        "value=\"1\"/><inertia ixx=\"0.02\" ixy=\"0.001\" ixz=\"0\" iyy=\"0.03\" iyz=\"0\" "
        "izz=\"0.02\"/></inertial></link><joint name=\"j{0}\" type=\"revolute\"><origin "
        "xyz=\"0.02 0 0.2\" rpy=\"0.{0} 0 0\"/><parent link=\"{1}\"/><child link=\"l{0}\"/><axis "
        "xyz=\"{2}\"/><limit lower=\"-2\" upper=\"2\" effort=\"50\" velocity=\"2\"/></joint>",
        i, i == 1 ? "rail" : fmt::format("l{}", i - 1), i % 2 == 1 ? "2 0 0" : "0 1 0");
  }
  text +=
      "<link name=\"hand\"/><joint name=\"wrist\" type=\"fixed\"><origin xyz=\"0 0.1 0.1\" "
      "rpy=\"0 -1.5 0\"/><parent link=\"l6\"/><child link=\"hand\"/></joint>";
  // Two links that hang from each other.
  for (const char* pair : {"l6a", "ab", "ba"}) {
    const bool first = pair[0] == 'l';
    text += fmt::format(
        "{}<joint name=\"to_{}\" type=\"fixed\"><parent link=\"{}\"/><child link=\"{}\"/></joint>",
        first ? "<link name=\"a\"/><link name=\"b\"/>" : "", pair,
        first ? "l6" : std::string(1, pair[0]), first ? "a" : std::string(1, pair[1]));
  }
  // A camera beside the hand is carried; what is mounted on the hand gives way to the sphere.
  for (const char* parent : {"l6", "hand"}) {
    text += fmt::format(
        "<link name=\"on_{0}\"><inertial><mass value=\"0.5\"/><inertia ixx=\"0\" ixy=\"0\" "
        "ixz=\"0\" iyy=\"0\" iyz=\"0\" izz=\"0\"/></inertial></link><joint name=\"to_{0}\" "
        "type=\"fixed\"><origin xyz=\"0.1 0 0.3\"/><parent link=\"{0}\"/><child "
        "link=\"on_{0}\"/></joint>",
        parent);
  }
  text += "</robot>";
  const auto arm = read_urdf(text, "odd.urdf", "rail", "hand");
  REQUIRE_MESSAGE(arm.has_value(), arm.error().message);
  RobotMount mount;
  mount.base_from_shoulder[Arm::left] = arm->link_from_shoulder;
  const ArmModel model(arm->table, mount, Arm::left);
  Random random = make_random(5, "odd");
  for (int n = 0; n < 100; ++n) {
    JointVector q(6);
    for (double& angle : q) angle = uniform(random, -2.0, 2.0);
    Transform tool = Transform::Identity();
    double weight_nm = 0.0;  // about the first joint, whose axis is x
    for (int i = 1; i <= 6; ++i) {
      tool = tool * Eigen::Translation3d(0.02, 0.0, 0.2) *
             Eigen::AngleAxisd(0.1 * i, Vector3::UnitX()) *
             Eigen::AngleAxisd(q[i - 1], i % 2 == 1 ? Vector3::UnitX() : Vector3::UnitY());
      weight_nm += gravity_m_per_s2 * (tool * Vector3(0.01, 0.02, 0.1)).y();
    }
    weight_nm += 0.5 * gravity_m_per_s2 * (tool * Vector3(0.1, 0.0, 0.3)).y();
    tool = tool * Eigen::Translation3d(0.0, 0.1, 0.1) * Eigen::AngleAxisd(-1.5, Vector3::UnitY());
    CHECK((tool.matrix() - model.base_from_tool(q, 0.0).matrix()).cwiseAbs().maxCoeff() < 1e-9);
    CHECK(model.gravity_nm(q)[0] == doctest::Approx(weight_nm).epsilon(1e-9));
  }
}

TEST_CASE("what is no arm of six or seven joints is refused with line, element and value") {
  const std::string good = urdf_of("thesis");
  REQUIRE(read_urdf(good, "arm.urdf", "rail", "left_tool").has_value());
  refused("<robot", "is not XML");
  refused(" \n", "is empty");
  refused("<mujoco/>", "no element <robot>");
  refused(good, "there is no link called `hand`", "hand");
  refused(good, "no joints lead from `rail` down to `base`", "base");
  refused(good, "5 turning joints", "left_forearm_roll");
  refused(with(good, "name=\"left_elbow_joint\" type=\"revolute\"",
               "name=\"left_elbow_joint\" type=\"prismatic\""),
          "type = \"prismatic\": an arm has");
  refused(with(good, "effort=\"120\"", "effort=\"strong\""), "effort = \"strong\" is not 1 number");
  const auto first = good.find("<limit", good.find("left_shoulder_pitch_joint"));
  refused(std::string(good).erase(first, good.find("/>", first) + 2 - first),
          "left_shoulder_pitch_joint: <limit> is missing");
  refused(std::string(good).insert(first, "<mimic joint=\"left_elbow_joint\"/>"),
          "it follows another joint");
  const auto turn = good.find("<origin", good.find("name=\"left_elbow_joint\"")) + 7;
  refused(std::string(good).insert(turn, " quat_xyzw=\"0 0 0 1\""),
          "is not read; give the place by");
  refused(with(good, "<mass value=\"1.15\"/>", ""), "<mass> and <inertia> are both needed");
}
