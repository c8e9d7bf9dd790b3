// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <vector>

#include "tuina/robot/robot.hpp"

namespace tuina::app {

/// A robot whose drives do what they are told some milliseconds late.
class LateRobot final : public robot::Robot {
 public:
  LateRobot(robot::Robot& robot, int ticks)
      : robot_(robot), ticks_(static_cast<std::size_t>(std::max(ticks, 0))) {}
  [[nodiscard]] Result<void> stand_ready(const robot::ReadyPose& pose) override {
    return robot_.stand_ready(pose);
  }
  [[nodiscard]] std::optional<robot::RobotReading> read() noexcept override {
    return robot_.read();
  }
  void apply(const robot::RobotCommand& command) noexcept override {
    if (queue_.size() > ticks_) queue_.erase(queue_.begin());
    queue_.push_back(command);
    robot_.apply(queue_.front());
  }
  [[nodiscard]] const char* fault() const noexcept override { return robot_.fault(); }

 private:
  robot::Robot& robot_;
  std::size_t ticks_;
  std::vector<robot::RobotCommand> queue_;
};

}  // namespace tuina::app
