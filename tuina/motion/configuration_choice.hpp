// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "tuina/core/arm.hpp"
#include "tuina/core/units.hpp"
#include "tuina/robot/arm_model.hpp"
#include "tuina/robot/inverse_kinematics.hpp"

namespace tuina::motion {

inline constexpr double own_side_m = 30_mm;    ///< half of what two arms keep between them
inline constexpr double press_depth_m = 8e-3;  ///< 30 N press so deep into a torso that gives way

/// Near a posture in which it can hardly follow, an arm lags and loses force: as bad as so far over
/// the middle between the shoulders.
[[nodiscard]] double clumsiness_m(const robot::ArmModel::Kinematics& pose) noexcept;

/// Postures worth rehearsing for a path.
struct PostureChoice {
  std::vector<JointVector> postures_rad;  ///< the best first, none much like another
  double least_bad_m = 0.0;               ///< how good one can be over the whole path
};

/// Postures that touch the start, the middle or the end of a path, with the elbow turned all the
/// way round: on the arm's own side, off the person, nimble and away from the ends of the joints.
[[nodiscard]] PostureChoice postures_for(const robot::ArmModel& model, Arm arm, double rail_m,
                                         std::span<const robot::ContactGoal> goals,
                                         const JointVector& ready_rad,
                                         const JointVector& arrival_rad);

}  // namespace tuina::motion
