// SPDX-License-Identifier: Apache-2.0
#include "tuina/robot/inverse_kinematics.hpp"
#include "tuina/robot/ready_posture.hpp"

#include <doctest/doctest.h>

#include "tests/allocation.hpp"
#include "tuina/core/random.hpp"

using namespace tuina;
using namespace tuina::robot;

namespace {

const ArmTable table = thesis_arm();
const RobotMount mount = mount_for(BodyPosture::sitting);
const ArmModel left(table, mount, Arm::left);
const ArmModel right(table, mount, Arm::right);
const PerArm<JointVector> ready = ready_posture(table, mount);

/// Straight ahead of the left shoulder, facing it.
ContactGoal ahead(double distance_m, double aside_m = 0.0, double up_m = 0.0) {
  return {.at_in_base = left.shoulder_in_base(0.0) + Vector3(distance_m, aside_m, up_m),
          .normal_in_base = -Vector3::UnitX()};
}

Vector3 foremost(const ArmModel& arm, const JointVector& q, const ContactGoal& goal) {
  return arm.base_from_tool(q, 0.0).translation() - table.tool_radius_m * goal.normal_in_base;
}

}  // namespace

TEST_CASE(
    "a found posture touches the goal with the sphere, upright, within the limits, elbow off the "
    "person") {
  Random random = make_random(1, "goals");
  for (int n = 0; n < 300; ++n) {
    ContactGoal goal = ahead(uniform(random, 0.36, 0.50), uniform(random, -0.15, 0.1),
                             uniform(random, -0.25, 0.1));
    goal.normal_in_base =
        Vector3(-1, uniform(random, -0.4, 0.4), uniform(random, -0.4, 0.4)).normalized();
    const ContactPosture posture = find_posture(left, 0.0, goal, ready[Arm::left]);
    REQUIRE(posture.reach == Reach::reached);
    CHECK((foremost(left, posture.q_rad, goal) - goal.at_in_base).norm() < 1e-4);
    const auto kinematics = left.kinematics(posture.q_rad, 0.0);
    const Vector3 axis = kinematics.base_from_tool.linear().col(0);
    CHECK(std::acos(std::min(1.0, -axis.dot(goal.normal_in_base))) ==
          doctest::Approx(posture.tilt_rad).epsilon(0.01));
    CHECK(posture.tilt_rad <= 20_deg + 2e-3);
    CHECK((kinematics.origins_in_base[3] - goal.at_in_base).dot(goal.normal_in_base) > 80_mm);
    for (int i = 0; i < 6; ++i) {
      const Link& link = table.links[static_cast<std::size_t>(i)];
      CHECK(posture.q_rad[i] > link.min_rad + 2_deg);
      CHECK(posture.q_rad[i] < link.max_rad - 2_deg);
    }
    CHECK(posture.dexterity > 0.0);
  }
}

TEST_CASE("a deeper press holds the sphere deeper by as much") {
  const ContactGoal goal = ahead(0.45);
  const auto posture = find_posture(left, 0.0, goal, ready[Arm::left], {.press_depth_m = 8_mm});
  CHECK((foremost(left, posture.q_rad, goal) - goal.at_in_base - Vector3(8_mm, 0, 0)).norm() <
        1e-4);
}

TEST_CASE("what is out of reach is said to be, with the distance") {
  CHECK(find_posture(left, 0.0, ahead(0.9), ready[Arm::left]).reach == Reach::too_far);
  CHECK(find_posture(left, 0.0, ahead(0.7165), ready[Arm::left]).reach != Reach::reached);
  const std::vector<ContactGoal> path = {ahead(0.45), ahead(0.46), ahead(0.9)};
  const auto followed = follow(left, 0.0, path, ready[Arm::left]);
  REQUIRE_FALSE(followed.has_value());
  CHECK(followed.error().message.find("place 3 of 3") != std::string::npos);
  CHECK(followed.error().message.find("900 mm") != std::string::npos);
}

