// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "tuina/robot/arm_model.hpp"
#include "tuina/robot/mount.hpp"
#include "tuina/telemetry/report/report_data.hpp"

namespace tuina::app {

/// How near the arms of a session come to each other and to what stands around them.
class ArmDistances {
 public:
  ArmDistances(const robot::ArmTable& table, const robot::RobotMount& mount)
      : models_(robot::both_models(table, mount)), obstacles_(mount.obstacles) {}

  using Poses = PerArm<robot::ArmModel::Kinematics>;
  [[nodiscard]] Poses poses(const PerArm<JointVector>& q_rad, double rail_m) const {
    return {.of = {models_[Arm::left].kinematics(q_rad[Arm::left], rail_m),
                   models_[Arm::right].kinematics(q_rad[Arm::right], rail_m)}};
  }
  /// Counts these; a row of the table is due ten times a second, and its distance to the person,
  /// infinite for who does not know it, is the caller's.
  [[nodiscard]] telemetry::ArmDistance* add(double time_s, const Poses& poses, double rail_m);

  [[nodiscard]] const PerArm<robot::ArmModel>& models() const noexcept { return models_; }
  [[nodiscard]] double min_apart_m() const noexcept { return min_apart_m_; }
  [[nodiscard]] const robot::Clearances& clear() const noexcept { return clear_; }
  [[nodiscard]] std::vector<telemetry::ArmDistance> take() { return std::move(rows_); }

 private:
  PerArm<robot::ArmModel> models_;
  std::vector<robot::Obstacle> obstacles_;
  double min_apart_m_ = std::numeric_limits<double>::infinity();
  robot::Clearances clear_;
  std::vector<telemetry::ArmDistance> rows_;
};

}  // namespace tuina::app
