// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "apps/simulated/devices/device_arms.hpp"
#include "tuina/session/config.hpp"
#include "tuina/session/control_loop.hpp"
#include "tuina/session/controlled_arm.hpp"
#include "tuina/sim/world.hpp"

namespace tuina::app {

/// A millisecond in which the tool was led or played, as it truly was.
struct TeachRow {
  double time_s = 0.0;
  Vector3 tool_in_couch = Vector3::Zero();  ///< tip of the tool
  double true_force_n = 0.0;
};

/// A guarded robot before a person, for motions that a hand shows: simulated here, or the arms of a
/// device file.
class TeachingStage {
 public:
  struct Device {
    std::string file;   ///< empty: simulated here
    std::string robot;  ///< name or file of its table
  };
  /// The robot stands ready, and its guard is armed.
  [[nodiscard]] static Result<std::unique_ptr<TeachingStage>> make(
      const sim::Person& who, const robot::RobotPlacement& placement, const robot::ReadyPose& start,
      const session::Config& config, std::uint64_t seed, const Device& device);
  TeachingStage(const TeachingStage&) = delete;
  TeachingStage& operator=(const TeachingStage&) = delete;

  [[nodiscard]] robot::Robot& robot() { return far_ ? far_->robot() : world->robot(); }
  [[nodiscard]] link::Supervisor& guard();
  /// Of each reading first: what is true in its millisecond.
  void hear(const robot::RobotReading& reading) noexcept {
    if (told_) told_->tell(reading);
  }
  [[nodiscard]] const robot::RobotMount& mount() const { return world->mount(); }
  [[nodiscard]] TeachRow row(Arm arm, double time_s) const;

  std::unique_ptr<sim::World> world;
  PerArm<robot::ArmModel> models;
  PerArm<session::ControlledArm> arms;  // they look at `models`

 private:
  explicit TeachingStage(std::unique_ptr<sim::World> made);

  link::OwnSupervisor own_;
  std::unique_ptr<DeviceArms> far_;
  std::optional<LinkedTruth> told_;
};

}  // namespace tuina::app