TEST_CASE("a rub and a long stroke are followed without a jump of any joint") {
  std::vector<ContactGoal> path;
  for (double s = 0.0; s <= 1.0; s += 0.004) path.push_back(ahead(0.44, -0.08, 0.12 - 0.3 * s));
  for (double turn = 0.0; turn < 2.0 * pi; turn += 0.02) {
    path.push_back(
        ahead(0.44, -0.08 + 30_mm * std::sin(turn), -0.18 - 30_mm + 30_mm * std::cos(turn)));
  }
  const auto followed = follow(left, 0.0, path, ready[Arm::left]);
  REQUIRE(followed.has_value());
  for (std::size_t i = 1; i < path.size(); ++i) {
    CHECK(((*followed)[i].q_rad - (*followed)[i - 1].q_rad).cwiseAbs().maxCoeff() < 0.05);
  }
}

TEST_CASE(
    "ready arms are mirror images, bent, level with each other and a hand's breadth off any back") {
  for (const auto position : {BodyPosture::sitting, BodyPosture::prone}) {
    const RobotMount here = mount_for(position);
    const ArmModel one(table, here, Arm::left), other(table, here, Arm::right);
    const auto q = ready_posture(table, here);
    const Transform a = one.base_from_tool(q[Arm::left], 0.0),
                    b = other.base_from_tool(q[Arm::right], 0.0);
    CHECK(a.translation().cwiseProduct(Vector3(1, -1, 1)).isApprox(b.translation(), 1e-9));
    const Vector3 pressing =
        position == BodyPosture::sitting ? Vector3(1, 0, 0) : Vector3(0, 0, -1);
    CHECK(a.linear().col(0).dot(pressing) > 0.999);
    CHECK((a.translation() - one.shoulder_in_base(0.0)).dot(pressing) < 0.27);
  }
}

TEST_CASE("the linear base goes where both arms reach everything, and says when none such is") {
  const PerArm<const ArmModel*> arms{.of = {&left, &right}};
  PerArm<std::vector<ContactGoal>> goals;
  for (const double up_m : {-0.15, 0.05}) {
    ContactGoal goal = ahead(0.62, -0.06, up_m);
    goals[Arm::left].push_back(goal);
    goal.at_in_base.y() *= -1.0;
    goals[Arm::right].push_back(goal);
  }
  const auto rail = choose_rail(arms, mount, goals, ready);
  REQUIRE(rail.has_value());
  CHECK(*rail >= 0.1);
  CHECK(*rail <= 0.3);
  goals[Arm::right].push_back(ahead(0.62, -1.5, 0.0));
  const auto none = choose_rail(arms, mount, goals, ready);
  REQUIRE_FALSE(none.has_value());
  CHECK(none.error().message.find("4 of 5") != std::string::npos);
}

TEST_CASE("finding a posture takes nothing from the heap, found or not") {
  const auto before = test::allocations();
  const auto near = find_posture(left, 0.0, ahead(0.45), ready[Arm::left]);
  const auto far = find_posture(left, 0.0, ahead(0.7165), ready[Arm::left]);
  CHECK(test::allocations() == before);
  CHECK(near.reach != far.reach);
}

TEST_CASE("a goal that is no number is out of reach") {
  const double nan = std::nan("");
  for (const ContactGoal& goal : {ContactGoal{.at_in_base = Vector3(nan, nan, nan)},
                                  ContactGoal{.at_in_base = ahead(0.4).at_in_base,
                                  .normal_in_base = Vector3(nan, 0.0, 0.0)}}) {
    CHECK(find_posture(left, 0.0, goal, ready[Arm::left]).reach != Reach::reached);
    const std::vector<ContactGoal> path = {ahead(0.4), goal};
    CHECK_FALSE(follow(left, 0.0, path, ready[Arm::left]).has_value());
  }
  CHECK(find_posture(left, 0.0, ahead(0.4), ready[Arm::left], {.press_depth_m = nan}).reach !=
        Reach::reached);
}
