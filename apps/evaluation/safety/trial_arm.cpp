// SPDX-License-Identifier: Apache-2.0
#include "apps/evaluation/safety/trial_arm.hpp"

#include <Eigen/Dense>
#include <cmath>
#include <limits>

#include "apps/simulated/session_order.hpp"
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
      models_(robot::both_models(believed_gears(robot::thesis_arm(), site.world.devices.flaws),
                                 site.mount)),
      controlled_{.of = {session::ControlledArm(models_[Arm::left], without_learning),
                         session::ControlledArm(models_[Arm::right], without_learning)}},
      guard_(models_, {.obstacles = site.mount.obstacles, .field = site.field}) {}

void TrialArm::sense(const robot::RobotReading& reading) noexcept {
  for (const Arm arm : both_arms) controlled_[arm].sense(reading, arm);
}

void TrialArm::go_mad(Madness madness, double size, double hz, int joint) noexcept {
  madness_ = madness;
  size_ = size;
  hz_ = hz;
  joint_ = joint;
}

safety::RobotProposal TrialArm::propose(const robot::RobotReading& reading, Stage stage,
                                        double set_n) noexcept {
  safety::RobotProposal wanted{.rail_m = site_.rail_m};
  const Arm other = tuina::other(site_.arm);
  wanted.arms[other] = controlled_[other].propose(reading, safety::Zone::denied);
  wanted.arms[site_.arm] = proposal(stage, set_n, controlled_[site_.arm].torque_nm(reading));
  if (madness_ == Madness::none) last_ = wanted.arms[site_.arm];
  spoil(wanted.arms[site_.arm]);
  return wanted;
}

// As a session does it: an arm whose guard has stopped it lets go, and is not driven again; one
// that was frozen begins anew from where it is.
void TrialArm::heed(const safety::RobotVerdict& verdict, Stage stage) noexcept {
  verdicts_ = verdict.arms;
  if (verdicts_[site_.arm].latched && !stopped_) {
    if (stage == Stage::contact) controller().retract(40_mm);
    stopped_ = true;
  }
  if (frozen()) controller().resume_from_here();
  const robot::ArmDynamics& dynamics = controller().dynamics();
  const auto J = dynamics.jacobian.topRows<3>();
  const Matrix3 square = J * J.transpose();
  const JointVector push_nm = verdict.command.torque_nm[site_.arm] - dynamics.gravity_nm;
  const Vector3 push_n = square.ldlt().solve(J * push_nm);
  inward_n_ = -push_n.dot(site_.mount.base_from_couch.linear() * site_.normal_in_couch);
}

safety::Proposal TrialArm::proposal(Stage stage, double set_n,
                                    const JointVector& torque_nm) const noexcept {
  const control::ArmStatus& status = controlled_[site_.arm].controller.status();
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
  const auto& dynamics = controlled_[site_.arm].controller.dynamics();
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
      proposal.torque_nm += size_ * inward;
      return;
    case Madness::oscillation:
      proposal.torque_nm += size_ * std::sin(2.0 * pi * hz_ * mad_s_) * inward;
      return;
    case Madness::joint_push:
      proposal.torque_nm[joint_] += size_;
      return;
    case Madness::stale_repeat:
      proposal = last_;
      return;
    case Madness::killed:
      proposal = last_;
      proposal.age_ticks = static_cast<std::uint32_t>(std::lround(mad_s_ / control_period_s));
      return;
    case Madness::none:
    case Madness::bad_tissue:
      return;
  }
}

}  // namespace tuina::app
