// SPDX-License-Identifier: Apache-2.0
#include "tuina/safety/robot_guard.hpp"

#include <algorithm>
#include <cmath>

#include "tuina/robot/joint_ends.hpp"

namespace tuina::safety {
namespace {

// A person may have shifted by 10 mm since the scan before a new one is asked for; the rest is the
// error of the guard's cells.
constexpr double reach_m = 15e-3;

constexpr double rail_step_m = 1e-3;   // of a command; a base that stands is told the same for ever
constexpr double rail_moved_m = 5e-3;  // of the base itself, by whatever moves it
constexpr double still_m_per_s = 5e-3;

// A controller that was asked to stop lets go within a quarter of a second.
constexpr int max_patience_ticks = 300;
constexpr double let_go_n = 2.0;

constexpr int max_lease_ticks = 500;

Guard::Options guard_options(const robot::ArmModel& model, const RobotGuard::Options& options) {
  const robot::JointEnds ends = robot::joint_ends(model);
  Guard::Options guard{.torque_limit_nm = model.table().torque_limits_nm(),
                       .min_rad = ends.min_rad,
                       .max_rad = ends.max_rad,
                       .bench = options.bench};
  for (ForceLimits& limits : guard.force)
    limits.set_n = std::min(limits.set_n, options.max_set_force_n);
  return guard;
}

}  // namespace

RobotGuard::Side::Side(const robot::ArmModel& model, const Options& options) noexcept
    : watch(model), guard(guard_options(model, options)) {}

void RobotGuard::Side::note_sent(const JointVector& torque_nm) noexcept {
  newest = (newest + 1) % sent_nm.size();
  sent_nm[newest] = torque_nm;
}

JointVector RobotGuard::Side::sent_ago(int commands) const noexcept {
  const int oldest = static_cast<int>(sent_nm.size()) - 1;
  const int back = commands < 0 ? oldest : std::min(commands, oldest);
  return sent_nm[(newest - static_cast<std::size_t>(back)) % sent_nm.size()];
}

RobotGuard::RobotGuard(const PerArm<robot::ArmModel>& models, const Options& options)
    : field_(options.field.reaching(reach_m)),
      separation_(models, options.obstacles),
      sides_{.of = {Side(models[Arm::left], options), Side(models[Arm::right], options)}},
      leased_(options.leased) {}

void RobotGuard::hear(Watcher watcher, const Heartbeat& word) noexcept {
  const auto i = static_cast<std::size_t>(watcher);
  if (word.stop) stop(Cause::asked_to);
  if (word.beat != beats_[i]) silent_ticks_[i] = 0;
  beats_[i] = word.beat;
}

void RobotGuard::stop(Cause cause) noexcept {
  for (Side& side : sides_.of) side.guard.stop(Action::retract, cause);
}

void RobotGuard::expect_stop() noexcept {
  if (patience_ticks_ < 0) patience_ticks_ = max_patience_ticks;
}

// Only arms that move are stopped; the other one cannot have come nearer. On the skin an arm leaves
// it, in the air it stands still.
bool RobotGuard::pressed() const noexcept {
  return sides_[Arm::left].guard.pressed() || sides_[Arm::right].guard.pressed();
}

void RobotGuard::keep_apart(const PerArm<Observation>& seen,
                            const RobotProposal& proposal) noexcept {
  const auto known = [&](Arm arm) {
    return seen[arm].tool_in_base.allFinite() && seen[arm].mass_kg_m2.size() > 0;
  };
  const Cause cause = !known(Arm::left) || !known(Arm::right) ? Cause::state_not_finite
                      : separation_.arms_keep()               ? Cause::surroundings_too_close
                                                              : Cause::arms_too_close;
  const auto moves = [&](Arm arm) {
    return proposal.arms[arm].phase != Phase::free ||
           !(seen[arm].tool_velocity_m_per_s.norm() < still_m_per_s);
  };
  const bool nobody = !moves(Arm::left) && !moves(Arm::right);
  for (const Arm arm : both_arms) {
    if (!nobody && !moves(arm)) continue;
    const Phase phase = proposal.arms[arm].phase;
    Guard& guard = sides_[arm].guard;
    // A tool that was told to leave may press still, whatever its controller calls that.
    const bool on_skin = phase == Phase::contact || phase == Phase::approach || guard.pressed();
    guard.stop(on_skin ? Action::retract : Action::freeze, cause);
  }
}

RobotVerdict RobotGuard::check(const robot::RobotReading& reading,
                               const RobotProposal& proposal) noexcept {
  if (!started_) rail_m_ = std::isfinite(reading.rail_m) ? reading.rail_m : proposal.rail_m;
  started_ = true;
  if (!(std::abs(reading.rail_m - rail_m_) <= rail_moved_m)) stop(Cause::rail_moved);
  for (int& silent_ticks : silent_ticks_)
    if (leased_ && ++silent_ticks > max_lease_ticks) stop(Cause::lease_over);
  PerArm<Observation> seen;
  for (const Arm arm : both_arms) {
    Side& side = sides_[arm];
    seen[arm] = side.watch.observe(reading, arm, proposal.arms[arm],
                                   side.sent_ago(reading.arms[arm].command_age));
    if (!field_.empty()) seen[arm].skin = field_.at(seen[arm].tip_in_base);
  }
  if (!separation_.keeps(reading)) keep_apart(seen, proposal);
  if (patience_ticks_ > 0) --patience_ticks_;
  RobotVerdict verdict;
  const bool stands = std::abs(proposal.rail_m - rail_m_) <= rail_step_m;
  verdict.command.rail_m = stands ? proposal.rail_m : rail_m_;
  for (const Arm arm : both_arms) {
    Side& side = sides_[arm];
    if (patience_ticks_ == 0 && side.guard.felt_n() > let_go_n)
      side.guard.stop(Action::retract, Cause::asked_to);
    Proposal told = proposal.arms[arm];
    if (!field_.empty() && seen[arm].skin == nullptr) told.zone = Zone::denied;
    verdict.arms[arm] = side.guard.check(seen[arm], told);
    verdict.command.torque_nm[arm] = verdict.arms[arm].allowed_nm;
    side.note_sent(verdict.command.torque_nm[arm]);
    verdict.command.brake[arm] = verdict.arms[arm].action == Action::brake;
  }
  return verdict;
}

}  // namespace tuina::safety
