// SPDX-License-Identifier: Apache-2.0
#include "tuina/motion/rollout.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "tuina/control/cartesian_impedance.hpp"
#include "tuina/robot/clearance.hpp"

namespace tuina::motion {
namespace {

constexpr double air_step_m = 15_mm;
constexpr double air_step_rad = 6_deg;
constexpr double limit_margin_rad = 1_deg;  // an arm at the end of a joint may not come on
constexpr double thinned_rad = 2.5_deg;     // a posture so close to one of before is not kept

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

double Passage::inward_m(const robot::ArmModel& model, Arm arm) const noexcept {
  double max_m = -std::numeric_limits<double>::infinity();
  for (const auto& pose : poses) max_m = std::max(max_m, motion::inward_m(model, arm, pose));
  return max_m;
}

Rehearsal::Rehearsal(const robot::ArmModel& model, double rail_m, const JointVector& q_rad,
                     double posture_share)
    : model_(&model),
      rail_m_(rail_m),
      q_rad_(q_rad),
      now_(model.kinematics(q_rad, rail_m)),
      posture_share_(posture_share) {}

/// How far the posture springs, and those at the ends of the joints, would take the arm.
JointVector Rehearsal::drawn_to(const JointVector& posture_rad) const {
  const control::PostureGains gains;
  const double share_at_limit =
      std::min(1.0, posture_share_ * gains.limit_stiffness_nm_per_rad / gains.stiffness_nm_per_rad);
  JointVector drift = posture_share_ * (posture_rad - q_rad_);
  for (int i = 0; i < model_->joints(); ++i) {
    const robot::Link& link = model_->table().links[static_cast<std::size_t>(i)];
    const double inside = std::clamp(q_rad_[i], link.min_rad + gains.limit_margin_rad,
                                     link.max_rad - gains.limit_margin_rad);
    drift[i] += share_at_limit * (inside - q_rad_[i]);
  }
  return drift;
}

void Rehearsal::step_to(const Vector3& centre_in_base, const Vector3& normal_in_base,
                        const JointVector& posture_rad, Passage& passage) {
  using Task = Eigen::Matrix<double, 5, Eigen::Dynamic, 0, 5, max_joints>;
  constexpr int iterations = 2;
  constexpr double damping = 1e-3, max_step_rad = 0.3;
  for (int n = 0; n < iterations; ++n) {
    const robot::ArmModel::Kinematics& now = now_;
    const Vector3 axis = control::tool_normal(now.base_from_tool);
    const Vector3 across = axis.unitOrthogonal(), over = axis.cross(across);
    const Vector3 turn = axis.cross(normal_in_base);
    Task J(5, q_rad_.size());
    J.topRows<3>() = now.jacobian.topRows<3>();
    J.row(3) = across.transpose() * now.jacobian.bottomRows<3>();
    J.row(4) = over.transpose() * now.jacobian.bottomRows<3>();
    Eigen::Matrix<double, 5, 1> error;
    error << centre_in_base - now.base_from_tool.translation(), turn.dot(across), turn.dot(over);
    const JointVector drift = n == 0 ? drawn_to(posture_rad) : JointVector::Zero(q_rad_.size());
    const Eigen::Matrix<double, 5, 5> square =
        J * J.transpose() + damping * damping * Eigen::Matrix<double, 5, 5>::Identity();
    const Eigen::Matrix<double, 5, 1> rest = error - J * drift;
    const JointVector step = drift + J.transpose() * square.llt().solve(rest);
    q_rad_ += step.cwiseMax(-max_step_rad).cwiseMin(max_step_rad);
    for (int i = 0; i < model_->joints(); ++i) {
      const robot::Link& link = model_->table().links[static_cast<std::size_t>(i)];
      const double inside =
          std::clamp(q_rad_[i], link.min_rad + limit_margin_rad, link.max_rad - limit_margin_rad);
      passage.strained_rad = std::max(passage.strained_rad, std::abs(q_rad_[i] - inside));
      q_rad_[i] = inside;
    }
    now_ = model_->kinematics(q_rad_, rail_m_);
  }
  off_m_ = (centre_in_base - now_.base_from_tool.translation()).norm();
  const bool known = std::any_of(passage.q_rad.begin(), passage.q_rad.end(), [&](const auto& q) {
    return (q - q_rad_).cwiseAbs().maxCoeff() < thinned_rad;
  });
  if (known) return;
  passage.q_rad.push_back(q_rad_);
  passage.poses.push_back(now_);
}

void Rehearsal::fly(const control::ToolPose& foremost, const JointVector& posture_rad,
                    Passage& passage) {
  const Transform tool = now_.base_from_tool;
  const Vector3 from = tool.translation(), from_normal = control::tool_normal(tool);
  const Vector3 to = foremost.at_in_base + model_->table().tool_radius_m * foremost.normal_in_base;
  const auto turn = Eigen::Quaterniond::FromTwoVectors(from_normal, foremost.normal_in_base);
  const double angle_rad = Eigen::AngleAxisd(turn).angle();
  const int steps = std::max({1, static_cast<int>(std::ceil((to - from).norm() / air_step_m)),
                              static_cast<int>(std::ceil(angle_rad / air_step_rad))});
  for (int i = 1; i <= steps; ++i) {
    const double u = static_cast<double>(i) / steps;
    const Vector3 normal = Eigen::Quaterniond::Identity().slerp(u, turn) * from_normal;
    step_to(from + u * (to - from), normal, posture_rad, passage);
  }
}

void Rehearsal::stay(const JointVector& posture_rad, Passage& passage) {
  constexpr int steps = 10;
  const Transform tool = now_.base_from_tool;
  for (int i = 0; i < steps; ++i) {
    step_to(tool.translation(), control::tool_normal(tool), posture_rad, passage);
  }
}

void Rehearsal::slide(std::span<const robot::ContactGoal> places, const JointVector& posture_rad,
                      Passage& passage) {
  const double radius_m = model_->table().tool_radius_m;
  for (const robot::ContactGoal& place : places) {
    step_to(place.at_in_base + radius_m * place.normal_in_base, place.normal_in_base, posture_rad,
            passage);
    passage.off_m = std::max(passage.off_m, off_m_);
    const std::size_t elbow = model_->elbow();
    const Vector3 at = now_.origins_in_base[elbow];
    passage.elbow_height_m =
        std::min(passage.elbow_height_m, (at - place.at_in_base).dot(place.normal_in_base));
  }
}

double distance_between_m(const PerArm<robot::ArmModel>& models,
                          const PerArm<const Passage*>& passages) {
  const auto inward = [&](Arm arm) {
    std::vector<double> each_m;
    for (const auto& pose : passages[arm]->poses) {
      each_m.push_back(motion::inward_m(models[arm], arm, pose));
    }
    return each_m;
  };
  const std::vector<double> left_m = inward(Arm::left), right_m = inward(Arm::right);
  double nearest_m = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < left_m.size(); ++i) {
    for (std::size_t k = 0; k < right_m.size(); ++k) {
      if (-left_m[i] - right_m[k] >= nearest_m) continue;  // they cannot be closer than that
      nearest_m = std::min(
          nearest_m, robot::distance_between_m(models[Arm::left], passages[Arm::left]->poses[i],
                                               models[Arm::right], passages[Arm::right]->poses[k]));
    }
  }
  return nearest_m;
}

}  // namespace tuina::motion
