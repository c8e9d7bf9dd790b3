// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <functional>
#include <optional>

#include "apps/simulated/devices/emulated_wrist.hpp"
#include "apps/simulated/robot_process.hpp"
#include "tuina/hardware/armlink.hpp"
#include "tuina/hardware/udp_socket.hpp"
#include "tuina/robot/arm_model.hpp"
#include "tuina/sim/world.hpp"

namespace tuina::app {

/// Drives of a robot at the other ends of armlink bear so many cycles without a command.
inline constexpr int armlink_watchdog_ticks = hardware::armlink::max_missed_cycles;

/// Torques of drives that hold an arm at a place, each joint on a spring.
[[nodiscard]] JointVector hold_at(const JointVector& place_rad, const robot::ArmModel& model,
                                  const robot::ArmReading& told, double rail_m);

/// The arm's side of armlink for both arms of a simulated robot (docs/armlink.md).
class ArmlinkArms {
 public:
  /// The left arm at this address, the right one at the next port; both are called `name`. Fails
  /// with Fault::device.
  [[nodiscard]] static Result<ArmlinkArms> listen(const hardware::UdpAddress& left,
                                                  const std::string& name, const sim::World& world,
                                                  link::Pace pace);

  /// What the arms feel goes to these sensors; armlink's wrenches are zeros from now on.
  void feel_by(PerArm<std::unique_ptr<EmulatedWrist>> wrists) { wrists_ = std::move(wrists); }

  /// A hand on an arm, told of each millisecond.
  void lead_by(std::function<void(sim::World& world, double time_s)> hand) {
    hand_ = std::move(hand);
  }

  /// One session: waits for a host, stands where it wants, tells and obeys until the host ends it
  /// or has been silent for as long as arms take to stop by themselves, or `ends`.
  [[nodiscard]] Result<RobotReport> keep(sim::World& world, SharedTruth& truth,
                                         const std::atomic<bool>& ends);

 private:
  struct End {
    hardware::UdpSocket socket;
    hardware::UdpAddress host = {};
    hardware::armlink::Command last = {};  ///< newest one that was obeyed; session 0: none
    hardware::armlink::State state = {};
    bool fresh = false;  ///< a new command has come since the state was told
    bool heard = false;  ///< or one again
  };
  ArmlinkArms(PerArm<End> ends, hardware::armlink::Hello hello, link::Pace pace)
      : ends_(std::move(ends)), hello_(std::move(hello)), pace_(pace) {}
  void say_hello(End& end, const hardware::armlink::Ask& ask, const hardware::UdpAddress& asker);
  void obey(End& end, const hardware::armlink::Command& command, const hardware::UdpAddress& from);
  void hear(std::chrono::steady_clock::time_point until);
  void tell();
  [[nodiscard]] bool both_in(hardware::armlink::Mode mode) const;
  [[nodiscard]] bool answered() const;
  [[nodiscard]] bool heard() const;
  [[nodiscard]] bool left() const;
  void wait_for_commands(std::chrono::steady_clock::time_point next, const std::atomic<bool>& ends);
  [[nodiscard]] bool goes() const;
  void begin_way();
  [[nodiscard]] robot::RobotCommand own_drives(const robot::RobotReading& reading,
                                               const sim::World& world);
  void set_states(const robot::RobotReading& reading, const sim::World& world);

  PerArm<End> ends_;
  PerArm<std::unique_ptr<EmulatedWrist>> wrists_ = {};
  std::function<void(sim::World& world, double time_s)> hand_ = {};
  hardware::armlink::Hello hello_;
  link::Pace pace_;
  int missed_ = 0;        ///< cycles in a row in which not both arms heard their host
  bool stopped_ = false;  ///< by themselves
  /// From one place in mode ready to another.
  struct Way {
    PerArm<JointVector> from, to;
    int ticks = 0, passed = 0;
  };
  std::optional<Way> way_;
};

}  // namespace tuina::app
