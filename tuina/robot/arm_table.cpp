// SPDX-License-Identifier: Apache-2.0
#include "tuina/robot/arm_table.hpp"

#include <cmath>

namespace tuina::robot {
namespace {

enum Axis { along_x, along_y, along_z };

/// Mass properties of a solid cylinder whose centre is at `centre` and whose axis is parallel to
/// `axis`.
void fill_with_cylinder(Link& link, double mass_kg, double length_m, Axis axis,
                        std::array<double, 3> centre) {
  const double r = link.radius_m;
  const double across = mass_kg * (3.0 * r * r + length_m * length_m) / 12.0;
  link.mass_kg = mass_kg;
  link.com_in_joint = centre;
  link.inertia_kg_m2 = {across, across, across};
  link.inertia_kg_m2[axis] = mass_kg * r * r / 2.0;
}

/// A handle of 0.34 kg from the wrist to the sphere, and the sphere: of steel, 17 mm radius, 0.16
/// kg.
void fill_with_fist(Link& link, double tool_mass_kg, double tool_radius_m) {
  constexpr double fist_kg = 0.5;  // [thesis] Table 2-1
  const double handle_kg = fist_kg - tool_mass_kg;
  const double handle_m = link.a_m - tool_radius_m;
  fill_with_cylinder(link, handle_kg, handle_m, along_x, {handle_m / 2.0, 0.0, 0.0});
  const double com_x = (handle_kg * handle_m / 2.0 + tool_mass_kg * link.a_m) / fist_kg;
  const double handle_arm = com_x - handle_m / 2.0;
  const double tool_arm = link.a_m - com_x;
  const double parallel = handle_kg * handle_arm * handle_arm + tool_mass_kg * tool_arm * tool_arm;
  const double ball = 0.4 * tool_mass_kg * tool_radius_m * tool_radius_m;
  link.mass_kg = fist_kg;
  link.com_in_joint = {com_x, 0.0, 0.0};
  link.inertia_kg_m2[along_x] += ball;
  link.inertia_kg_m2[along_y] += ball + parallel;
  link.inertia_kg_m2[along_z] += ball + parallel;
}

}  // namespace

ArmTable thesis_arm() noexcept {
  constexpr double right_angle = 90_deg;
  constexpr double upper_arm_m = 300_mm;
  constexpr double forearm_m = 300_mm;
  ArmTable table{.joints = 6, .tool_mass_kg = 0.16};
  auto& links = table.links;

  // [thesis] Table 2-3; it prints 900 and 1800 where 90 and 180 degrees are meant.
  // The joint limits are not in the thesis: they are what a spherical shoulder, an elbow that bends
  // one way and a wrist of this build allow. Torques hold 140 N at the tool ([thesis] 2.2) plus the
  // arm's weight.
  links[0] = {.name = "shoulder_pitch",
              .offset_rad = 0.0,
              .alpha_rad = right_angle,
              .min_rad = -170_deg,
              .max_rad = 170_deg};
  links[1] = {.name = "shoulder_roll",
              .offset_rad = -right_angle,
              .alpha_rad = right_angle,
              .min_rad = -85_deg,
              .max_rad = 85_deg};
  links[2] = {.name = "upper_arm_roll",
              .offset_rad = -right_angle,
              .d_m = -upper_arm_m,
              .alpha_rad = right_angle,
              .min_rad = -170_deg,
              .max_rad = 170_deg};
  links[3] = {.name = "elbow",
              .offset_rad = -right_angle,
              .alpha_rad = right_angle,
              .min_rad = -85_deg,
              .max_rad = 60_deg};
  links[4] = {.name = "forearm_roll",
              .offset_rad = -2.0 * right_angle,
              .d_m = -forearm_m,
              .alpha_rad = right_angle,
              .min_rad = -170_deg,
              .max_rad = 170_deg};
  links[5] = {.name = "wrist",
              .offset_rad = -right_angle,
              .a_m = 100_mm,
              .min_rad = -100_deg,
              .max_rad = 100_deg};

  // [thesis] Table 2-1 gives shoulder 2.3, upper arm 3.3, forearm 2.2, fist 0.5 kg and a diameter
  // of 100 mm; shoulder and forearm are split evenly over their two joints.
  for (Link& link : links) link.radius_m = 50_mm;
  links[5].radius_m = 35_mm;  // the wrist sensor's
  fill_with_cylinder(links[0], 1.15, 57.5_mm, along_z, {0.0, 0.0, 0.0});
  fill_with_cylinder(links[1], 1.15, 57.5_mm, along_z, {0.0, 0.0, 0.0});
  fill_with_cylinder(links[2], 3.3, upper_arm_m, along_z, {0.0, 0.0, -upper_arm_m / 2.0});
  fill_with_cylinder(links[3], 1.1, forearm_m / 2.0, along_y, {0.0, forearm_m / 4.0, 0.0});
  fill_with_cylinder(links[4], 1.1, forearm_m / 2.0, along_z, {0.0, 0.0, -forearm_m * 0.75});
  fill_with_fist(links[5], table.tool_mass_kg, table.tool_radius_m);

  // Not in the thesis: what harmonic drives of 100:1 with motors of this size have.
  constexpr std::array<double, 6> rotor_kg_m2 = {0.15, 0.15, 0.10, 0.10, 0.03, 0.03};
  constexpr std::array<double, 6> coulomb_nm = {2.5, 2.5, 1.5, 1.5, 0.5, 0.5};
  constexpr std::array<double, 6> viscous = {0.2, 0.2, 0.1, 0.1, 0.03, 0.03};
  constexpr std::array<double, 6> torque_nm = {120.0, 120.0, 70.0, 70.0, 20.0, 20.0};
  constexpr std::array<double, 6> speed = {2.5, 2.5, 2.5, 2.5, 4.0, 4.0};
  for (std::size_t i = 0; i < 6; ++i) {
    links[i].rotor_inertia_kg_m2 = rotor_kg_m2[i];
    links[i].coulomb_nm = coulomb_nm[i];
    links[i].viscous_nm_s_per_rad = viscous[i];
    links[i].torque_limit_nm = torque_nm[i];
    links[i].speed_limit_rad_per_s = speed[i];
  }
  return table;
}

JointVector ArmTable::torque_limits_nm() const noexcept {
  JointVector limits = JointVector::Zero(joints);
  for (int i = 0; i < joints; ++i) limits[i] = links[static_cast<std::size_t>(i)].torque_limit_nm;
  return limits;
}

int elbow_origin(const ArmTable& table) noexcept {
  for (int i = 0; i < table.joints; ++i) {
    const Link& link = table.links[static_cast<std::size_t>(i)];
    if (std::abs(link.d_m) + std::abs(link.a_m) > 0.0) return i + 1;
  }
  return table.joints;
}

JointVector mirrored(const ArmTable& table, const JointVector& q_rad) noexcept {
  // A joint whose axis stands on the mirror plane at q = 0 turns alike in the mirror, one whose
  // axis lies in the plane turns the other way. The axes follow from the table: each next one is
  // Rx(alpha) on.
  JointVector mirror = q_rad;
  Matrix3 orientation = Matrix3::Identity();
  for (int i = 0; i < table.joints; ++i) {
    const Link& link = table.links[static_cast<std::size_t>(i)];
    if (std::abs(orientation(2, 2)) < 0.5) mirror[i] = -mirror[i];
    orientation = orientation * Eigen::AngleAxisd(link.offset_rad, Vector3::UnitZ()) *
                  Eigen::AngleAxisd(link.alpha_rad, Vector3::UnitX());
  }
  return mirror;
}

}  // namespace tuina::robot
