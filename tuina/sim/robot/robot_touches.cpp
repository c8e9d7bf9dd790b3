// SPDX-License-Identifier: Apache-2.0
#include "tuina/sim/robot/robot_touches.hpp"

#include <algorithm>

#include "tuina/core/random.hpp"
#include "tuina/robot/ready_posture.hpp"

namespace tuina::sim {
namespace {

struct Spot {
  Vector3 at_in_couch;
  Vector3 normal_in_couch;
};

// Centre of a usual back.
Vector3 middle_in_couch(BodyPosture position) {
  return position == BodyPosture::sitting ? Vector3(0.0, 20_mm, 420_mm)
                                          : Vector3(0.0, -350_mm, 190_mm);
}

// Three columns, 120 mm apart, along 260 mm of a spine.
std::vector<Spot> spots_of(BodyPosture position, int rows) {
  std::vector<Spot> spots;
  for (int row = 0; row < rows; ++row) {
    const double along = rows > 1 ? 260_mm * (static_cast<double>(row) / (rows - 1) - 0.5) : 0.0;
    for (const double aside : {-120_mm, 0.0, 120_mm}) {
      const bool sitting = position == BodyPosture::sitting;
      const Vector3 from_middle = sitting ? Vector3(aside, 0.0, along) : Vector3(aside, along, 0.0);
      spots.push_back(
          {middle_in_couch(position) + from_middle, sitting ? Vector3::UnitY() : Vector3::UnitZ()});
    }
  }
  return spots;
}

Vector3 scatter(Random& random, double sd) {
  const double x = gaussian(random, sd), y = gaussian(random, sd), z = gaussian(random, sd);
  return {x, y, z};
}

}  // namespace

Result<std::vector<robot::Touch>> touch_board(const robot::ArmTable& table,
                                              const robot::RobotMount& mount, BodyPosture position,
                                              int rows, const TouchErrors& errors,
                                              std::uint64_t seed) {
  Random random = make_random(seed, "touches of the robot");
  const PerArm<robot::ArmModel> arms = robot::both_models(table, mount);
  const PerArm<JointVector> ready = robot::ready_posture(table, mount);
  PerArm<JointVector> zero_rad;
  for (const Arm arm : both_arms) {
    zero_rad[arm].resize(table.joints);
    for (double& q : zero_rad[arm]) q = gaussian(random, errors.joint_zero_rad);
  }
  const Vector3 middle_in_base = mount.base_from_couch * middle_in_couch(position);
  const double rail_m = position == BodyPosture::sitting
                            ? 0.0
                            : std::clamp(mount.rail_axis_in_base.dot(middle_in_base),
                                         mount.min_rail_m, mount.max_rail_m);
  std::vector<robot::Touch> touches;
  for (const Spot& spot : spots_of(position, rows)) {
    // Both arms touch the middle column, which ties their frames together.
    for (const Arm arm : both_arms) {
      const double side = arm == Arm::left ? 1.0 : -1.0;
      if (side * spot.at_in_couch.x() < 0.0) continue;
      const Vector3 led_to = spot.at_in_couch + scatter(random, errors.hand_m);
      const robot::ContactGoal goal{
          .at_in_base = mount.base_from_couch * led_to,
          .normal_in_base = mount.base_from_couch.linear() * spot.normal_in_couch};
      const auto posture = robot::find_posture(arms[arm], rail_m, goal, ready[arm]);
      const Vector3 written = spot.at_in_couch + scatter(random, errors.spot_m);
      if (posture.reach != robot::Reach::reached) continue;
      touches.push_back({.arm = arm,
                         .rail_m = rail_m,
                         .q_rad = posture.q_rad + zero_rad[arm],
                         .spot_in_couch = written,
                         .normal_in_couch = spot.normal_in_couch});
    }
  }
  if (touches.empty()) {
    return fail(Fault::bad_input, "no arm reaches any spot of the board");
  }
  return touches;
}

}  // namespace tuina::sim
