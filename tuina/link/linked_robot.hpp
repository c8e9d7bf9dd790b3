// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "tuina/link/guard_process.hpp"
#include "tuina/link/supervisor.hpp"
#include "tuina/robot/robot.hpp"

namespace tuina::link {

/// The robot and its guard when both are processes of their own: what the session reads the drives
/// sent, and what it proposes goes to the guard, which tells the drives. It is real-time after
/// `stand_ready`, but for `arm`.
class LinkedRobot final : public robot::Robot, public Supervisor {
 public:
  /// `start_guard` starts the process that is to guard with this arming; it need not wait for it.
  /// `guard_began` is called, if given, once that process has understood it.
  LinkedRobot(Link link, Pace pace, std::function<Result<void>(const Arming&)> start_guard,
              std::function<void()> guard_began = {})
      : link_(std::move(link)),
        pace_(pace),
        start_guard_(std::move(start_guard)),
        guard_began_(std::move(guard_began)) {}
  /// Tells the drives that the session is over.
  ~LinkedRobot() override;

  /// Once for each rest: a guard in its own process ends with the massage that it was armed for,
  /// and the next massage has a new one. At real pace the calling thread is a real-time one from
  /// then on until it rests, where that is granted.
  [[nodiscard]] Result<void> arm(const Arming& arming) override;
  /// The guard ends, and the drives hold the arms until the next one has come.
  void rest() noexcept override;
  /// A guard that gives no answer is told as a stop, of both arms, after 20 ms; the drives brake by
  /// themselves then.
  [[nodiscard]] safety::RobotVerdict check(const robot::RobotReading& reading,
                                           const safety::RobotProposal& proposal) noexcept override;
  void expect_stop() noexcept override { stop_asked_ = true; }

  [[nodiscard]] Result<void> stand_ready(const robot::ReadyPose& pose) override;
  [[nodiscard]] std::optional<robot::RobotReading> read() noexcept override;
  /// The guard has done it.
  void apply(const robot::RobotCommand&) noexcept override {}
  [[nodiscard]] const char* fault() const noexcept override { return nullptr; }

 private:
  [[nodiscard]] Link::Deadline patience(bool there) const noexcept;

  Link link_;
  Pace pace_;
  std::function<Result<void>(const Arming&)> start_guard_;
  std::function<void()> guard_began_;
  bool armed_ = false, stop_asked_ = false;
  wire::StandFrame wish_;
  std::optional<std::uint64_t> last_tick_;
  int silent_ticks_ = 0;
  safety::RobotVerdict last_;
};

}  // namespace tuina::link
