// SPDX-License-Identifier: Apache-2.0
#include "tuina/motion/rollout.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tuina/control/cartesian_impedance.hpp"
#include "tuina/core/decompositions.hpp"
#include "tuina/robot/clearance.hpp"
#include "tuina/robot/tool_task.hpp"

namespace tuina::motion {
namespace {

constexpr double transfer_step_m = 15_mm;
constexpr double transfer_step_rad = 6_deg;
// Joint limits of a rollout lie this far inside the real ones.
constexpr double limit_margin_rad = 1_deg;
constexpr double thinned_rad = 2.5_deg;  // spacing of the kept configurations

/// The nearest angle with this room to both ends of a joint; its middle where there is less room.
double inside_of(const robot::Link& link, double margin_rad, double q_rad) {
  const double middle_rad = 0.5 * (link.min_rad + link.max_rad);
  return std::clamp(q_rad, std::min(link.min_rad + margin_rad, middle_rad),
                    std::max(link.max_rad - margin_rad, middle_rad));
}

}  // namespace

double inward_m(const robot::ArmModel& model, Arm arm,
                const robot::ArmModel::Kinematics& pose) noexcept {
  const double side = arm == Arm::left ? 1.0 : -1.0;
  double max_m = -std::numeric_limits<double>::infinity();
  for (int i = 0; i < model.joints(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double beside_m =
        std::min(side * pose.origins_in_base[k].y(), side * pose.origins_in_base[k + 1].y());
    max_m = std::max(max_m, model.table().links[k].radius_m - beside_m);
  }
  return max_m;
}

double JointPath::inward_m(const robot::ArmModel& model, Arm arm) const noexcept {
  double max_m = -std::numeric_limits<double>::infinity();
  for (const auto& pose : poses) max_m = std::max(max_m, motion::inward_m(model, arm, pose));
  return max_m;
}

Rollout::Rollout(const robot::ArmModel& model, double rail_m, const JointVector& q_rad,
                 double posture_share, double max_pull_rad)
    : model_(&model),
      rail_m_(rail_m),
      q_rad_(q_rad),
      now_(model.kinematics(q_rad, rail_m)),
      posture_share_(posture_share),
      max_pull_rad_(max_pull_rad) {}

/// Joint step of the posture springs and the joint-limit springs.
JointVector Rollout::posture_drift(const JointVector& posture_rad) const {
  const control::PostureGains gains;
  const double share_at_limit =
      std::min(1.0, posture_share_ * gains.limit_stiffness_nm_per_rad / gains.stiffness_nm_per_rad);
  JointVector drift =
      posture_share_ * (posture_rad - q_rad_).cwiseMax(-max_pull_rad_).cwiseMin(max_pull_rad_);
  for (int i = 0; i < model_->joints(); ++i) {
    const robot::Link& link = model_->table().links[static_cast<std::size_t>(i)];
    const double inside = inside_of(link, gains.limit_margin_rad, q_rad_[i]);
    drift[i] += share_at_limit * (inside - q_rad_[i]);
  }
  return drift;
}

void Rollout::step_to(const Vector3& centre_in_base, const Vector3& normal_in_base,
                      const JointVector& posture_rad, JointPath& joint_path) {
  constexpr int iterations = 2;
  constexpr double damping = 1e-3, max_step_rad = 0.3;
  for (int n = 0; n < iterations; ++n) {
    const JointVector drift =
        n == 0 ? posture_drift(posture_rad) : JointVector::Zero(q_rad_.size());
    const robot::ToolTask task = robot::tool_task(now_, centre_in_base, -normal_in_base);
    const JointVector step = robot::solve_step(task, damping, drift);
    q_rad_ += step.cwiseMax(-max_step_rad).cwiseMin(max_step_rad);
    for (int i = 0; i < model_->joints(); ++i) {
      const robot::Link& link = model_->table().links[static_cast<std::size_t>(i)];
      const double inside = inside_of(link, limit_margin_rad, q_rad_[i]);
      joint_path.limit_excess_rad =
          std::max(joint_path.limit_excess_rad, std::abs(q_rad_[i] - inside));
      q_rad_[i] = inside;
    }
    now_ = model_->kinematics(q_rad_, rail_m_);
  }
  tool_error_m_ = (centre_in_base - now_.base_from_tool.translation()).norm();
  const bool known =
      std::any_of(joint_path.q_rad.begin(), joint_path.q_rad.end(),
                  [&](const auto& q) { return (q - q_rad_).cwiseAbs().maxCoeff() < thinned_rad; });
  if (known) return;
  joint_path.q_rad.push_back(q_rad_);
  joint_path.poses.push_back(now_);
}

void Rollout::transfer(const control::ToolPose& tip, const JointVector& posture_rad,
                       JointPath& joint_path) {
  const Transform tool = now_.base_from_tool;
  const Vector3 from = tool.translation(), from_normal = control::tool_normal(tool);
  const Vector3 to = control::centre_pose(tip, model_->table().tool_radius_m).at_in_base;
  const auto turn = turn_between(from_normal, tip.normal_in_base);
  const double angle_rad = Eigen::AngleAxisd(turn).angle();
  const int steps = std::max({1, static_cast<int>(std::ceil((to - from).norm() / transfer_step_m)),
                              static_cast<int>(std::ceil(angle_rad / transfer_step_rad))});
  for (int i = 1; i <= steps; ++i) {
    const double u = static_cast<double>(i) / steps;
    const Vector3 normal = Eigen::Quaterniond::Identity().slerp(u, turn) * from_normal;
    step_to(from + u * (to - from), normal, posture_rad, joint_path);
  }
}

void Rollout::settle(const JointVector& posture_rad, JointPath& joint_path, int steps) {
  const Transform tool = now_.base_from_tool;
  for (int i = 0; i < steps; ++i) {
    step_to(tool.translation(), control::tool_normal(tool), posture_rad, joint_path);
  }
}

void Rollout::slide(std::span<const robot::ContactGoal> places, const JointVector& posture_rad,
                    JointPath& joint_path) {
  const double radius_m = model_->table().tool_radius_m;
  for (const robot::ContactGoal& place : places) {
    const control::ToolPose centre =
        control::centre_pose({place.at_in_base, place.normal_in_base}, radius_m);
    step_to(centre.at_in_base, centre.normal_in_base, posture_rad, joint_path);
    joint_path.tool_error_m = std::max(joint_path.tool_error_m, tool_error_m_);
    const auto elbow = model_->elbow();
    const Vector3 at = now_.origins_in_base[elbow];
    joint_path.elbow_height_m =
        std::min(joint_path.elbow_height_m, (at - place.at_in_base).dot(place.normal_in_base));
  }
}

double distance_between_m(const PerArm<robot::ArmModel>& models,
                          const PerArm<const JointPath*>& joint_paths) {
  const auto inward = [&](Arm arm) {
    std::vector<double> each_m;
    for (const auto& pose : joint_paths[arm]->poses) {
      each_m.push_back(motion::inward_m(models[arm], arm, pose));
    }
    return each_m;
  };
  const std::vector<double> left_m = inward(Arm::left), right_m = inward(Arm::right);
  double nearest_m = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < left_m.size(); ++i) {
    for (std::size_t k = 0; k < right_m.size(); ++k) {
      if (-left_m[i] - right_m[k] >= nearest_m) continue;  // lower bound of the distance
      nearest_m = std::min(nearest_m, robot::distance_between_m(
                                          models[Arm::left], joint_paths[Arm::left]->poses[i],
                                          models[Arm::right], joint_paths[Arm::right]->poses[k]));
    }
  }
  return nearest_m;
}

}  // namespace tuina::motion
