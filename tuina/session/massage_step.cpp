// SPDX-License-Identifier: Apache-2.0
#include "tuina/session/massage_step.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tuina/core/units.hpp"
#include "tuina/motion/free_path.hpp"

namespace tuina::session {
namespace {

constexpr double quiet_s = 2.0;     // no arm sets out sooner after a cough
constexpr double max_leg_s = 15.0;  // of a way through the air; no leg takes a third of it

safety::Phase guarded_phase(ArmPhase phase) noexcept {
  switch (phase) {
    case ArmPhase::approach:
      return safety::Phase::approach;
    case ArmPhase::contact:
      return safety::Phase::contact;
    case ArmPhase::retract:
      return safety::Phase::retract;
    default:
      return safety::Phase::free;
  }
}

}  // namespace

// What a plan may ask for, the guard lets through, and both give way at the same force.
consteval bool rules_agree() {
  for (std::size_t i = 0; i < massage::zone_rules.size(); ++i) {
    const massage::ZoneRule& rule = massage::zone_rules[i];
    const safety::ForceLimits limits =
        safety::ceiling_of(guarded_zone(static_cast<massage::Zone>(i)));
    if (rule.cap_n != limits.set_n || rule.trip_n != limits.trip_n) return false;
  }
  return true;
}
static_assert(rules_agree());

Sentence explain(const Stop& stop) {
  const char *arm = name_of(stop.arm), *cause = safety::name_of(stop.cause);
  if (stop.late_s > 0.0)
    return sentence("stopped_not_done", "the massage was not done after {:.0f} s", stop.late_s);
  if (stop.cause == safety::Cause::asked_to) return sentence("stopped_as_asked", "asked to stop");
  if (stop.joint < 0) return sentence("stopped_arm_by", "{} arm: {}", arm, cause);
  return sentence("stopped_arm_at_joint",
                  "{} arm: {}: joint {} is {:.0f} degrees off, {:.0f} are allowed", arm, cause,
                  stop.joint + 1, to_deg(stop.off_rad), to_deg(parked_within_rad));
}

MassageStep::MassageStep(const massage::Plan& plan, PerArm<std::vector<motion::ArmJob>> jobs,
                         const PerArm<robot::ArmModel>& models, const MassageOptions& options)
    : plan_(plan),
      models_(models),
      options_(options),
      sides_{.of = {Side(models_[Arm::left], options.controller),
                    Side(models_[Arm::right], options.controller)}},
      steering_(plan, {.presses = tissue::pressed_by_robot(options.torso_n_per_m,
                                                           models_[Arm::left].table().tool_mass_kg),
                       .on = options.adaptive,
                       .cautious = options.cautious,
                       .known = options.known}),
      intensity_(std::clamp(options.intensity, min_intensity, max_intensity)) {
  for (Side& side : sides_.of) side.playback.scale(intensity_);
  steering_.scale(intensity_);
  for (const Arm arm : both_arms) sides_[arm].jobs = std::move(jobs[arm]);
  paths_in_base_.reserve(plan_.paths.size());
  for (const massage::PlannedPath& planned : plan_.paths)
    paths_in_base_.push_back(in_base(planned.path, options.base_from_couch));
  tool_radius_m_ = models_[Arm::left].table().tool_radius_m;
  performed_.reserve(4 * plan_.paths.size() + 16);  // some are asked for again
  stops_.reserve(4);
}

const motion::ArmJob* MassageStep::job_of(const Side& side) const noexcept {
  return side.job < side.jobs.size() ? &side.jobs[side.job] : nullptr;
}

const massage::PlannedPath* MassageStep::path_of(const Side& side) const noexcept {
  const motion::ArmJob* job = job_of(side);
  return job != nullptr && job->path >= 0 ? &plan_.paths[static_cast<std::size_t>(job->path)]
                                          : nullptr;
}

const BasePath& MassageStep::base_path_of(const Side& side) const noexcept {
  return paths_in_base_[static_cast<std::size_t>(job_of(side)->path)];
}

safety::RobotProposal MassageStep::propose(const robot::RobotReading& reading) noexcept {
  time_s_ = reading.time_s;
  safety::RobotProposal wanted{.rail_m = options_.rail_m};
  for (const Arm arm : both_arms) {
    Side& side = sides_[arm];
    side.controlled.sense(reading, arm);
    const ArmState& state = side.controlled.state;
    side.q_rad = state.q_rad;
    if (!started_) {
      side.home = control::tip_pose(state.base_from_tool, tool_radius_m_);
      side.home_rad = state.q_rad;
    }
    conduct(arm, reading.time_s);
    wanted.arms[arm] = proposal(side, side.controlled.torque_nm(reading));
  }
  started_ = true;
  return wanted;
}

void MassageStep::heed(const safety::RobotVerdict& verdict) noexcept {
  for (const Arm arm : both_arms) heed(arm, verdict.arms[arm]);
  if (stop_asked_ && stopped_s_ < 0.0) {
    stops_.push_back({time_s_, Arm::left, safety::Cause::asked_to});
    let_go(time_s_);
  }
  if (stopped_s_ >= 0.0) {
    constexpr double letting_go_s = 2.0;
    finished_ = time_s_ - stopped_s_ > letting_go_s;
    return;
  }
  const auto beyond_step = [&](const Side& side) {
    return job_of(side) == nullptr || job_of(side)->step > step_;
  };
  if (beyond_step(sides_[Arm::left]) && beyond_step(sides_[Arm::right])) {
    ++step_;
    shift_in_base_ = next_shift_in_base_;  // never under a tool in contact
  }
  finished_ = job_of(sides_[Arm::left]) == nullptr && job_of(sides_[Arm::right]) == nullptr;
}

void MassageStep::heed(Arm arm, const safety::Verdict& verdict) noexcept {
  Side& side = sides_[arm];
  if (verdict.latched && side.phase != ArmPhase::stopped) {
    side.cut_short = true;
    if (side.phase == ArmPhase::contact) end_contact(side, arm, time_s_);
    side.phase = ArmPhase::stopped;
    if (stops_.size() < stops_.capacity())
      stops_.push_back({.time_s = time_s_, .arm = arm, .cause = verdict.cause});
    let_go(time_s_);
  }
  // While another law moves the arm, the controller must not wind up against it.
  side.frozen = verdict.action == safety::Action::freeze;
  if (side.frozen) side.controller().resume_from_here();
  feel(side, arm, time_s_, side.controlled.state);
  view_[arm] = {
      .phase = side.phase,
      .path = path_of(side) != nullptr ? job_of(side)->path : -1,
      .probing = side.phase == ArmPhase::contact && steering_.probing(arm),
      .foretold = side.phase == ArmPhase::contact && steering_.well_foretold(arm),
      .deepening_m = steering_.deepening_m(arm),
      .target_n = side.phase == ArmPhase::contact ? side.wanted.force_n : 0.0,
      .measured_n = side.controller().status().force_n,
      .tool_in_base =
          control::tip_pose(side.controlled.state.base_from_tool, tool_radius_m_).at_in_base};
}

void MassageStep::obey(LiveCommand command) noexcept {
  constexpr double one_step = 1.15;
  switch (command) {
    case LiveCommand::pause:
    case LiveCommand::resume:
      paused_ = command == LiveCommand::pause;
      for (Side& side : sides_.of) {
        side.playback.pause(paused_);
        if (side.phase != ArmPhase::travel) continue;
        const int leg = side.detour_at;
        if (paused_) {
          side.controller().hold();
        } else {
          side.controller().move_to(leg >= 0 ? side.detour[static_cast<std::size_t>(leg)]
                                             : job_of(side)->waypoints_in_base[side.waypoint]);
          side.leg_s = -1.0;
        }
      }
      return;
    case LiveCommand::stop:
      stop_asked_ = true;
      return;
    case LiveCommand::skip:
    case LiveCommand::repeat:
      for (Side& side : sides_.of) {
        if (path_of(side) == nullptr || side.phase == ArmPhase::waiting) continue;
        side.skip = side.skip || command == LiveCommand::skip;
        side.again = command == LiveCommand::repeat;
      }
      return;
    case LiveCommand::softer:
    case LiveCommand::firmer:
      intensity_ *= command == LiveCommand::firmer ? one_step : 1.0 / one_step;
      intensity_ = std::clamp(intensity_, min_intensity, max_intensity);
      for (Side& side : sides_.of) side.playback.scale(intensity_);
      steering_.scale(intensity_);
      return;
  }
}

void MassageStep::conduct(Arm arm, double time_s) noexcept {
  Side& side = sides_[arm];
  const control::ArmStatus& status = side.controller().status();
  const motion::ArmJob* job = job_of(side);
  if (job == nullptr || side.phase == ArmPhase::stopped) return;
  if (!side.frozen) side.playback.step(control_period_s);

  switch (side.phase) {
    case ArmPhase::waiting:
      if (stopped_s_ >= 0.0 || job->step > step_ || paused_) return;
      if (time_s - startled_s_ < quiet_s) return;
      if (!stands_as_planned(side, arm, time_s)) return;
      side.waypoint = 0;
      side.contact_fault = control::ContactFault::none;
      side.skip = side.again = side.cut_short = false;
      side.controller().keep_posture(job->posture_rad);
      side.controller().move_to(job->waypoints_in_base.front());
      side.leg_s = time_s;
      side.phase = ArmPhase::travel;
      return;
    case ArmPhase::travel:
      if (side.leg_s < 0.0) side.leg_s = time_s;
      if (paused_) return;
      if (above_path(side) && on_its_way(sides_[other(arm)])) return;
      if (status.settled || time_s - side.leg_s > max_leg_s) end_travel(side, arm, time_s);
      return;
    case ArmPhase::approach:
      if (status.contact_fault != control::ContactFault::none || side.skip) {
        side.contact_s = time_s;
        side.contact_fault = status.contact_fault;
        side.cut_short = true;
        end_contact(side, arm, time_s);
        if (side.contact_fault == control::ContactFault::no_skin_found) leave(time_s);
      } else if (status.mode == control::Mode::contact) {
        begin_contact(side, arm, time_s);
      }
      return;
    case ArmPhase::contact:
      press_on(side, arm, time_s);
      return;
    case ArmPhase::retract:
      if (status.contact_fault == control::ContactFault::pushed_away) startled_s_ = time_s;
      if (status.settled) end_retract(side, time_s);
      return;
    case ArmPhase::stopped:
      return;
  }
}

void MassageStep::let_go(double time_s) noexcept {
  if (stopped_s_ < 0.0) stopped_s_ = time_s;
  for (const Arm arm : both_arms) {
    Side& side = sides_[arm];
    if (side.phase == ArmPhase::contact || side.phase == ArmPhase::approach) {
      if (side.phase == ArmPhase::approach) side.contact_s = time_s;
      side.cut_short = true;
      end_contact(side, arm, time_s);
    } else if (side.phase == ArmPhase::travel) {
      side.controller().halt();
      side.phase = ArmPhase::waiting;
    }
  }
}

safety::Proposal MassageStep::proposal(const Side& side,
                                       const JointVector& torque_nm) const noexcept {
  const control::ArmStatus& status = side.controller().status();
  const massage::PlannedPath* planned = path_of(side);
  const bool near_skin = side.phase == ArmPhase::approach || side.phase == ArmPhase::contact ||
                         side.phase == ArmPhase::retract;
  return {
      .torque_nm = torque_nm,
      .phase = guarded_phase(side.phase),
      .zone = near_skin && planned != nullptr ? guarded_zone(planned->zone) : safety::Zone::denied,
      .set_force_n = side.phase == ArmPhase::contact ? side.commanded_n : 0.0,
      .normal_in_base = status.normal_in_base,
      .virtual_target_in_base = status.virtual_target_in_base,
      .stiffness_n_per_m = status.stiffness_n_per_m};
}

}  // namespace tuina::session
