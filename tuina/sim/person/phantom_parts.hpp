// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "tuina/sim/person/phantom_pose.hpp"
#include "tuina/sim/person/phantom_table.hpp"

namespace tuina::sim {

/// Convex hull of two balls.
struct RoundCone {
  Vector3 from = Vector3::Zero();
  Vector3 to = Vector3::UnitZ();
  double from_radius = 0.1;
  double to_radius = 0.1;
  [[nodiscard]] double distance(const Vector3& at) const;
};

/// Axis-aligned ellipsoid; boxy: exponent 2.5 instead of 2.
struct Ellipsoid {
  Vector3 middle = Vector3::Zero();
  Vector3 half = Vector3::Ones();
  bool boxy = false;
  [[nodiscard]] double distance(const Vector3& at) const;
};

/// Positions and sizes of the parts blended into the trunk, in lengths C7-S2 in the trunk frame.
/// Least-squares fit to the people of models/phantom.csv (man, BMI 22; `_woman` and `_bmi`, per 10,
/// are added).
struct PartSizes {
  double neck_low_y = -0.101, neck_low_z = 0.980, neck_low_r = 0.061;
  double neck_high_y = -0.116, neck_high_z = 1.170, neck_high_r = 0.085;
  double neck_woman = -0.010, neck_bmi = -0.003, neck_blend = 0.077;
  double skull_y = -0.144, skull_z = 1.282, skull_half_x = 0.143, skull_half_y = 0.152;
  double skull_half_z = 0.178, skull_prone_y = 0.011, skull_prone_z = 0.010, skull_blend = 0.070;
  double girdle_x = 0.092, girdle_y = -0.143, girdle_z = 0.868,
         girdle_r = 0.087;  // y: from the spine
  double girdle_out_y = -0.001, girdle_out_z = -0.013, girdle_out_r = 0.095, girdle_blend = 0.056;
  double shoulder_x = -0.031, shoulder_y = 0.038, shoulder_z = -0.090;  // from the acromion
  double raised_x = -0.025, raised_y = 0.034, raised_z = -0.109;
  double fold_x = 0.306, fold_y = -0.088, fold_z = 0.581,
         fold_r = 0.052;  // raised arms stretch a fold of muscle
  double shoulder_r = 0.092, triceps_r = 0.082, elbow_r = 0.062, raised_r = 0.003;
  double arm_woman = -0.010, arm_bmi = 0.017, arm_blend = 0.092;
};

struct Parts {
  bool raised = false;  ///< arms raised: the folds count
  RoundCone neck;
  Ellipsoid skull, face;
  std::array<Ellipsoid, 2> ear;
  std::array<RoundCone, 2> fold, girdle, upper_arm,
      lower_arm;  ///< the halves meet at the triceps
};

/// `spine_depth`: distance of the skin over the spine from the line C7-S2 at the shoulder girdle.
[[nodiscard]] Parts place_parts(const PartSizes& sizes, const Proportions& proportions,
                                const PhantomShape& shape, const PhantomPose& pose,
                                double spine_depth);

}  // namespace tuina::sim
