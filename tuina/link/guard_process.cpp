// SPDX-License-Identifier: Apache-2.0
#include "tuina/link/guard_process.hpp"

#include <unistd.h>

#include <algorithm>
#include <chrono>

#include "tuina/core/units.hpp"

namespace tuina::link {
namespace {

using std::chrono::steady_clock;
using namespace std::chrono_literals;

constexpr auto silence = 20s;
// In lock-step a process may be dead, and once it was, it is waited for briefly. The drives wait
// longer for the guard than the guard does for the controller, or they would leave it behind.
constexpr auto lock_step_patience = 2s;
constexpr auto gone_patience = 1ms;
constexpr auto proposal_patience = 600us;  // of the millisecond, at real pace
constexpr double max_in_air_n = 5.0;
// Who ends this process wants no hands on the person: it guards until it has felt no body under
// either tool for so long.
constexpr int has_left_ticks = 500;
// How often a guard without a word looks whether its controller was killed; one that hangs may come
// back.
constexpr std::uint64_t look_every_ticks = 50;

safety::RobotProposal still(const PerArm<robot::ArmModel>& models,
                            const robot::RobotReading& reading) {
  safety::RobotProposal proposal{.rail_m = reading.rail_m};
  for (const Arm arm : both_arms)
    proposal.arms[arm].torque_nm = models[arm].gravity_nm(reading.arms[arm].q_rad);
  return proposal;
}

/// What is wrong with a guard that was just armed, or with what it sees first; null: nothing.
const char* try_out(const PerArm<robot::ArmModel>& models, const Arming& arming,
                    robot::RobotReading reading) {
  for (const Arm arm : both_arms) {
    const robot::ArmReading& sensed = reading.arms[arm];
    if (sensed.q_rad.size() != models[arm].joints()) return "the robot has other joints";
    const Matrix3 base_from_tool =
        models[arm].base_from_tool(sensed.q_rad, reading.rail_m).linear();
    const Vector3 weight_n(0.0, 0.0, -models[arm].table().tool_mass_kg * gravity_m_per_s2);
    const Vector3 felt_n = base_from_tool * sensed.wrench_in_tool.force_n - weight_n;
    if (!(felt_n.norm() <= max_in_air_n)) return "a wrist sensor feels a force in the air";
  }
  const safety::RobotProposal quiet = still(models, reading);
  const auto next = [&] { ++reading.tick, reading.time_s += control_period_s; };
  const auto step = [&](safety::RobotGuard& guard, const safety::RobotProposal& proposal) {
    next();
    for (robot::ArmReading& sensed : reading.arms.of) sensed.wrench_time_s = reading.time_s;
    return guard.check(reading, proposal);
  };
  safety::RobotGuard trial(models, arming.options);
  safety::RobotVerdict verdict;
  for (int i = 0; i < 10; ++i) verdict = step(trial, quiet);
  for (const safety::Verdict& one : verdict.arms.of)
    if (one.action >= safety::Action::freeze) return "the guard stops an arm that stands still";
  safety::RobotProposal broken = quiet;
  for (safety::Proposal& one : broken.arms.of)
    one.torque_nm.setConstant(std::numeric_limits<double>::quiet_NaN());
  for (int i = 0; i < 10; ++i) verdict = step(trial, broken);
  for (const safety::Verdict& one : verdict.arms.of)
    if (!one.latched) return "the guard does not stop torques that are no numbers";
  safety::RobotGuard asked(models, arming.options);
  asked.stop(safety::Cause::asked_to);
  verdict = step(asked, quiet);
  for (const safety::Verdict& one : verdict.arms.of)
    if (!one.latched) return "the guard does not stop when it is asked to";
  return nullptr;
}

/// Which guard of the session is wanted now.
std::uint64_t wished(const Link& link) noexcept {
  const auto stand = link.stand();
  return stand ? stand->guard : 0;
}

/// The next millisecond, or the end of all, or the last one again when `own` is not wanted any
/// more.
std::optional<wire::SensorFrame> next_frame(Link& link, std::optional<std::uint64_t> last_tick,
                                            std::uint64_t own) {
  return link.wait_for(steady_clock::now() + silence, [&]() {
    const auto frame = link.sensors();
    const bool next = frame && frame->stands > 0 && (!last_tick || frame->tick != *last_tick);
    const bool fresh = next || (frame && (frame->over != 0 || wished(link) != own));
    return fresh ? frame : std::nullopt;
  });
}

void set_age(safety::RobotProposal& proposal, std::uint64_t ticks) noexcept {
  for (safety::Proposal& one : proposal.arms.of)
    one.age_ticks = static_cast<std::uint32_t>(std::min<std::uint64_t>(ticks, 1000));
}

void hear_watchers(const Link& link, safety::RobotGuard& guard) noexcept {
  for (const safety::Watcher watcher : {safety::Watcher::operating, safety::Watcher::hand_stop}) {
    if (const auto word = link.watch(watcher))
      guard.hear(watcher, {.beat = word->beat, .stop = word->stop != 0});
  }
}

}  // namespace

Result<GuardReport> keep_guard(Link& link, const Arming& arming, Pace pace,
                               const std::atomic<bool>& ends) {
  const PerArm<robot::ArmModel> models = robot::both_models(arming.arm, arming.mount);
  safety::RobotGuard guard(models, arming.options);
  GuardReport report;
  const auto number = static_cast<std::uint64_t>(getpid());
  const std::uint64_t own = wished(link);
  link.write(wire::DriveFrame{.answers_tick = wire::no_tick, .armed = number, .guard = own});
  std::optional<std::uint64_t> last_tick;
  safety::RobotProposal proposal;
  std::optional<std::uint64_t> answered;
  bool there = true, told_to_stop = false, leaves = false, abandoned = false;
  for (int left_ticks = 0; left_ticks < has_left_ticks;) {
    const auto sensed = next_frame(link, last_tick, own);
    if (!sensed && (last_tick || ends)) break;
    if (!sensed) continue;
    if (sensed->over != 0 || wished(link) != own) break;
    const robot::RobotReading reading = wire::from_frame(*sensed);
    if (!last_tick) {
      if (const char* wrong = try_out(models, arming, reading))
        return fail(Fault::device, "not armed: {}", wrong);
      proposal = still(models, reading);  // until the controller has said its first word
    }
    last_tick = reading.tick;
    const auto patience = pace == Pace::real ? steady_clock::duration(proposal_patience)
                          : there            ? steady_clock::duration(lock_step_patience)
                                             : steady_clock::duration(gone_patience);
    const auto answer = link.wait_for(steady_clock::now() + patience, [&]() {
      const auto frame = link.proposal();
      const bool there_is = frame && (frame->answers_tick == reading.tick || wished(link) != own);
      return there_is ? frame : std::nullopt;
    });
    if (wished(link) != own) break;
    there = answer.has_value();
    if (answer) {
      proposal = wire::from_frame(*answer);
      answered = reading.tick;
      if (answer->stop_asked != 0 && !told_to_stop) guard.expect_stop();
      told_to_stop = answer->stop_asked != 0;
    } else {
      if (++report.silent_ticks % look_every_ticks == 0) abandoned = !link.maker_lives();
    }
    set_age(proposal, answered ? reading.tick - *answered : report.silent_ticks);
    hear_watchers(link, guard);
    if (ends && !leaves) guard.stop(safety::Cause::asked_to);
    leaves = ends;
    const auto before = steady_clock::now();
    const safety::RobotVerdict verdict = guard.check(reading, proposal);
    const std::chrono::duration<double, std::micro> took = steady_clock::now() - before;
    wire::DriveFrame frame = wire::to_frame(verdict, reading.tick);
    frame.armed = number;
    frame.guard = own;
    link.write(frame);
    ++report.ticks;
    report.max_check_us = std::max(report.max_check_us, took.count());
    report.last = verdict.arms;
    left_ticks = (leaves || abandoned) && !guard.pressed() ? left_ticks + 1 : 0;
  }
  return report;
}

}  // namespace tuina::link
