// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <thread>

#include "tuina/core/ring.hpp"
#include "tuina/session/observer.hpp"

namespace tuina::session {

/// Carries the milliseconds of a session to an observer that may be slow - a terminal, a file, a
/// network - on a thread of its own. The session never waits for it: when the observer falls more
/// than four seconds behind, milliseconds are left out and counted. Only a simulation that
/// runs as fast as it can may wait (`Behind::wait`): it keeps pace with no clock. Scan, map and
/// plan are passed on at once, after the milliseconds before them; `on_performed` is not, since a
/// `Tick` tells of the path that ended. An observer that has not caught up within a second when one
/// of them comes is told nothing any more.
class Relay final : public Observer {
 public:
  /// What becomes of a millisecond for which there is no room.
  enum class Behind : std::uint8_t { leave_out, wait };

  /// `slow` must outlive it.
  explicit Relay(Observer& slow, Behind behind = Behind::leave_out);
  /// Passes on what is left, then ends.
  ~Relay() override;
  Relay(const Relay&) = delete;
  Relay& operator=(const Relay&) = delete;

  void on_progress(Stage stage, double share) noexcept override;
  void on_profile(const scanner::LiveProfile& profile) override;
  void on_scan(const scanner::Scan& scan) override;
  void on_map(const body::Mapping& map) override;
  void on_plan(const motion::ReadyPlan& plan, const Transform& base_from_couch) override;
  void on_tick(const Tick& tick) noexcept override;

  /// How many milliseconds the observer was too slow for.
  [[nodiscard]] std::uint64_t left_out() const noexcept { return left_out_; }

 private:
  void carry();
  /// Waits until the observer has seen every millisecond; false once it has taken too long.
  [[nodiscard]] bool caught_up() noexcept;

  static constexpr std::size_t ticks = 4096;
  Observer& slow_;
  Behind behind_;
  std::unique_ptr<Ring<Tick, ticks>> ring_;
  std::atomic<double> massage_share_ = -1.0;
  std::uint64_t pushed_ = 0;                ///< milliseconds given to the ring
  std::atomic<std::uint64_t> carried_ = 0;  ///< milliseconds that the observer has seen
  std::atomic<bool> ends_ = false;
  std::uint64_t left_out_ = 0;
  bool given_up_ = false;
  std::thread thread_;
};

}  // namespace tuina::session
