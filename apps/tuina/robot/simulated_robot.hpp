// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "apps/cli/command_line.hpp"
#include "apps/cli/position_option.hpp"
#include "apps/simulated/devices/emulated_wrist.hpp"
#include "apps/simulated/robot_process.hpp"
#include "apps/simulated/session_order.hpp"
#include "tuina/hardware/device_file.hpp"
#include "tuina/link/link.hpp"

// What the processes of a robot share that `tuina` can be beside a session.
namespace tuina::app {

void add_pace_option(Options& options, std::string& pace);
void add_link_options(Options& options, std::string& link, std::string& pace);
[[nodiscard]] link::Pace pace_of(const std::string& name);

/// A person and a robot, as `tuina massage` names them.
class SimulatedRobot {
 public:
  void describe(Options& options);
  [[nodiscard]] Result<SimulatedRoom> make(const CommonOptions& common,
                                           const sim::PlantOptions& devices = {});
  [[nodiscard]] std::string world_name(const sim::World& world, std::uint64_t seed) const {
    return app::world_name(order_, world, seed);
  }
  [[nodiscard]] static Answer answer(const RobotReport& report);

 private:
  SessionOrder order_;
  PositionOption position_;
};

/// The address that an option gives, and the one at the next port.
[[nodiscard]] Result<PerArm<hardware::ArmDevice>> pair_of_addresses(const char* option,
                                                                    const std::string& left);

/// Emulated force sensors at both wrists, and what becomes of the left one.
class WristsOption {
 public:
  using Wrists = PerArm<std::unique_ptr<EmulatedWrist>>;
  /// `usual`: where the left one is if nothing is said; empty: then there are none.
  void describe(Options& options, const std::string& usual);
  [[nodiscard]] Result<Wrists> make();

 private:
  std::string wrist_, fault_;
  WristFailure failure_;
};

/// The memory in which this process tells what is true of its arms; `name` is what they are called.
[[nodiscard]] Result<SharedTruth> share_truth(const std::string& name, const std::string& world,
                                              const WristsOption::Wrists& wrists);

}  // namespace tuina::app
