// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tuina/sim/person/phantom.hpp"

namespace tuina::sim {

/// How a phantom holds itself, and from that the way from the frame of its straight trunk into
/// `couch`.
struct PhantomPose {
  Position position = Position::sitting;
  double length_m = 0.5;   ///< C7 to S2
  double lean_rad = 0.0;   ///< forward
  double bend_rad = 0.0;   ///< to the left
  double yaw_rad = 0.0;    ///< about the long axis
  double twist_rad = 0.0;  ///< of the shoulders against the pelvis
  double shoulder_tilt_rad = 0.0;
  double pelvis_tilt_rad = 0.0;
  double side_curve = 0.0;  ///< how far the middle of the spine is off the line C7-S2, in lengths
  double flex = 0.0;        ///< how far the spine is rounded backwards, in lengths
  double neck = 0.0;        ///< how far the head is moved to the back, in lengths
  double head_aside = 0.0;  ///< to the left, in lengths
  std::array<Vector3, 2> arm_in_trunk = {Vector3::UnitX(),
                                         Vector3::UnitX()};  ///< left, right: shoulder to elbow
  Vector3 sacrum_in_sitting = Vector3::Zero();  ///< S2 in the axes of the sitting position

  [[nodiscard]] Vector3 couch_from_trunk(const Vector3& at) const;
  /// A unit normal carried along.
  [[nodiscard]] Vector3 normal_in_couch(const Vector3& at, const Vector3& normal_in_trunk) const;
};

[[nodiscard]] PhantomPose pose_of(const PhantomShape& shape, Position position, double length_m);

/// The straight direction out of the back, as a camera behind or above the person sees it.
[[nodiscard]] constexpr int back_axis(Position position) {
  return position == Position::sitting ? 1 : 2;
}

}  // namespace tuina::sim
