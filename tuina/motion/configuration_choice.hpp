// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "tuina/core/arm.hpp"
#include "tuina/core/units.hpp"
#include "tuina/robot/arm_model.hpp"
#include "tuina/robot/inverse_kinematics.hpp"

namespace tuina::motion {

inline constexpr double own_side_m = 30_mm;    ///< half the distance that two arms keep
inline constexpr double press_depth_m = 8e-3;  ///< indentation of a compliant torso at 30 N

/// Penalty for low dexterity, as an equivalent distance past the midline (m).
[[nodiscard]] double dexterity_cost_m(const robot::ArmModel::Kinematics& pose) noexcept;

/// Candidate configurations for a path.
struct ConfigurationChoice {
  std::vector<JointVector> configurations_rad;  ///< sorted by cost, near duplicates removed
  double min_cost_m = 0.0;                      ///< lower bound of the cost over the whole path
};

/// Configurations that touch the start, middle or end of a path, the elbow swept through its whole
/// circle. Cost: past the midline, low dexterity, felt as heavy by the person, near joint limits.
/// Elbows inside the person are left out.
[[nodiscard]] ConfigurationChoice choose_configurations(const robot::ArmModel& model, Arm arm,
                                                        double rail_m,
                                                        std::span<const robot::ContactGoal> goals,
                                                        const JointVector& ready_rad,
                                                        const JointVector& arrival_rad);

}  // namespace tuina::motion
