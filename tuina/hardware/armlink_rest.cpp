// SPDX-License-Identifier: Apache-2.0
// What two arms at the other ends of armlink are told while nobody commands them.
#include <condition_variable>
#include <mutex>
#include <system_error>

#include "tuina/hardware/armlink_robot.hpp"

namespace tuina::hardware {

using namespace std::chrono_literals;

void ArmlinkRobot::rest() noexcept {
  if (faulty_ || !standing_ || keeper_.joinable()) return;
  constexpr auto rest_patience = 200ms;
  // The last torques count for one more cycle; what came right behind them would undo them.
  const auto obeyed_by =
      Clock::now() + (lock_step() ? Clock::duration(rest_patience) : cycle_patience);
  while (note_faults() && !(peers_[Arm::left].obeyed() && peers_[Arm::right].obeyed()) &&
         Clock::now() < obeyed_by) {
    wait_for_either(obeyed_by);
    (void)hear_both();
  }
  resting_ = true;
  again_at_.reset();
  const PerArm<JointVector> here = {
      .of = {peers_[Arm::left].state().q_rad, peers_[Arm::right].state().q_rad}};
  const double rail_m = peers_[Arm::left].state().rail_m;
  const auto deadline = Clock::now() + rest_patience;
  do {
    hold_ready(here, rail_m);
    wait_for_either(Clock::now() + cycle);
    (void)hear_both();
  } while (note_faults() && !both(0) && Clock::now() < deadline);
  keep_resting(here, rail_m);
}

/// Says the same for as long as the arms rest: an arm whose host is silent is anybody's.
void ArmlinkRobot::keep_resting(const PerArm<JointVector>& here, double rail_m) noexcept {
  try {
    keeper_ = std::jthread([this, here, rail_m](const std::stop_token& stop) {
      std::mutex mutex;
      std::condition_variable_any woken;
      std::unique_lock lock(mutex);
      const auto ends = [&] { return stop.stop_requested(); };
      do {
        hold_ready(here, rail_m);
        (void)hear_both();
      } while (note_faults() && !woken.wait_for(lock, stop, repeat_ready_every, ends));
    });
  } catch (const std::system_error&) {
    break_off(Arm::left, "has a host without a thread left to hold it by");
  }
}

void ArmlinkRobot::end_rest() noexcept {
  if (!keeper_.joinable()) return;
  keeper_.request_stop();
  keeper_.join();
}

}  // namespace tuina::hardware
