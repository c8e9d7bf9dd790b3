// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <deque>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/simulated/can/emulated_drive.hpp"
#include "apps/simulated/devices/emulated_wrist.hpp"
#include "apps/simulated/robot_process.hpp"
#include "tuina/robot/arm_model.hpp"
#include "tuina/sim/world.hpp"

namespace tuina::app {

/// The drives' side of CAN for both arms of a simulated robot (docs/can_drives.md): two buses to an
/// arm, on each of them emulated drives of CiA 402. What the drives give turns the joints in the
/// plant, and their encoders tell where those are. Time goes by the host's SYNC, and stands still
/// until it comes.
///
/// Until the first torque the drives alone have the joints, and follow their host exactly; the
/// plant begins where they have come to stand.
class CanArms {
 public:
  /// A bus whose plug is pulled; by the robot's clock, which begins with the first torque.
  struct Unplug {
    std::size_t bus = 0;
    double at_s = std::numeric_limits<double>::infinity();
  };

  /// `name` is the program of the buses' names; the motors' encoders count so much in a turn, which
  /// is a hundredth of the joint's. Fails with Fault::device.
  [[nodiscard]] static Result<std::unique_ptr<CanArms>> listen(const std::string& name,
                                                               const sim::World& world,
                                                               int counts_per_turn);
  ~CanArms();
  CanArms(const CanArms&) = delete;
  CanArms& operator=(const CanArms&) = delete;

  /// What the arms feel goes to these sensors.
  void feel_by(PerArm<std::unique_ptr<EmulatedWrist>> wrists) { wrists_ = std::move(wrists); }
  void unplug(const Unplug& unplug) { unplug_ = unplug; }
  /// A hand on an arm, told of each millisecond.
  void lead_by(std::function<void(sim::World& world, double time_s)> hand) {
    hand_ = std::move(hand);
  }
  /// An arm's section of a device file.
  [[nodiscard]] std::string section(Arm arm) const;

  /// One session: until its host is gone and the drives have brought the arms to rest, or `ends`.
  [[nodiscard]] Result<RobotReport> keep(sim::World& world, SharedTruth& truth,
                                         const std::atomic<bool>& ends);

 private:
  using Clock = std::chrono::steady_clock;
  struct Bus {
    std::string name;
    int door = -1, host = -1;
    bool synced = false;     ///< a SYNC has come, and waits for those of the other buses
    bool unplugged = false;  ///< for ever
  };
  struct Seat {  ///< where a drive sits
    Arm arm = Arm::left;
    int joint = 0;
    std::size_t bus = 0;
  };
  explicit CanArms(const sim::World& world);
  void add_drives(const std::string& name, const robot::ArmTable& table, int counts_per_turn);
  void hear();
  void serve(std::size_t bus);
  void hang_up(Bus& bus);
  [[nodiscard]] bool all_synced() const;
  [[nodiscard]] bool host_gone() const;
  [[nodiscard]] bool given_up() const;
  void look_whether_they_stand(sim::World& world, SharedTruth& truth);
  void cycle(sim::World& world, SharedTruth& truth, RobotReport& report);
  void begin_millisecond(sim::World& world, SharedTruth& truth);
  void end_millisecond(sim::World& world, RobotReport& report);
  void pass_alone(sim::World& world, SharedTruth& truth, RobotReport& report);
  void miss_host();

  PerArm<robot::ArmModel> models_;
  std::vector<Bus> buses_;
  std::deque<EmulatedDrive> drives_;  ///< of the left arm from its shoulder on, then of the right
  std::vector<Seat> seats_;           ///< of each of them
  PerArm<std::unique_ptr<EmulatedWrist>> wrists_ = {};
  Unplug unplug_;
  std::function<void(sim::World& world, double time_s)> hand_ = {};
  std::vector<std::uint32_t> wanted_;  ///< counts where the drives should be, by the last SYNC
  int syncs_at_rest_ = 0;              ///< since that has changed
  std::optional<robot::RobotReading> seen_;  ///< newest of the plant; nothing before it begins
  PerArm<JointVector> held_rad_ = {};        ///< where joints stand that obey no torques
  bool begun_ = false;                       ///< a drive has obeyed a torque
  std::uint64_t tick_ = 0;                   ///< that the drives tell of, as the host counts
  Clock::time_point last_sync_;
  int ms_without_host_ = 0;  ///< of a bus that is unplugged, or of all of them
  std::string fault_;
};

}  // namespace tuina::app
