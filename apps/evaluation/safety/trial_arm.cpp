// SPDX-License-Identifier: Apache-2.0
#include "apps/evaluation/safety/trial_arm.hpp"

#include <Eigen/Dense>
#include <cmath>
#include <limits>

#include "tuina/core/units.hpp"

namespace tuina::app {
namespace {

// Friction is believed as the table says: learning it would take longer than the trial.
constexpr control::ArmController::Options without_learning = {.learn_s = 0.0};

safety::Phase phase_of(Stage stage) {
  switch (stage) {
    case Stage::approach:
      return safety::Phase::approach;
    case Stage::contact:
      return safety::Phase::contact;
    case Stage::retract:
      return safety::Phase::retract;
    default:
      return safety::Phase::free;
  }
}

}  // namespace

TrialArm::TrialArm(const Site& site)
    : site_(site),
      models_(robot::both_models(robot::thesis_arm(), site.mount)),
      guarded_{.of = {session::GuardedArm(models_[Arm::left], without_learning),
                      session::GuardedArm(models_[Arm::right], without_learning)}} {}

void TrialArm::sense(const robot::RobotReading& reading) noexcept {
  for (const Arm arm : both_arms) guarded_[arm].sense(reading, arm);
}

void TrialArm::go_mad(Madness madness, double size_n, double hz) noexcept {
  madness_ = madness;
  size_n_ = size_n;
  hz_ = hz;
}

robot::RobotCommand TrialArm::command(const robot::RobotReading& reading, Stage stage, double set_n,
                                      double rail_m) noexcept {
  robot::RobotCommand command{.torque_nm = {}, .rail_m = rail_m};
  const Arm other = site_.arm == Arm::left ? Arm::right : Arm::left;
  command.torque_nm[other] = guarded_[other].step_on_bench(reading, other);

  session::GuardedArm& guarded = guarded_[site_.arm];
  const JointVector torque_nm = guarded.torque_nm(reading);
  safety::Proposal wanted = proposal(stage, set_n, torque_nm);
  if (madness_ == Madness::none) last_ = wanted;
  spoil(wanted);
  const robot::ArmDynamics& dynamics = guarded.controller.dynamics();
  command.torque_nm[site_.arm] = guarded.allow(reading, site_.arm, dynamics, wanted);
  // As a session does it: an arm whose guard has stopped it lets go, and is not driven again.
  if (guarded.verdict.latched && !stopped_) {
    if (stage == Stage::contact) controller().retract(40_mm);
    stopped_ = true;
  }
  const auto J = dynamics.jacobian.topRows<3>();
  const Matrix3 square = J * J.transpose();
  const JointVector push_nm = command.torque_nm[site_.arm] - dynamics.gravity_nm;
  const Vector3 push_n = square.ldlt().solve(J * push_nm);
  inward_n_ = -push_n.dot(site_.mount.base_from_couch.linear() * site_.normal_in_couch);
  return command;
}

safety::Proposal TrialArm::proposal(Stage stage, double set_n,
                                    const JointVector& torque_nm) const noexcept {
  const control::ArmStatus& status = guarded_[site_.arm].controller.status();
  const bool near_skin = stage >= Stage::approach && !stopped_;
  return {.torque_nm = torque_nm,
          .phase = stopped_ ? safety::Phase::free : phase_of(stage),
          .zone = near_skin ? site_.zone : safety::Zone::denied,
          .set_force_n = stopped_ ? 0.0 : set_n,
          .normal_in_base = status.normal_in_base,
          .virtual_target_in_base = status.virtual_target_in_base,
          .stiffness_n_per_m = status.stiffness_n_per_m};
}

void TrialArm::spoil(safety::Proposal& proposal) noexcept {
  if (madness_ == Madness::none) return;
  mad_s_ += control_period_s;
  const auto& dynamics = guarded_[site_.arm].controller.dynamics();
  const Vector3 inward_in_base = -(site_.mount.base_from_couch.linear() * site_.normal_in_couch);
  const JointVector inward = dynamics.jacobian.topRows<3>().transpose() * inward_in_base;
  switch (madness_) {
    case Madness::nan_torque:
      proposal.torque_nm[0] = std::numeric_limits<double>::quiet_NaN();
      return;
    case Madness::huge_torque:
      proposal.torque_nm =
          models_[site_.arm].table().torque_limits_nm().cwiseProduct(inward.cwiseSign());
      return;
    case Madness::inward_push:
      proposal.torque_nm += size_n_ * inward;
      return;
    case Madness::oscillation:
      proposal.torque_nm += size_n_ * std::sin(2.0 * pi * hz_ * mad_s_) * inward;
      return;
    case Madness::stale_repeat:
      proposal = last_;
      return;
    case Madness::killed:
      proposal = last_;
      proposal.torque_nm = JointVector();
      return;
    case Madness::none:
    case Madness::bad_tissue:
      return;
  }
}

}  // namespace tuina::app
