// SPDX-License-Identifier: Apache-2.0
#include "tuina/robot/description.hpp"

#include <fmt/format.h>

#include "tuina/core/decompositions.hpp"

namespace tuina::robot {
namespace {

/// From DH frame i (at the end of the link) to the joint frame i of the same link: [thesis] (2.2)
/// without the turn about z, which the joint makes.
Transform joint_from_end(const Link& link) {
  return Eigen::Translation3d(link.a_m, 0.0, link.d_m) *
         Transform(Eigen::AngleAxisd(link.alpha_rad, Vector3::UnitX()));
}

/// A capsule between two places.
Solid capsule(const Vector3& from, const Vector3& to, double radius_m) {
  Solid solid{.radius_m = radius_m, .length_m = (to - from).norm()};
  solid.part_from_solid = Transform(Eigen::Translation3d(0.5 * (from + to))) *
                          turn_between(Vector3::UnitZ(), to - from);
  return solid;
}

}  // namespace

void add_arm(Description& robot, const ArmTable& table, const std::string& side, int parent,
             const Transform& parent_from_shoulder) {
  Transform parent_from_here = parent_from_shoulder;
  for (int i = 0; i < table.joints; ++i) {
    const Link& link = table.links[static_cast<std::size_t>(i)];
    Part part{.name = fmt::format("{}_{}", side, link.name),
              .parent = parent,
              .lowest = link.min_rad,
              .highest = link.max_rad,
              .effort_limit = link.torque_limit_nm,
              .speed_limit = link.speed_limit_rad_per_s,
              .rotor_inertia_kg_m2 = link.rotor_inertia_kg_m2,
              .coulomb = link.coulomb_nm,
              .viscous = link.viscous_nm_s_per_rad,
              .mass_kg = link.mass_kg,
              .com = link.com_in_joint,
              .inertia_kg_m2 = link.inertia_kg_m2,
              .inertia_products_kg_m2 = link.inertia_products_kg_m2};
    part.parent_from_part = parent_from_here * Eigen::AngleAxisd(link.offset_rad, Vector3::UnitZ());
    const Transform end = joint_from_end(link);
    const Vector3 to_end = end.translation();
    if (to_end.norm() > link.radius_m) {
      const Vector3 last = to_end * (1.0 - link.radius_m / to_end.norm());
      part.solids.push_back(capsule(Vector3::Zero(), last, link.radius_m));
    }
    parent = static_cast<int>(robot.parts.size());
    parent_from_here = end;
    robot.parts.push_back(std::move(part));
  }
  robot.parts.back().solids.push_back({.shape = Solid::Shape::sphere,
                                       .part_from_solid = parent_from_here,
                                       .radius_m = table.tool_radius_m});
  Transform tool = parent_from_here;
  if (!table.end_from_tool_turn.isIdentity(0.0)) tool.linear() *= table.end_from_tool_turn;
  robot.markers.push_back({side + "_tool", parent, tool});
}

Description describe(const RobotMount& mount, const PerArm<ArmTable>& tables, double column_kg) {
  Description robot{.name = "tuina", .parts = {}, .markers = {}};
  robot.parts.push_back({.name = "rail",
                         .motion = Part::Motion::slide,
                         .axis = mount.rail_axis_in_base,
                         .lowest = mount.min_rail_m,
                         .highest = mount.max_rail_m,
                         .effort_limit = 2000.0,
                         .speed_limit = 0.1,
                         .mass_kg = column_kg,
                         .inertia_kg_m2 = {1.0, 1.0, 1.0}});
  for (const Arm arm : both_arms)
    add_arm(robot, tables[arm], name_of(arm), 0, mount.base_from_shoulder[arm]);
  return robot;
}

std::vector<Transform> base_from_parts(const Description& robot, const std::vector<double>& q) {
  std::vector<Transform> poses;
  for (std::size_t i = 0; i < robot.parts.size(); ++i) {
    const Part& part = robot.parts[i];
    Transform pose =
        part.parent < 0 ? Transform::Identity() : poses[static_cast<std::size_t>(part.parent)];
    pose = pose * part.parent_from_part;
    if (part.motion == Part::Motion::hinge) pose = pose * Eigen::AngleAxisd(q[i], part.axis);
    if (part.motion == Part::Motion::slide) pose = pose * Eigen::Translation3d(q[i] * part.axis);
    poses.push_back(pose);
  }
  return poses;
}

}  // namespace tuina::robot
