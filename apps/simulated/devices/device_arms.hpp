// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "apps/simulated/robot_process.hpp"
#include "tuina/hardware/armlink_robot.hpp"
#include "tuina/hardware/can/cia402_robot.hpp"
#include "tuina/hardware/device_file.hpp"
#include "tuina/hardware/wrist_robot.hpp"
#include "tuina/record/session_file.hpp"
#include "tuina/robot/robot_model.hpp"

namespace tuina::app {

/// A device file that names arms; what else it names, the session may need or not.
[[nodiscard]] Result<hardware::DeviceFile> read_arms(const std::string& device_file);
/// Kind and addresses of its arms, for people.
[[nodiscard]] std::string name_of_arms(const hardware::DeviceFile& file);

/// The arms and wrist sensors that a device file names, and their guard, which runs in this
/// process: it is the last that decides, right before the commands leave.
class DeviceArms final : public link::Supervisor {
 public:
  /// Fails with Fault::device where an arm is missing or another than the robot's.
  /// `world_name` is what the arms' own program must call its world, in which the scanner is
  /// simulated, too: an arm that is real fails then, for it must not press where a simulated person
  /// was seen, and wrist sensors must be those by which the simulated arms feel. It is empty where
  /// a real scanner sees the person: the arms may be any, and nobody tells what is true of them.
  [[nodiscard]] static Result<std::unique_ptr<DeviceArms>> open(
      const std::string& device_file, const robot::RobotPlacement& placement,
      const std::string& world_name);

  ~DeviceArms() override;
  DeviceArms(const DeviceArms&) = delete;
  DeviceArms& operator=(const DeviceArms&) = delete;

  [[nodiscard]] robot::Robot& robot() noexcept { return *wrists_; }
  /// Only where there is a world.
  [[nodiscard]] const SharedTruth& truth() const noexcept { return *truth_; }
  [[nodiscard]] record::DeviceRecord record(std::uint64_t truth_missed) const;
  /// Whether the arms are simulated ones that wait for each command; others wait for nobody.
  [[nodiscard]] bool lock_step() const noexcept;

  /// Where the arms do not wait, this thread is a real-time one from here on, as far as it may be,
  /// until they rest or this ends.
  [[nodiscard]] Result<void> arm(const link::Arming& arming) override;
  [[nodiscard]] safety::RobotVerdict check(
      const robot::RobotReading& reading, const safety::RobotProposal& proposal) noexcept override {
    return guard_.check(reading, proposal);
  }
  /// The arms stand by their own drives until the next guard has come; this thread, which may have
  /// a scan to compute, is one among others again.
  void rest() noexcept override;
  void expect_stop() noexcept override { guard_.expect_stop(); }

 private:
  DeviceArms() = default;
  [[nodiscard]] Result<void> open_armlink(const hardware::DeviceFile& file,
                                          const robot::RobotPlacement& placement,
                                          const std::string& world_name);
  [[nodiscard]] Result<void> open_drives(const hardware::DeviceFile& file,
                                         const robot::RobotPlacement& placement,
                                         const std::string& world_name);
  [[nodiscard]] record::DeviceRecord::Traffic traffic(Arm arm) const;

  std::string named_;  ///< kind and addresses
  /// @{
  /// One of these, and the same arms joined with their sensors.
  std::unique_ptr<hardware::ArmlinkRobot> armlink_;
  std::unique_ptr<hardware::Cia402Robot> drives_;
  bool drives_wait_ = false;  ///< they are emulated
  std::unique_ptr<hardware::WristRobot> wrists_;
  /// @}
  std::optional<SharedTruth> truth_;  ///< none without a world
  link::OwnSupervisor guard_;
  std::string pace_;  ///< and what was granted for a real one
};

}  // namespace tuina::app
