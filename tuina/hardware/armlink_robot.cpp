// SPDX-License-Identifier: Apache-2.0
#include "tuina/hardware/armlink_robot.hpp"

#include <algorithm>

namespace tuina::hardware {
namespace {

using armlink::Mode;
using namespace std::chrono_literals;

constexpr auto late_arm_patience = 1500us;  // from one reading to the next with one arm only
constexpr auto again_every = 500us;         // so that one lost or late datagram is no missed cycle
constexpr auto lock_step_patience = 6s;
constexpr auto stand_patience = 60s, join_patience = 2s;
constexpr int max_silent_reads = 5;     // of both arms; one alone is the guard's to judge ...
constexpr int max_silent_cycles = 100;  // ... for so long

Result<ArmPeer> open_arm(const PerArm<ArmDevice>& arms, Arm arm) {
  auto peer = ArmPeer::open(arms[arm].udp);
  if (peer) return peer;
  return fail(peer.error().fault, "the {} arm at {}: {}", name_of(arm), arms[arm].address,
              peer.error().message);
}

}  // namespace

Result<std::unique_ptr<ArmlinkRobot>> ArmlinkRobot::open(const PerArm<ArmDevice>& arms,
                                                         const robot::ArmTable& table,
                                                         const robot::RobotMount& mount) {
  auto left = open_arm(arms, Arm::left);
  if (!left) return tl::unexpected(left.error());
  auto right = open_arm(arms, Arm::right);
  if (!right) return tl::unexpected(right.error());
  std::unique_ptr<ArmlinkRobot> made(
      new ArmlinkRobot({.of = {std::move(*left), std::move(*right)}}));
  for (const Arm arm : both_arms) {
    const ArmPeer& peer = made->peers_[arm];
    const std::string lack = peer.lack_of(table, mount, arm == Arm::left);
    if (!lack.empty())
      return fail(Fault::device, "the {} arm at {} ({}) {}", name_of(arm), arms[arm].address,
                  peer.hello().called(), lack);
  }
  return made;
}

ArmlinkRobot::~ArmlinkRobot() {
  end_rest();
  constexpr int times = 3;  // one of them arrives, or the arm stops by itself
  for (int i = 0; standing_ && i < times; ++i) {
    for (ArmPeer& peer : peers_.of)
      peer.send(Mode::idle, JointVector::Zero(peer.hello().max_torque_nm.size()), 0.0, true);
  }
}

bool ArmlinkRobot::both(std::uint16_t status_bit) const noexcept {
  return std::all_of(peers_.of.begin(), peers_.of.end(), [&](const ArmPeer& peer) {
    return peer.heard_anything() && peer.state().mode == Mode::ready &&
           (peer.state().status & status_bit) == status_bit;
  });
}

void ArmlinkRobot::hold_ready(const PerArm<JointVector>& q_rad, double rail_m) noexcept {
  for (const Arm arm : both_arms) peers_[arm].send(Mode::ready, q_rad[arm], rail_m, false);
}

Result<void> ArmlinkRobot::stand_ready(const robot::ReadyPose& pose) {
  if (standing_) return {};
  standing_ = resting_ = true;
  return move_to(pose);
}

Result<void> ArmlinkRobot::move_to(const robot::ReadyPose& pose) {
  if (!standing_ || !resting_) return fail(Fault::usage, "arms under torque are no place's");
  end_rest();
  const auto begun = Clock::now();
  // That they stand somewhere else says nothing.
  const auto obeyed = [&] { return peers_[Arm::left].obeyed() && peers_[Arm::right].obeyed(); };
  while (Clock::now() < begun + stand_patience) {
    hold_ready(pose.q_rad, pose.rail_m);
    const auto next = Clock::now() + repeat_ready_every;
    while (Clock::now() < next) {
      wait_for_either(next);
      (void)hear_both();
      if (!note_faults()) return fail(Fault::device, "{}", fault_.data());
    }
    if (both(armlink::status::stands) && obeyed()) {
      keep_resting(pose.q_rad, pose.rail_m);
      return {};
    }
    for (const Arm arm : both_arms) {
      // The world of simulated arms is made once both are told where to stand.
      if (peers_[arm].heard_anything() || Clock::now() < begun + join_patience) continue;
      return fail(Fault::device, "the {} arm says nothing once it is told to stand ready",
                  name_of(arm));
    }
  }
  return fail(Fault::device, "the arms do not stand ready after {} s", stand_patience.count());
}

void ArmlinkRobot::break_off(Arm arm, const char* why) noexcept {
  if (faulty_) return;
  std::size_t size = 0;
  for (const std::string_view part : {"the ", name_of(arm), " arm ", why})
    size += part.copy(&fault_[size], fault_.size() - 1 - size);
  fault_[size] = '\0';
  faulty_ = true;
}

bool ArmlinkRobot::lock_step() const noexcept {
  return peers_[Arm::left].waits() && peers_[Arm::right].waits();
}

void ArmlinkRobot::wait_for_either(Clock::time_point deadline) const noexcept {
  const std::array sockets = {peers_[Arm::left].socket(), peers_[Arm::right].socket()};
  wait_for_datagram(sockets, deadline);
}

bool ArmlinkRobot::note_faults() noexcept {
  for (const Arm arm : both_arms)
    if (const char* why = peers_[arm].fault()) break_off(arm, why);
  return !faulty_;
}

// While the arms rest they say the same again; who was told to wait for a command may have lost it.
PerArm<bool> ArmlinkRobot::hear_both() noexcept {
  PerArm<bool> fresh = {};
  for (const Arm arm : both_arms) {
    ArmPeer& peer = peers_[arm];
    const ArmPeer::Heard heard = peer.hear();
    fresh[arm] = heard == ArmPeer::Heard::fresh || (resting_ && heard == ArmPeer::Heard::again);
    if (heard == ArmPeer::Heard::again && !resting_) peer.send_again();
  }
  return fresh;
}

/// What came while nobody listened is old.
void ArmlinkRobot::forget_queued() noexcept {
  constexpr int max_turns = 100;
  for (ArmPeer& peer : peers_.of)
    for (int i = 0; i < max_turns && peer.hear() != ArmPeer::Heard::nothing; ++i) continue;
}

/// The torques of the last command once more, while its arm waits for the next.
void ArmlinkRobot::say_again() noexcept {
  if (!again_at_ || Clock::now() < *again_at_) return;
  again_at_ = Clock::now() + again_every;
  for (const Arm arm : both_arms)
    if (silent_cycles_[arm] < armlink::max_missed_cycles) peers_[arm].send_again();
}

std::optional<robot::RobotReading> ArmlinkRobot::read() noexcept {
  end_rest();
  if (faulty_ || !standing_) return std::nullopt;
  if (resting_) forget_queued();
  const auto begun = Clock::now();
  const bool any_silent = silent_cycles_[Arm::left] > 0 || silent_cycles_[Arm::right] > 0;
  const auto first_by =
      begun + (lock_step() && !any_silent ? Clock::duration(lock_step_patience) : cycle_patience);
  const auto second_by =
      (lock_step() && !any_silent) || resting_
          ? first_by
          : std::max<Clock::time_point>(last_reading_ + late_arm_patience, begun + cycle / 2);
  PerArm<bool> fresh = {};
  for (;;) {
    const PerArm<bool> heard = hear_both();
    bool any = false, enough = true;
    for (const Arm arm : both_arms) {
      fresh[arm] = fresh[arm] || heard[arm];
      any = any || fresh[arm];
      enough = enough && (fresh[arm] || silent_cycles_[arm] >= armlink::max_missed_cycles);
    }
    if (!note_faults()) return std::nullopt;
    const auto until = any ? second_by : first_by;
    if ((any && enough) || Clock::now() >= until) break;
    wait_for_either(again_at_ ? std::min(until, *again_at_) : until);
    say_again();
  }
  last_reading_ = Clock::now();
  for (const Arm arm : both_arms) {
    silent_cycles_[arm] = fresh[arm] ? 0 : silent_cycles_[arm] + 1;
    const bool alone = fresh[other(arm)];
    if (silent_cycles_[arm] >= (alone ? max_silent_cycles : max_silent_reads))
      break_off(arm, "is silent");
  }
  if (faulty_) return std::nullopt;
  auto reading = reading_of(fresh);
  if (reading) again_at_.reset();  // whoever reads and commands nothing is no longer heard
  return reading;
}

std::optional<robot::RobotReading> ArmlinkRobot::reading_of(const PerArm<bool>& fresh) noexcept {
  const Arm leader = fresh[Arm::left] ? Arm::left : Arm::right;
  if (!fresh[leader]) return std::nullopt;
  // What an arm said before a rest is old, and so is what is known of the other arm's clock.
  if ((!zero_ || resting_) && !(fresh[Arm::left] && fresh[Arm::right])) return std::nullopt;
  if (!zero_) {
    zero_.emplace();
    for (const Arm arm : both_arms)
      (*zero_)[arm] = {peers_[arm].state().sequence, peers_[arm].state().time_s};
  }
  const auto tick_of = [&](Arm arm) {
    return peers_[arm].state().sequence - (*zero_)[arm].sequence;
  };
  const auto time_of = [&](Arm arm, double time_s) { return time_s - (*zero_)[arm].time_s; };
  robot::RobotReading reading;
  reading.tick = tick_of(leader);
  reading.time_s = time_of(leader, peers_[leader].state().time_s);
  if (fresh[Arm::left] && fresh[Arm::right]) {
    // The right arm's quartz is another one: its count may slip by one in a while, its clock
    // drifts.
    const double drift_share = resting_ ? 1.0 : 0.01;
    ArmZero& right = (*zero_)[Arm::right];
    const armlink::State& state = peers_[Arm::right].state();
    right.sequence = state.sequence - static_cast<std::uint32_t>(reading.tick);
    right.time_s += drift_share * (time_of(Arm::right, state.time_s) - reading.time_s);
  }
  if (last_tick_ && !resting_ && reading.tick <= *last_tick_) return std::nullopt;
  last_tick_ = reading.tick;
  for (const Arm arm : both_arms) {
    const armlink::State& state = peers_[arm].state();
    reading.arms[arm] = {.q_rad = state.q_rad,
                         .dq_rad_per_s = state.dq_rad_per_s,
                         .wrench_in_tool = state.wrench_in_tool,
                         .wrench_time_s = time_of(arm, state.wrench_time_s),
                         .command_age = peers_[arm].command_age()};
    // What an arm tells beside torques, or in its place, is its own affair.
    const bool measures = (peers_[arm].hello().flags & armlink::flag::measures_torque) != 0;
    if (measures && state.mode == Mode::torque) reading.arms[arm].measured_torque_nm = state.tau_nm;
  }
  reading.rail_m = peers_[Arm::left].state().rail_m;
  return reading;
}

void ArmlinkRobot::apply(const robot::RobotCommand& command) noexcept {
  end_rest();
  if (faulty_ || !standing_) return;
  resting_ = false;
  for (const Arm arm : both_arms) {
    if (silent_cycles_[arm] >= armlink::max_missed_cycles) continue;
    peers_[arm].send(Mode::torque, command.torque_nm[arm], command.rail_m, command.brake[arm]);
  }
  // Arms that wait for their host miss nothing.
  if (!lock_step()) again_at_ = Clock::now() + again_every;
}

bool ArmlinkRobot::simulated() const noexcept {
  return std::all_of(peers_.of.begin(), peers_.of.end(), [](const ArmPeer& peer) {
    return (peer.hello().flags & armlink::flag::simulated) != 0;
  });
}

}  // namespace tuina::hardware
