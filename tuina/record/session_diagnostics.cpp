// SPDX-License-Identifier: Apache-2.0
#include "tuina/record/session_diagnostics.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "tuina/record/event_fields.hpp"
#include "tuina/record/session_messages.hpp"

namespace tuina::record {
namespace {

using safety::Cause;
using Status = ros::DiagnosticStatus;

constexpr double told_every_s = 1.0;
// What is felt in the air is a mean of a second, and known from the second one on.
constexpr std::uint64_t felt_every_ticks = 20;
constexpr int mean_samples = 50, known_samples = 100;
// Sensors drift by half as much a minute. The rest is a tool whose weight is believed wrong and
// turns, and its inertia: 1.4 N in a sound session of `phantom:slim`.
constexpr double max_drift_n = 2.0, max_drift_n_per_s = 1.0 / 60.0;

/// Parts, in the order of the message; of an arm the left one comes first.
enum Part : std::size_t {
  scanner_part,
  guard_part,
  arm_part = 3,
  wrist_part = 5,
  tissue_part = 7,
  steering_part,
  session_part,
  parts
};
std::size_t of(Part part, Arm arm) {
  return part + static_cast<std::size_t>(arm);
}

/// The part of an arm that a guard's cause names; the guard's own where it names none.
Part blamed(Cause cause) {
  switch (cause) {
    case Cause::force_spike:
    case Cause::force_spikes:
    case Cause::force_stale:
    case Cause::force_stuck:
    case Cause::force_off_zero:
    case Cause::force_reversed:
      return wrist_part;
    case Cause::encoder_jump:
    case Cause::state_not_finite:
    case Cause::torque_saturated:
    case Cause::not_obeyed:
    case Cause::torques_amiss:
    case Cause::drive_amiss:
    case Cause::clock:
    case Cause::late_tick:
    case Cause::rail_moved:
      return arm_part;
    default:
      return guard_part;
  }
}

// What is latched ends the session. A guard that takes the arm over is done with that by itself. To
// clamp a torque is its daily work, thousands of times in a session without any fault.
std::byte level_of(const safety::Verdict& verdict) {
  if (verdict.latched) return Status::error;
  return verdict.action > safety::Action::warn ? Status::warn : Status::ok;
}

bool is_worse(const safety::Verdict& a, const safety::Verdict& b) {
  return a.latched != b.latched ? a.latched : a.action > b.action;
}

}  // namespace

SessionDiagnostics::SessionDiagnostics(const std::string& robot_name) {
  // The names begin with that of the program, as monitors group them.
  for (const char* name :
       {"scanner", "left guard", "right guard", "left arm", "right arm", "left wrist sensor",
        "right wrist sensor", "tissue", "steering", "session"}) {
    told_.status.push_back({.name = fmt::format("tuina: {}", name), .hardware_id = robot_name});
  }
  told_.status[scanner_part].hardware_id = "scanner";
  told_.status[tissue_part].message = "nothing felt yet";
  told_.status[steering_part].message = "nothing decided yet";
}

void SessionDiagnostics::note_scan(const scanner::Scan& scan) {
  Status& status = told_.status[scanner_part];
  status.message = "the back is scanned";
  status.values = {{"profiles", fmt::format("{}", scan.profiles)},
                   {"points", fmt::format("{}", scan.cloud_in_couch.size())},
                   {"rows_lit", fmt::format("{}", scan.rows_lit)},
                   {"expected_error_mm", fmt::format("{:.2f}", to_mm(scan.expected_error_m))}};
  news_ = true;
}

void SessionDiagnostics::note_place(const robot::RobotPlacement& placement) {
  tool_mass_kg_ = placement.arm.tool_mass_kg;
  models_ =
      std::make_unique<PerArm<robot::ArmModel>>(robot::both_models(placement.arm, placement.mount));
}

void SessionDiagnostics::note_tissue(const TissueEvent& felt) {
  Status& status = told_.status[tissue_part];
  status.message = felt.path;
  status.values = {{"path", felt.path},
                   {"alpha_n", fmt::format("{:.2f}", felt.felt.tissue.alpha_n)},
                   {"beta_per_mm", fmt::format("{:.4f}", 1e-3 * felt.felt.tissue.beta_per_m)},
                   {"alpha_ci95_n", fmt::format("{:.2f}", felt.felt.alpha_ci95_n)},
                   {"beta_ci95_per_mm", fmt::format("{:.4f}", 1e-3 * felt.felt.beta_ci95_per_m)},
                   {"presses", fmt::format("{}", felt.felt.presses)},
                   {"converged", fmt::format("{}", felt.felt.converged)}};
  news_ = true;
}

void SessionDiagnostics::note_decision(const DecisionEvent& made) {
  Status& status = told_.status[steering_part];
  status.message = made.reason;
  status.values = {{"time_s", fmt::format("{:.3f}", made.time_s)},
                   {"arm", name_of(made.arm)},
                   {"path", made.path},
                   {"rule", made.rule},
                   {"from_n", fmt::format("{:.1f}", made.from_n)},
                   {"to_n", fmt::format("{:.1f}", made.to_n)}};
  news_ = true;
}

void SessionDiagnostics::feel(const session::Tick& tick, Arm arm) {
  Side& side = sides_[arm];
  const robot::ArmReading& reading = tick.reading.arms[arm];
  if (is_worse(tick.verdict.arms[arm], side.worst)) side.worst = tick.verdict.arms[arm];
  side.clamped_ms += tick.verdict.arms[arm].action == safety::Action::warn ? 1 : 0;
  side.age_s = std::max(side.age_s, tick.reading.time_s - reading.wrench_time_s);
  const session::ArmPhase phase = tick.view[arm].phase;
  const bool in_air = phase == session::ArmPhase::waiting || phase == session::ArmPhase::travel;
  if (!in_air || ticks_ % felt_every_ticks != 0) return;
  const Vector3 weight_in_base_n(0.0, 0.0, -tool_mass_kg_ * gravity_m_per_s2);
  const Matrix3 base_from_tool =
      (*models_)[arm].base_from_tool(reading.q_rad, tick.reading.rail_m).linear();
  const Vector3 felt_n =
      reading.wrench_in_tool.force_n - base_from_tool.transpose() * weight_in_base_n;
  side.air_samples = std::min(side.air_samples + 1, known_samples);
  side.air_n += (felt_n - side.air_n) / std::min(side.air_samples, mean_samples);
  if (side.air_samples == known_samples && !side.first_air_n) side.first_air_n = side.air_n;
}

bool SessionDiagnostics::got_worse(Arm arm) const {
  return level_of(sides_[arm].worst) > told_.status[of(guard_part, arm)].level;
}

void SessionDiagnostics::tell_arm(const session::Tick& tick, Arm arm) {
  Side& side = sides_[arm];
  Status &guard = told_.status[of(guard_part, arm)], &drives = told_.status[of(arm_part, arm)],
         &wrist = told_.status[of(wrist_part, arm)];
  guard.level = level_of(side.worst);
  guard.message = guard.level == Status::ok ? "lets pass what is asked for"
                                            : fmt::format("{}: {}", name_of(side.worst.action),
                                                          name_of(side.worst.cause));
  guard.values = {{"action", name_of(side.worst.action)},
                  {"cause", name_of(side.worst.cause)},
                  {"latched", fmt::format("{}", side.worst.latched)},
                  {"clamped_ms", fmt::format("{}", side.clamped_ms)}};

  const robot::ArmReading& reading = tick.reading.arms[arm];
  const Part part = guard.level == Status::ok ? guard_part : blamed(side.worst.cause);
  drives.level = part == arm_part ? guard.level : Status::ok;
  drives.message = drives.level == Status::ok ? "obeys" : name_of(side.worst.cause);
  drives.values = {{"command_age_ms", fmt::format("{}", reading.command_age)},
                   {"phase", name_of(tick.view[arm].phase)}};

  const double drift_n = side.first_air_n ? (side.air_n - *side.first_air_n).norm() : 0.0;
  const bool drifts = drift_n > max_drift_n + max_drift_n_per_s * tick.reading.time_s;
  wrist.level = part == wrist_part ? guard.level : drifts ? Status::warn : Status::ok;
  wrist.message = part == wrist_part ? name_of(side.worst.cause)
                  : drifts           ? "drifts more than such sensors do"
                                     : "feels";
  wrist.values = {{"in_the_air_n", fmt::format("{:.2f}", side.air_n.norm())},
                  {"drift_n", side.first_air_n ? fmt::format("{:.2f}", drift_n) : "unknown"},
                  {"oldest_sample_ms", fmt::format("{:.0f}", 1e3 * side.age_s)}};
  side.worst = tick.verdict.arms[arm];
  side.age_s = 0.0;
  side.clamped_ms = 0;
}

void SessionDiagnostics::tell_session(const session::Tick& tick, std::uint64_t missing_ms) {
  Status& status = told_.status[session_part];
  const bool misses = missing_ms > missing_ms_;
  status.level = stops_ > 0 ? Status::error : misses ? Status::warn : Status::ok;
  status.message = stops_ > 0 ? "stopped: " + stopped_by_
                   : misses   ? "milliseconds are missing"
                              : "runs";
  status.values = {{"performed", fmt::format("{}", tick.performed)},
                   {"stops", fmt::format("{}", stops_)},
                   {"missing_ms", fmt::format("{}", missing_ms)}};
  missing_ms_ = missing_ms;
}

const ros::DiagnosticArray* SessionDiagnostics::look(const session::Tick& tick,
                                                     std::uint64_t missing_ms) {
  for (const Arm arm : both_arms) feel(tick, arm);
  ++ticks_;
  if (tick.stopped) {
    ++stops_;
    stopped_by_ = session::explain(*tick.stopped).words;
    news_ = true;
  }
  const double time_s = tick.reading.time_s;
  const bool due =
      news_ || got_worse(Arm::left) || got_worse(Arm::right) || time_s >= told_s_ + told_every_s;
  if (!due) return nullptr;
  told_.header = header_of(time_s, "");
  for (const Arm arm : both_arms) tell_arm(tick, arm);
  tell_session(tick, missing_ms);
  told_s_ = time_s;
  news_ = false;
  return &told_;
}

}  // namespace tuina::record
