// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>

#include "tuina/core/arm.hpp"
#include "tuina/core/units.hpp"

namespace tuina::robot {

/// One joint and the link it moves. The joint frame is Denavit-Hartenberg frame i-1 turned by
/// theta: its origin is on the joint, z is the axis, and it moves with the link, so mass properties
/// are constant in it.
struct Link {
  std::string name;
  double offset_rad = 0.0;  ///< theta = q + offset; standard (distal) DH, [thesis] (2.2)
  double d_m = 0.0;
  double a_m = 0.0;
  double alpha_rad = 0.0;

  double mass_kg = 0.0;
  std::array<double, 3> com_in_joint = {};  ///< centre of mass, metres
  /// Moments of inertia about the centre of mass, along the joint frame's axes: xx, yy, zz.
  std::array<double, 3> inertia_kg_m2 = {};
  /// Off-diagonal entries of the same tensor: xy, xz, yz.
  std::array<double, 3> inertia_products_kg_m2 = {};
  double rotor_inertia_kg_m2 = 0.0;  ///< motor's inertia, seen through the gear
  /// Stiffness between an encoder at the motor and the joint; zero: not known; from
  /// `rigid_gear_nm_per_rad` on: rigid, or the encoder sits at the joint.
  double gear_nm_per_rad = 0.0;

  double coulomb_nm = 0.0;  ///< friction of motor and gear
  double viscous_nm_s_per_rad = 0.0;
  double min_rad = -pi;
  double max_rad = pi;
  double torque_limit_nm = 0.0;
  double speed_limit_rad_per_s = 0.0;

  double radius_m = 0.0;  ///< radius of the capsule that is drawn and kept clear of the other arm
};

/// A gear as stiff as that is rigid.
constexpr double rigid_gear_nm_per_rad = 1e7;

/// Stiffness that a gear is taken to have: the one that its table tells; else that of usual
/// harmonic drives, 140 Nm/rad for each Nm of the drive [tuttle1992], which may be half or twice.
[[nodiscard]] inline double likely_gear_nm_per_rad(const Link& link) noexcept {
  constexpr double usual_per_rad = 140.0;
  return link.gear_nm_per_rad > 0.0 ? link.gear_nm_per_rad : usual_per_rad * link.torque_limit_nm;
}

/// All that is known of one arm before it moves. The model of the controller, the MJCF of the
/// simulation and the limits of the guard all read it, so they cannot drift apart.
///
/// The origin of the `tool` frame is that of the last DH frame, the CENTRE of the sphere the arm
/// massages with; x points out of the handle. The sphere's foremost point is `radius` further on,
/// along the direction of pressing.
struct ArmTable {
  int joints = 0;
  std::array<Link, max_joints> links = {};
  double tool_radius_m = 17_mm;
  double tool_mass_kg =
      0.0;  ///< part of the last link's mass: beyond the wrist sensor, at the tool
  Matrix3 end_from_tool_turn = Matrix3::Identity();  ///< how the tool stands in the last DH frame

  [[nodiscard]] JointVector torque_limits_nm() const noexcept;
};

/// Number of the DH frame whose origin is the elbow: the first that joints move away from their
/// axes by more than a seventh of the arm's length. The origins before it are the shoulder.
[[nodiscard]] int elbow_origin(const ArmTable& table) noexcept;

/// The table of the shipped robot `thesis`, for what judges its arm by name.
[[nodiscard]] ArmTable thesis_arm();

}  // namespace tuina::robot
