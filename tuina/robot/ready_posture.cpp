// SPDX-License-Identifier: Apache-2.0
#include "tuina/robot/ready_posture.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "tuina/core/units.hpp"
#include "tuina/robot/clearance.hpp"
#include "tuina/robot/inverse_kinematics.hpp"

namespace tuina::robot {

PerArm<JointVector> ready_posture(const ArmTable& table, const RobotMount& mount) {
  const ArmModel left(table, mount, Arm::left);
  // The elbow stands outward: from there it leads to the postures that keep off the other arm.
  const ContactGoal goal{.at_in_base = left.shoulder_in_base(0.0) + mount.ready_from_shoulder,
                         .normal_in_base = -mount.ahead_in_base};
  const JointVector near = mount.ready_near_rad.size() == table.joints
                               ? mount.ready_near_rad
                               : JointVector(JointVector::Zero(table.joints));
  const PostureOptions outward{.elbow_outward_m = mount.ready_elbow_outward_m};
  const JointVector q = find_posture(left, 0.0, goal, near, outward).q_rad;
  const JointVector alike = mirrored(table, mount, q);
  const ArmModel right(table, mount, Arm::right);
  const Transform held = left.base_from_tool(q, 0.0), other = right.base_from_tool(alike, 0.0);
  const Vector3 across(1.0, -1.0, 1.0);
  const auto image = [&](const Vector3& v) { return Vector3(v.cwiseProduct(across)); };
  constexpr double same = 1e-6;
  if ((image(held.translation()) - other.translation()).norm() < same &&
      (image(held.linear().col(0)) - other.linear().col(0)).norm() < same &&
      limit_room_rad(table, alike) > 0.0) {
    return {.of = {q, alike}};
  }
  const ContactGoal opposite{.at_in_base = image(goal.at_in_base),
                             .normal_in_base = image(goal.normal_in_base)};
  return {.of = {q, find_posture(right, 0.0, opposite, alike, outward).q_rad}};
}

JointVector mirrored(const ArmTable& table, const RobotMount& mount,
                     const JointVector& q_rad) noexcept {
  // The plane that the arm itself is mirrored at follows from how the two shoulders stand. A joint
  // whose axis stands on it at q = 0 turns alike in the mirror, one whose axis lies in it turns the
  // other way. The axes follow from the table: each next one is Rx(alpha) on.
  const Matrix3 own_mirror = mount.base_from_shoulder[Arm::left].linear().transpose() *
                             Vector3(1.0, -1.0, 1.0).asDiagonal() *
                             mount.base_from_shoulder[Arm::right].linear();
  JointVector mirror = q_rad;
  Matrix3 orientation = Matrix3::Identity();
  for (int i = 0; i < table.joints; ++i) {
    const Link& link = table.links[static_cast<std::size_t>(i)];
    const Vector3 axis = orientation.col(2);
    if (axis.dot(own_mirror * axis) > 0.0) mirror[i] = -mirror[i];
    orientation = orientation * Eigen::AngleAxisd(link.offset_rad, Vector3::UnitZ()) *
                  Eigen::AngleAxisd(link.alpha_rad, Vector3::UnitX());
  }
  return mirror;
}

double ReadyRoom::min_m() const noexcept {
  return std::min({between_arms_m, clear[Arm::left].min_m(), clear[Arm::right].min_m()});
}

std::string ReadyRoom::nearest() const {
  const double nearest_m = min_m();
  if (between_arms_m == nearest_m) return fmt::format("the arms {:.0f} mm apart", to_mm(nearest_m));
  const Arm arm = clear[Arm::left].min_m() == nearest_m ? Arm::left : Arm::right;
  return fmt::format("the {} arm {:.0f} mm from the {}", name_of(arm), to_mm(nearest_m),
                     clear[arm][Surrounding::couch] == nearest_m ? "couch" : "robot's own body");
}

ReadyRoom ready_room(const PerArm<ArmModel>& arms, const RobotMount& mount,
                     const PerArm<JointVector>& ready_rad, double rail_m) {
  ReadyRoom room;
  PerArm<ArmModel::Kinematics> pose;
  for (const Arm arm : both_arms) {
    pose[arm] = arms[arm].kinematics(ready_rad[arm], rail_m);
    room.clear[arm] = clearances(arms[arm], pose[arm], rail_m, mount.obstacles);
    // The mount says where the sphere's foremost point is to wait.
    const Transform tool = arms[arm].base_from_tool(ready_rad[arm], rail_m);
    const Vector3 tip = tool.translation() + arms[arm].table().tool_radius_m * tool.linear().col(0);
    const Vector3 across(1.0, arm == Arm::left ? 1.0 : -1.0, 1.0);
    const Vector3 wanted =
        arms[arm].shoulder_in_base(rail_m) + mount.ready_from_shoulder.cwiseProduct(across);
    room.off_m[arm] = (tip - wanted).norm();
  }
  room.between_arms_m =
      distance_between_m(arms[Arm::left], pose[Arm::left], arms[Arm::right], pose[Arm::right]);
  return room;
}

}  // namespace tuina::robot
