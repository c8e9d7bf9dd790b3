// SPDX-License-Identifier: Apache-2.0
#include "tuina/robot/tool_task.hpp"

#include <Eigen/Cholesky>

namespace tuina::robot {
namespace {

/// The tool's axis and two directions across it, about which it tilts.
struct ToolAxes {
  explicit ToolAxes(const Transform& base_from_tool)
      : axis(base_from_tool.linear().col(0)),
        across(axis.unitOrthogonal()),
        over(axis.cross(across)) {}

  Vector3 axis, across, over;
};

ToolJacobian jacobian_about(const ToolAxes& tool, const Jacobian& jacobian) {
  ToolJacobian J(5, jacobian.cols());
  J.topRows<3>() = jacobian.topRows<3>();
  J.row(3) = tool.across.transpose() * jacobian.bottomRows<3>();
  J.row(4) = tool.over.transpose() * jacobian.bottomRows<3>();
  return J;
}

}  // namespace

ToolTask tool_task(const ArmModel::Kinematics& now, const Vector3& origin_in_base,
                   const Vector3& axis_in_base) noexcept {
  const ToolAxes tool(now.base_from_tool);
  const Vector3 turn = tool.axis.cross(axis_in_base);
  ToolTask task{.jacobian = jacobian_about(tool, now.jacobian), .error = {}};
  task.error << origin_in_base - now.base_from_tool.translation(), turn.dot(tool.across),
      turn.dot(tool.over);
  return task;
}

ToolJacobian tool_jacobian(const Transform& base_from_tool, const Jacobian& jacobian) noexcept {
  return jacobian_about(ToolAxes(base_from_tool), jacobian);
}

JointVector solve_step(const ToolTask& task, double damping, const JointVector& wanted) noexcept {
  using Matrix5 = Eigen::Matrix<double, 5, 5>;
  const ToolJacobian& J = task.jacobian;
  const Matrix5 square = J * J.transpose() + damping * damping * Matrix5::Identity();
  const ToolError rest = task.error - J * wanted;
  const ToolError along = square.llt().solve(rest);
  return wanted + J.transpose() * along;
}

}  // namespace tuina::robot
