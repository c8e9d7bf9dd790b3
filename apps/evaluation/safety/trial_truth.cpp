// SPDX-License-Identifier: Apache-2.0
#include "apps/evaluation/safety/trial_truth.hpp"

#include <algorithm>
#include <cmath>

#include "tuina/robot/clearance.hpp"

namespace tuina::app {
namespace {

constexpr double resting_n = 5.0;  // less is a tool that lies on the skin
constexpr double met_n = 2.0;      // more than that of breath
constexpr int looked_around_every = 5;

}  // namespace

std::optional<robot::RobotReading> TrialTruth::read() noexcept {
  auto reading = plant_.read();
  // Half a millisecond, since times are sums.
  if (begun() && time_s() > onset_s_ - 0.5 * control_period_s) look();
  return reading;
}

void TrialTruth::begin(double set_n) noexcept {
  acts_from_s_ = onset_s_ = time_s() + control_period_s;
  unfelt_ = plan_.stage != Stage::contact && plan_.onsets.front().fault->injection.person;
  min_force_n_ = arm().contact.force_n;
  outcome_.tried = true;
  outcome_.set_force_n = set_n;
  from_in_couch_ = arm().couch_from_tool.translation();
}

bool TrialTruth::guard_killed() const noexcept {
  return begun() && std::any_of(plan_.onsets.begin(), plan_.onsets.end(), [&](const Onset& onset) {
           const auto& robot = onset.fault->injection.robot;
           return robot && robot->kind == sim::RobotFault::commands_lost &&
                  time_s() > onset_s_ + onset.later_s - 0.5 * control_period_s;
         });
}

void TrialTruth::look() {
  const sim::ArmTruth& truth = arm();
  const double since_s = time_s() - onset_s_, force_n = truth.contact.force_n;
  outcome_.worst_force_n = std::max(outcome_.worst_force_n, force_n);
  min_force_n_ = std::min(min_force_n_, force_n);
  unfelt_ = unfelt_ && force_n < min_force_n_ + met_n;
  if (unfelt_) acts_from_s_ = time_s();
  if (force_n > seldom_n) outcome_.over_seldom_s += control_period_s;
  if (force_n > 0.0) outcome_.released_ms = 1e3 * since_s;
  squares_ += (force_n - set_n_) * (force_n - set_n_);
  if (samples_++ % looked_around_every == 0) look_around();
  const Vector3 at_in_couch = truth.couch_from_tool.translation();
  if (!lost_skin_ && force_n == 0.0) {
    lost_skin_ = true;
    from_in_couch_ = at_in_couch;
    outcome_.further_m = 0.0;
  }
  outcome_.further_m =
      std::max(outcome_.further_m, (from_in_couch_ - at_in_couch).dot(plan_.site->normal_in_couch));
  const bool braked = truth.drive == sim::Drive::braked;
  if (braked || truth.drive == sim::Drive::damped) note_action();
  if (braked) note_stop("braked by the drives", true);
  if (plan_.traced) outcome_.trace.push_back({since_s, set_n_, force_n});
}

void TrialTruth::look_around() {
  const sim::PlantTruth& truth = plant_.truth();
  PerArm<robot::ArmModel::Kinematics> poses;
  for (const Arm one : both_arms) {
    poses[one] = models_[one].kinematics(truth.arms[one].q_rad, truth.rail_m);
    const auto clear =
        robot::clearances(models_[one], poses[one], truth.rail_m, plan_.site->mount.obstacles);
    outcome_.apart_m = std::min(outcome_.apart_m, clear.min_m());
  }
  const double arms_m = robot::distance_between_m(models_[Arm::left], poses[Arm::left],
                                                  models_[Arm::right], poses[Arm::right]);
  outcome_.apart_m = std::min(outcome_.apart_m, arms_m);
}

void TrialTruth::note_action() noexcept {
  if (begun() && std::isnan(outcome_.first_action_ms))
    outcome_.first_action_ms = 1e3 * std::max(0.0, time_s() - acts_from_s_);
}

void TrialTruth::note_stop(const std::string& cause, bool by_guard) {
  if (!outcome_.stopped) outcome_.cause = cause;
  outcome_.stopped = true;
  outcome_.by_guard = outcome_.by_guard || by_guard;
}

TrialOutcome TrialTruth::finish() {
  outcome_.end_force_n = arm().contact.force_n;
  outcome_.end_m_per_s = arm().velocity_in_couch.norm();
  if (samples_ > 0) outcome_.rmse_n = std::sqrt(squares_ / samples_);
  if (plant_.fault() != nullptr) {
    outcome_.end = "beyond all bounds";
  } else if (outcome_.stopped) {
    outcome_.end = outcome_.end_force_n > resting_n ? "pressing"
                   : outcome_.end_force_n > 0.0     ? "resting on the skin"
                                                    : "away";
    if (arm().drive == sim::Drive::braked) outcome_.end += ", braked";
  }
  return std::move(outcome_);
}

}  // namespace tuina::app
