// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "tuina/hardware/can/can_bus.hpp"
#include "tuina/hardware/can/drive.hpp"
#include "tuina/hardware/can/first_fault.hpp"
#include "tuina/robot/arm_table.hpp"
#include "tuina/robot/mount.hpp"
#include "tuina/robot/robot.hpp"

namespace tuina::hardware {

/// Where the buses of a robot come from.
struct CanBuses {
  std::function<Result<CanBus>(const std::string& name)> open = CanBus::open;
  /// For emulated drives only: a millisecond lasts until all drives have told, `patience` at
  /// most.
  bool wait = false;
  std::chrono::milliseconds patience{200};
};

/// What came over the buses since the first reading.
struct DriveTraffic {
  std::uint64_t cycles = 0;         ///< SYNCs that were sent
  std::uint64_t late = 0;           ///< milliseconds that the host has let pass without one
  PerArm<std::uint64_t> lost = {};  ///< a drive had told nothing when its time was over
};

/// A robot whose joints are drives of CiA 402 on CAN (docs/can_drives.md). Its host has the clock:
/// in each millisecond `read` sends a SYNC on all buses and hears the drives, `apply` sends them
/// torques that count from the next SYNC on, so every reading tells of the command before the
/// newest.
///
/// Drives feel no contact and have no linear base: the wrench of a reading is zero and as old as
/// the session, until a `WristRobot` puts that of real sensors in its place, and the table's base
/// must have no way to go. After a fault, or when the host falls silent for 20 ms, every drive
/// stops by its own ramp and its brake closes; drives cannot do more of what `robot::Robot` asks of
/// a watchdog.
class Cia402Robot final : public robot::Robot {
 public:
  /// Asks every drive who it is and sets it up, at rest. Fails with Fault::config where the file
  /// and the table do not fit each other or a bus cannot carry its drives, with Fault::device where
  /// a drive is missing, another one, in fault, or stands beyond its joint's limits.
  [[nodiscard]] static Result<std::unique_ptr<Cia402Robot>> open(const PerArm<DrivenArm>& arms,
                                                                 const robot::ArmTable& table,
                                                                 const robot::RobotMount& mount,
                                                                 const CanBuses& buses = {});
  /// Ends the session: the brakes close.
  ~Cia402Robot() override;

  /// All joints together, the farthest by 15 degrees a second. They hold what they have reached,
  /// host or no host, until the first command.
  [[nodiscard]] Result<void> stand_ready(const robot::ReadyPose& pose) override;
  /// Waits for the next millisecond and, 0.7 ms at most, for the drives.
  [[nodiscard]] std::optional<robot::RobotReading> read() noexcept override;
  void apply(const robot::RobotCommand& command) noexcept override;
  [[nodiscard]] const char* fault() const noexcept override { return fault_.words(); }
  /// Nobody commands until the next `read`, as while a person is scanned again: the arms stand on
  /// their brakes, and a thread of this class keeps the host's heartbeat up. Time stands still.
  void rest() noexcept;
  [[nodiscard]] const DriveTraffic& traffic() const noexcept { return traffic_; }

 private:
  using Clock = std::chrono::steady_clock;
  struct Seat {  ///< where a drive sits
    Arm arm = Arm::left;
    int joint = 0;
    std::size_t bus = 0;
  };
  Cia402Robot() = default;
  [[nodiscard]] Result<void> add_drive(const DriveDevice& device, Arm arm, int joint,
                                       const robot::Link& link, const CanBuses& buses);
  void begin_cycles() noexcept;
  void cycle() noexcept;
  void hear() noexcept;
  void send(std::size_t drive, const can_frame& frame) noexcept;
  void send_to_all_buses(const can_frame& frame) noexcept;
  void note_faults() noexcept;
  void say_heartbeat() noexcept;
  void end_rest() noexcept;
  void break_off(const char* whose, const std::string& name, const char* why) noexcept;
  [[nodiscard]] Result<void> enable_all();
  [[nodiscard]] Result<void> move_to(const std::vector<double>& q_rad);
  [[nodiscard]] bool all(bool (*holds)(const Drive&)) const noexcept;

  std::vector<CanBus> buses_;
  std::vector<Drive> drives_;  ///< of the left arm from its shoulder on, then of the right
  std::vector<Seat> seats_;    ///< of each of them
  bool lock_step_ = false;
  Clock::duration patience_ = {};  ///< with the drives, from the SYNC on
  double rail_m_ = 0.0;            ///< where the base stands for ever
  bool standing_ = false;          ///< a session has begun
  bool in_cycles_ = false;
  std::atomic<bool> rests_ = false;
  std::thread keeper_;      ///< while it rests, and then the only one that has buses and drives
  Clock::time_point next_;  ///< when the next millisecond begins
  std::uint64_t tick_ = 0;
  std::optional<std::uint64_t> first_tick_;  ///< that a reading told
  std::uint64_t commands_ = 0;
  DriveTraffic traffic_;
  FirstFault fault_;
};

}  // namespace tuina::hardware
