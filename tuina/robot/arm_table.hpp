// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "tuina/core/arm.hpp"
#include "tuina/core/units.hpp"

namespace tuina::robot {

/// One joint and the link it moves. The joint frame is Denavit-Hartenberg frame i-1 turned by
/// theta: its origin is on the joint, z is the axis, and it moves with the link, so mass properties
/// are constant in it.
struct Link {
  const char* name = "";
  double offset_rad = 0.0;  ///< theta = q + offset; standard (distal) DH, [thesis] (2.2)
  double d_m = 0.0;
  double a_m = 0.0;
  double alpha_rad = 0.0;

  double mass_kg = 0.0;
  std::array<double, 3> com_in_joint = {};  ///< centre of mass, metres
  std::array<double, 3> inertia_kg_m2 =
      {};                            ///< about the centre of mass, along the joint frame's axes
  double rotor_inertia_kg_m2 = 0.0;  ///< of the motor, seen through the gear

  double coulomb_nm = 0.0;  ///< friction of motor and gear
  double viscous_nm_s_per_rad = 0.0;
  double min_rad = -pi;
  double max_rad = pi;
  double torque_limit_nm = 0.0;
  double speed_limit_rad_per_s = 0.0;

  double radius_m = 0.0;  ///< of the solid the link is drawn as, and kept clear of the other arm by
};

/// All that is known of one arm before it moves. The model of the controller, the MJCF of the
/// simulation and the limits of the guard all read it, so they cannot drift apart.
///
/// The `tool` frame is DH frame 6: its origin is the CENTRE of the sphere the arm massages with, x
/// points out of the fist. The sphere's foremost point is `radius` further on, along the direction
/// of pressing.
struct ArmTable {
  int joints = 0;
  std::array<Link, max_joints> links = {};
  double tool_radius_m = 17_mm;
  double tool_mass_kg =
      0.0;  ///< beyond the wrist sensor, at the sphere's centre; part of the last link's mass

  [[nodiscard]] JointVector torque_limits_nm() const noexcept;
};

/// Number of the DH frame whose origin is the elbow: the first that is not the shoulder's.
[[nodiscard]] int elbow_origin(const ArmTable& table) noexcept;

/// The six-joint arm of the thesis: Tables 2-1 and 2-3 as corrected in docs/robot.md.
[[nodiscard]] ArmTable thesis_arm() noexcept;

/// Joint angles of the mirror image of a posture: the right arm holds mirrored(q) where the left
/// holds q. True of arms whose planes at q = 0 are vertical and parallel, as `mount_for` mounts
/// them.
[[nodiscard]] JointVector mirrored(const ArmTable& table, const JointVector& q_rad) noexcept;

}  // namespace tuina::robot
