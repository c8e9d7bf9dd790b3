// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <semaphore.h>

#include <array>
#include <chrono>
#include <string>

#include "tuina/core/result.hpp"
#include "tuina/link/shared_page.hpp"
#include "tuina/link/wire.hpp"

namespace tuina::link {

/// Which process of a robot somebody is. An onlooker only reads, and neither rings nor waits.
enum class Role : std::uint8_t { drives, guard, controller, operating, hand_stop, onlooker };
inline constexpr std::size_t roles = 5;  ///< that write

/// The shared memory of the processes of one robot. Each writes its own frames and has those of the
/// others for reading only. Bells wake who waits; nobody trusts them: a process that rings them
/// wildly or never delays the others by their own deadlines at most.
class Link {
 public:
  /// When a wait ends, by the steady clock.
  using Deadline = std::chrono::steady_clock::time_point;

  /// Makes the memory anew; the process that does so takes it away when it ends.
  [[nodiscard]] static Result<Link> create(const std::string& name, Role role);
  /// Fails with Fault::device when there is none, or one of another layout.
  [[nodiscard]] static Result<Link> open(const std::string& name, Role role);

  /// Takes away the memory of a session that was killed; that of a living one stays. Whoever was
  /// with it keeps what is mapped.
  static void clear_left(const std::string& name);
  /// Whether the process that has made the memory, the controller of a session, still lives.
  [[nodiscard]] bool maker_lives() const noexcept { return controller_.maker_lives(); }

  /// Writes a frame of this process' own kind and rings.
  void write(const wire::SensorFrame& frame) noexcept;
  /// @{
  /// Likewise.
  void write(const wire::ProposalFrame& frame) noexcept;
  void write(const wire::StandFrame& frame) noexcept;
  void write(const wire::DriveFrame& frame) noexcept;
  void write(const wire::WatchFrame& frame) noexcept;
  /// @}

  /// @{
  /// The newest frame of another process, as `Slot::read`.
  [[nodiscard]] auto sensors() const noexcept { return drives_->sensors.read(); }
  [[nodiscard]] auto proposal() const noexcept { return controller_->proposal.read(); }
  [[nodiscard]] auto stand() const noexcept { return controller_->stand.read(); }
  [[nodiscard]] auto drive() const noexcept { return guard_->drive.read(); }
  /// @}
  /// The newest frame of somebody who watches, likewise.
  [[nodiscard]] auto watch(safety::Watcher watcher) const noexcept {
    return watchers_[static_cast<std::size_t>(watcher)]->watch.read();
  }

  /// Waits until somebody rings or until the deadline; may return sooner.
  void wait(Deadline deadline) noexcept;

  /// Waits until `there` gives something, or until the deadline; asks it at least once.
  template <typename There>
  [[nodiscard]] auto wait_for(Deadline deadline, There&& there) noexcept {
    for (;;) {
      auto found = there();
      if (found || std::chrono::steady_clock::now() >= deadline) return found;
      wait(deadline);
    }
  }

 private:
  struct Drives {
    Slot<wire::SensorFrame> sensors;
  };
  struct Controller {
    Slot<wire::ProposalFrame> proposal;
    Slot<wire::StandFrame> stand;
  };
  struct Guard {
    Slot<wire::DriveFrame> drive;
  };
  struct Watch {
    Slot<wire::WatchFrame> watch;
  };
  struct Bells {
    std::array<sem_t, roles> of;
  };
  [[nodiscard]] static Result<Link> map(const std::string& name, Role role, bool make);
  void ring() noexcept;

  Role role_ = Role::controller;
  SharedPage<Drives> drives_;
  SharedPage<Controller> controller_;
  SharedPage<Guard> guard_;
  std::array<SharedPage<Watch>, safety::watchers> watchers_;
  SharedPage<Bells> bells_;
};

}  // namespace tuina::link
