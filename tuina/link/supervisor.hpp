// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "tuina/link/arming.hpp"
#include "tuina/safety/robot_guard.hpp"

namespace tuina::link {

/// Where the guard of a session runs: in the session's own process, or in one that outlives it.
class Supervisor {
 public:
  virtual ~Supervisor() = default;
  /// A new guard for this robot and this person; what was latched before is over.
  [[nodiscard]] virtual Result<void> arm(const Arming& arming) = 0;
  /// Only after `arm`. Real-time.
  [[nodiscard]] virtual safety::RobotVerdict check(
      const robot::RobotReading& reading, const safety::RobotProposal& proposal) noexcept = 0;
  /// The arms have come home and are not driven until the next `arm`.
  virtual void rest() noexcept = 0;
  /// Somebody has told the controller to stop.
  virtual void expect_stop() noexcept = 0;

 protected:
  Supervisor() = default;
  Supervisor(const Supervisor&) = default;
  Supervisor& operator=(const Supervisor&) = default;
};

/// The guard within this process.
class OwnSupervisor final : public Supervisor {
 public:
  [[nodiscard]] Result<void> arm(const Arming& arming) override {
    guard_.emplace(robot::both_models(arming.arm, arming.mount), arming.options);
    return {};
  }
  [[nodiscard]] safety::RobotVerdict check(
      const robot::RobotReading& reading, const safety::RobotProposal& proposal) noexcept override {
    return guard_->check(reading, proposal);
  }
  void rest() noexcept override {}
  void expect_stop() noexcept override { guard_->expect_stop(); }

 private:
  std::optional<safety::RobotGuard> guard_;
};

}  // namespace tuina::link
