// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tuina/sim/person/phantom.hpp"

namespace tuina::sim {

/// Posture of a phantom: the deformation from its straight trunk frame to `couch`.
struct PhantomPose {
  BodyPosture position = BodyPosture::sitting;
  double length_m = 0.5;   ///< C7 to S2
  double lean_rad = 0.0;   ///< forward
  double bend_rad = 0.0;   ///< to the left
  double yaw_rad = 0.0;    ///< about the long axis
  double twist_rad = 0.0;  ///< shoulders against the pelvis
  double shoulder_tilt_rad = 0.0;
  double pelvis_tilt_rad = 0.0;
  /// Lateral offset of the middle of the spine from the line C7-S2, in lengths.
  double side_curve = 0.0;
  double flex = 0.0;        ///< backward rounding of the spine, in lengths
  double neck = 0.0;        ///< backward shift of the head, in lengths
  double head_aside = 0.0;  ///< shift of the head to the left, in lengths
  std::array<Vector3, 2> arm_in_trunk = {Vector3::UnitX(),
                                         Vector3::UnitX()};  ///< left, right: shoulder to elbow
  Vector3 sacrum_in_sitting = Vector3::Zero();  ///< S2 in the axes of the sitting position

  [[nodiscard]] Vector3 couch_from_trunk(const Vector3& at) const;
  /// Transforms a unit normal at a point.
  [[nodiscard]] Vector3 normal_in_couch(const Vector3& at, const Vector3& normal_in_trunk) const;
};

[[nodiscard]] PhantomPose pose_of(const PhantomShape& shape, BodyPosture position, double length_m);

/// Index of the axis out of the back, towards a camera behind or above the person.
[[nodiscard]] constexpr int back_axis(BodyPosture position) {
  return position == BodyPosture::sitting ? 1 : 2;
}

}  // namespace tuina::sim
