// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

#include "apps/cli/command_line.hpp"
#include "apps/simulated/session_order.hpp"

namespace tuina::app {

/// A simulated hand that leads an arm of a robot which is another program.
class HandOption {
 public:
  void describe(Options& options);
  /// What it does in each millisecond of the robot's clock; empty where no hand is wanted.
  [[nodiscard]] Result<std::function<void(sim::World& world, double time_s)>> make(
      const SimulatedRoom& room) const;

 private:
  std::string technique_, arm_ = "left";
};

}  // namespace tuina::app
