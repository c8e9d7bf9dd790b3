// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tuina/robot/arm_model.hpp"

namespace tuina::robot {

/// Jacobian of the five directions in which a round tool is led: the place of its origin, in
/// `base`, and the two turns that tilt its axis. A turn about the axis changes nothing.
using ToolJacobian = Eigen::Matrix<double, 5, Eigen::Dynamic, 0, 5, max_joints>;
using ToolError = Eigen::Matrix<double, 5, 1>;  ///< metres and radians, in the rows of ToolJacobian

/// Where the tool is to go from a configuration, and how the joints move it.
struct ToolTask {
  ToolJacobian jacobian;
  ToolError error;  ///< from the tool to its target; of a tilt the sine
};

/// The way from `now` to a tool at `origin_in_base` with its axis, x of the tool, along the unit
/// `axis_in_base`.
[[nodiscard]] ToolTask tool_task(const ArmModel::Kinematics& now, const Vector3& origin_in_base,
                                 const Vector3& axis_in_base) noexcept;

/// The Jacobian alone, of the tool's pose and the Jacobian of all six directions.
[[nodiscard]] ToolJacobian tool_jacobian(const Transform& base_from_tool,
                                         const Jacobian& jacobian) noexcept;

/// The joint step next to `wanted` that takes the error away: damped least squares,
/// J^T (J J^T + damping^2)^-1 (error - J wanted) + wanted [nakamura1986].
[[nodiscard]] JointVector solve_step(const ToolTask& task, double damping,
                                     const JointVector& wanted) noexcept;

}  // namespace tuina::robot
