// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "tuina/hardware/arm_peer.hpp"
#include "tuina/hardware/device_file.hpp"
#include "tuina/robot/arm_table.hpp"
#include "tuina/robot/mount.hpp"
#include "tuina/robot/robot.hpp"

namespace tuina::hardware {

/// From the count and the clock of an arm to those of the readings.
struct ArmZero {
  std::uint32_t sequence = 0;
  double time_s = 0.0;
};

/// A robot of two arms, each at the other end of armlink (docs/armlink.md). The left arm's
/// datagrams carry the linear base: both arms ride on it, so one of them must, and the guard
/// watches its place by the clock of the arm that told it.
///
/// Readings have the left arm's clock and count, from zero at the first one; the right arm's are
/// mapped onto them. Where one arm gives nothing in a cycle, its last state is in the reading once
/// more, with the old time of its wrist sensor, by which the guard knows; an arm that was silent
/// for three cycles is commanded no more, and stops by itself.
///
/// While `read` waits, the last command is sent again each half cycle, so that a datagram that is
/// lost or late is no missed cycle for the arm.
class ArmlinkRobot final : public robot::Robot {
 public:
  /// Asks both arms who they are. Fails with Fault::device when one is not there, is another
  /// host's, or has less than the table believes: joints, torques, speeds, angles, linear base, the
  /// cycle.
  [[nodiscard]] static Result<std::unique_ptr<ArmlinkRobot>> open(const PerArm<ArmDevice>& arms,
                                                                  const robot::ArmTable& table,
                                                                  const robot::RobotMount& mount);
  /// Ends the session: the brakes close.
  ~ArmlinkRobot() override;

  /// By the arms' own drives, within a minute.
  [[nodiscard]] Result<void> stand_ready(const robot::ReadyPose& pose) override;
  /// From where they stand to another place, likewise; only before the first torques and between
  /// `rest` and the next.
  [[nodiscard]] Result<void> move_to(const robot::ReadyPose& pose);
  /// Waits for both arms, but not for one that is silent, and for 2 ms at most; where the arms are
  /// simulated and wait for their host, for 6 s.
  [[nodiscard]] std::optional<robot::RobotReading> read() noexcept override;
  void apply(const robot::RobotCommand& command) noexcept override;
  [[nodiscard]] const char* fault() const noexcept override {
    return faulty_ ? fault_.data() : nullptr;
  }
  /// The arms hold where they are by their own drives until the next `apply`, and stay this host's.
  /// May take 0.2 s.
  void rest() noexcept;

  /// Whether nobody can be touched by either arm.
  [[nodiscard]] bool simulated() const noexcept;
  /// Whether both arms wait for their host.
  [[nodiscard]] bool lock_step() const noexcept;
  /// The arm's end of the network, to ask what came over it. Arms that rest are told nothing from
  /// here on until the next `rest`.
  [[nodiscard]] const ArmPeer& peer(Arm arm) noexcept {
    end_rest();
    return peers_[arm];
  }

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr auto cycle = std::chrono::milliseconds(1);
  static constexpr auto cycle_patience = 2 * cycle;  ///< for the first of the two arms
  static constexpr auto repeat_ready_every = std::chrono::milliseconds(10);
  explicit ArmlinkRobot(PerArm<ArmPeer> peers) : peers_(std::move(peers)) {}
  [[nodiscard]] bool note_faults() noexcept;
  void break_off(Arm arm, const char* why) noexcept;
  void wait_for_either(Clock::time_point deadline) const noexcept;
  [[nodiscard]] PerArm<bool> hear_both() noexcept;
  void forget_queued() noexcept;
  void say_again() noexcept;
  [[nodiscard]] std::optional<robot::RobotReading> reading_of(const PerArm<bool>& fresh) noexcept;
  void keep_resting(const PerArm<JointVector>& here, double rail_m) noexcept;
  void end_rest() noexcept;
  void hold_ready(const PerArm<JointVector>& q_rad, double rail_m) noexcept;
  [[nodiscard]] bool both(std::uint16_t status_bit) const noexcept;

  PerArm<ArmPeer> peers_;
  PerArm<int> silent_cycles_ = {};
  bool standing_ = false;  ///< a session has begun
  bool resting_ = false;   ///< nobody has applied anything since the arms stand by themselves
  Clock::time_point last_reading_;
  std::optional<Clock::time_point> again_at_;  ///< when the last command is due once more
  std::optional<PerArm<ArmZero>> zero_;        ///< set by the first reading
  std::optional<std::uint64_t> last_tick_;
  std::atomic<bool> faulty_ = false;
  std::array<char, 160> fault_ = {};  ///< written before it is faulty
  std::jthread keeper_;               ///< only while the arms rest; nobody else talks to them then
};

}  // namespace tuina::hardware
