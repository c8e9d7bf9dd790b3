// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <memory>
#include <string>

#include "tuina/link/guard_process.hpp"
#include "tuina/link/linked_robot.hpp"
#include "tuina/session/observer.hpp"
#include "tuina/sim/world.hpp"

namespace tuina::app {

/// What only the simulation knows of the last milliseconds, from the process that simulates the
/// robot to the one that judges the session. Both are the same program, so it goes as it is in
/// memory.
struct TruthPage {
  static constexpr std::size_t kept = 64;  ///< who looks on at real pace may be behind
  struct Bytes {
    std::uint64_t tick = 0;
    alignas(sim::PlantTruth) std::array<std::byte, sizeof(sim::PlantTruth)> of = {};
  };
  std::array<link::Slot<Bytes>, kept> ticks;
  /// Person, seed and robot (`world_name`), where the session did not start the robot itself.
  std::array<char, 256> world = {};
  /// The wrist sensors by which the arms feel; empty where they say it themselves.
  PerArm<std::array<char, 64>> wrists = {};
};
using SharedTruth = link::SharedPage<TruthPage>;
[[nodiscard]] std::string truth_name(const std::string& link);
/// Takes away what a session that was killed shared with its guard and its robot.
void clear_left(const std::string& link);

/// What a simulated robot tells when it ends.
struct RobotReport {
  std::uint64_t ticks = 0;
  std::uint64_t silent_ticks = 0;  ///< without a word from the guard
  double max_force_n = 0.0;        ///< largest true force on either tool
  double over_60_n_s = 0.0;        ///< time above 60 N until now
  double max_over_60_n_s = 0.0;    ///< longest time above 60 N

  /// One millisecond more.
  void see(const sim::PlantTruth& truth) noexcept;
};

/// Tells the session what is true in this millisecond.
void tell_truth(SharedTruth& shared, std::uint64_t tick, const sim::PlantTruth& truth) noexcept;

/// The robot of a world as a process: stands where the session wants it, then tells its sensors and
/// does what the guard says, until the session is over, `ends`, or the guard has been silent for
/// three seconds of the robot's time, as it is once the session was killed. Fails with
/// Fault::device when no guard comes.
[[nodiscard]] Result<RobotReport> keep_robot(link::Link& link, SharedTruth& truth,
                                             sim::World& world, link::Pace pace,
                                             const std::atomic<bool>& ends);

/// Tells the world of a session what the process with its robot says to be true; the first of its
/// observers.
class LinkedTruth final : public session::Observer {
 public:
  /// Both must outlive it.
  LinkedTruth(const SharedTruth& shared, sim::World& world) : shared_(shared), world_(world) {}
  void on_tick(const session::Tick& tick) noexcept override { tell(tick.reading); }
  /// What is true in the millisecond of a reading.
  void tell(const robot::RobotReading& reading) noexcept;
  /// Milliseconds whose truth was not there, because it is told elsewhere or was read too late.
  [[nodiscard]] std::uint64_t missed() const noexcept { return missed_; }

 private:
  const SharedTruth& shared_;
  sim::World& world_;
  std::uint64_t missed_ = 0;
  bool told_ = false;
};

/// A robot and a guard in processes of their own, started by this one and ended with it.
class Processes {
 public:
  /// `robot_arguments` are those of `tuina robot simulate`, without the link; without a name the
  /// link gets that of this process.
  [[nodiscard]] static Result<std::unique_ptr<Processes>> start(
      const std::vector<std::string>& robot_arguments, link::Pace pace,
      const std::string& link_name);
  ~Processes();
  Processes(const Processes&) = delete;
  Processes& operator=(const Processes&) = delete;

  [[nodiscard]] link::LinkedRobot& robot() noexcept { return *robot_; }
  [[nodiscard]] const SharedTruth& truth() const noexcept { return truth_; }

 private:
  Processes() = default;
  /// Starts this program once more; the number of the process.
  [[nodiscard]] Result<int> run(const std::vector<std::string>& arguments);
  [[nodiscard]] Result<void> start_guard(const link::Arming& arming,
                                         const std::vector<std::string>& arguments);
  /// Waits for a child to end, and ends it when it hangs.
  void end(int child);

  std::string link_name_, arming_file_;
  SharedTruth truth_;
  std::unique_ptr<link::LinkedRobot> robot_;
  std::vector<int> children_;
  int guard_ = 0;  ///< the newest of them that guards; 0: none yet
};

}  // namespace tuina::app
