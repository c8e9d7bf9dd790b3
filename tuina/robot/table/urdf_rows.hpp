// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "tuina/robot/table/read_urdf.hpp"

namespace tuina::robot {

/// Mass, first moment and inertia about the origin of the base link of bodies that move as one, all
/// joints at zero.
struct CarriedMass {
  double kg = 0.0;
  Vector3 moment = Vector3::Zero();
  Matrix3 about_origin = Matrix3::Zero();

  void add(double mass_kg, const Vector3& centre, const Matrix3& about_centre);
};

/// One turning joint and what it carries, in the base link's frame, all joints at zero.
struct TurningJoint {
  Link link;
  Vector3 at, axis;
  CarriedMass mass = {};
};

/// The Denavit-Hartenberg rows of a chain of turning joints, from their axes and the pose of the
/// tip at zero.
[[nodiscard]] UrdfArm arm_of(std::vector<TurningJoint> chain, const Transform& tip);

}  // namespace tuina::robot
