// SPDX-License-Identifier: Apache-2.0
#include "tuina/control/arm_controller.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tuina::control {
namespace {

// Filters and integrals never forget what is no number.
bool usable(const ArmState& state) noexcept {
  return state.q_rad.allFinite() && state.dq_rad_per_s.allFinite() &&
         state.base_from_tool.matrix().allFinite() && state.contact_in_base.force_n.allFinite() &&
         state.contact_in_base.torque_nm.allFinite();
}

}  // namespace

const char* name_of(Mode mode) noexcept {
  constexpr std::array names = {"hold", "move", "approach", "contact", "retract", "lead"};
  return names[static_cast<std::size_t>(mode)];
}

const char* name_of(ContactFault contact_fault) noexcept {
  constexpr std::array names = {"none",        "no skin found", "contact lost",
                                "pushed away", "blocked",       "bad command"};
  return names[static_cast<std::size_t>(contact_fault)];
}

ArmController::ArmController(const robot::ArmModel& model, const Options& options) noexcept
    : model_(&model),
      options_(options),
      sense_(model),
      friction_(model.table(), options.friction),
      torque_nm_(JointVector::Zero(model.table().joints)) {
  if (options_.law != ControlLaw::tuina) {
    options_.force.trim_per_s = 0.0;
    options_.force.gain_share = 0.0;
    options_.force.finds_skin = false;
    options_.force.escape.startle_n = std::numeric_limits<double>::infinity();
  }
  given_ = options_;
  force_target_ = ForceTarget(options_.force);
  escape_ = Escape(options_.force.escape);
}

// The gain of a damper on a mass is bounded by 1 / delay, and what encoders, filters and a cycle
// take is in `given_`. So gains fall with the ticks beyond one. The law of the force along the
// normal bears more delay than the springs around it and stays as it is.
void ArmController::soften(int command_age) noexcept {
  constexpr double own_ticks = 1.0, max_late_ticks = 15.0, forgotten_per_tick = 1e-3;
  late_ticks_ = std::min(
      std::max(static_cast<double>(command_age), late_ticks_ - forgotten_per_tick), max_late_ticks);
  const double share = own_ticks / (own_ticks + std::max(late_ticks_ - 1.0, 0.0));
  if (share == gain_share_) return;
  gain_share_ = share;
  options_.stiffness_n_per_m = share * given_.stiffness_n_per_m;
  options_.damping_ratio = std::sqrt(share) * given_.damping_ratio;
  options_.turning.damping_ratio = share * given_.turning.damping_ratio;
  options_.turning.stiffness_nm_per_rad = share * given_.turning.stiffness_nm_per_rad;
  options_.posture.damping_nm_s_per_rad = share * given_.posture.damping_nm_s_per_rad;
  options_.lead_damping_nm_s_per_rad = share * given_.lead_damping_nm_s_per_rad;
}

void ArmController::start(const ArmState& state) noexcept {
  if (!usable(state)) {
    status_.contact_fault = ContactFault::bad_command;
    return;
  }
  centre_ = state.base_from_tool.translation();
  velocity_.setZero();
  spring_n_.setZero();
  settling_n_.setZero();
  friction_.start(state.q_rad);
  follower_.start(state.q_rad);
  posture_rad_ = here_rad_ = state.q_rad;
  motion_.start({centre_, tool_normal(state.base_from_tool)});
  motion_s_ = 0.0;
  reference_ = motion_.at(0.0);
  status_ = {};
  move_after_learning_.reset();
  learning_s_ = -1.0;
  if (options_.learn_s > 0.0) {
    learning_s_ = 0.0;
    learn_rad_ = state.q_rad;
    learn_nm_ = JointVector();
    friction_.begin_learning();
    status_.settled = false;
  }
}

JointVector ArmController::step(const ArmState& state, double rail_m, double dt_s) noexcept {
  if (usable(state) && std::isfinite(rail_m) && std::isfinite(dt_s) && dt_s > 0.0) {
    rail_m_ = rail_m;
    torque_nm_ = next_torque(state, dt_s);
  }
  return torque_nm_;
}

void ArmController::stop_learning() noexcept {
  if (learning_s_ < 0.0) return;
  learning_s_ = -1.0;
  friction_.end_learning();
  motion_.start({centre_, reference_.pose.normal_in_base});
  motion_s_ = 0.0;
}

void ArmController::keep_posture(const JointVector& q_rad) noexcept {
  if (q_rad.size() == posture_rad_.size() && q_rad.allFinite()) posture_rad_ = q_rad;
}

void ArmController::give_up(ContactFault contact_fault) noexcept {
  hold();
  status_.contact_fault = contact_fault;
}

// A free motion starts where its springs would pull like the present ones, so that the torque does
// not step.
void ArmController::travel(const Vector3& centre, const Vector3& normal,
                           const ToolMotion::Limits& limits, Mode mode) noexcept {
  stop_learning();
  if (status_.mode == Mode::contact || status_.mode == Mode::approach) {
    motion_.start(
        {centre_ + clamp_norm(spring_n_, options_.max_pull_n) / options_.stiffness_n_per_m,
         reference_.pose.normal_in_base});
    motion_s_ = 0.0;
  }
  if (status_.mode == Mode::lead) {
    motion_.start({centre_, tool_normal(dynamics_.base_from_tool)});
    motion_s_ = 0.0;
  }
  status_.contact_fault = ContactFault::none;
  if (motion_.plan(motion_s_, {centre, normal}, limits)) {
    motion_s_ = 0.0;
    status_.mode = mode;
  } else {
    status_.mode = Mode::hold;
    status_.contact_fault = ContactFault::bad_command;
  }
  status_.settled = false;
  blocked_s_ = quiet_s_ = 0.0;
}

void ArmController::hold() noexcept {
  const bool led = status_.mode == Mode::lead;
  travel(centre_, led ? tool_normal(dynamics_.base_from_tool) : reference_.pose.normal_in_base,
         options_.motion, Mode::hold);
}

// Holds the measured position: a reference that runs ahead would pull the arm on for a tenth of a
// second. The nullspace stops too.
void ArmController::halt() noexcept {
  posture_rad_ = here_rad_;
  motion_.start({centre_, tool_normal(dynamics_.base_from_tool)});
  motion_s_ = 0.0;
  travel(centre_, motion_.goal().normal_in_base, options_.motion, Mode::hold);
}

void ArmController::move_to(const ToolPose& tip) noexcept {
  if (learning_s_ >= 0.0) {
    move_after_learning_ = tip;
    status_.mode = Mode::move;
    status_.settled = false;
    return;
  }
  const Vector3 normal = tip.normal_in_base.normalized();
  const ToolPose centre = centre_pose({tip.at_in_base, normal}, model_->table().tool_radius_m);
  travel(centre.at_in_base, normal, options_.motion, Mode::move);
}

void ArmController::retract(double distance_m) noexcept {
  ToolMotion::Limits limits = options_.motion;
  limits.travel.speed_per_s = options_.retract_m_per_s;
  const Vector3& normal = reference_.pose.normal_in_base;
  flies_ = status_.mode == Mode::contact && force_target_.pushed_away();
  escaped_at_in_base_ = centre_;
  travel(centre_ + distance_m * normal, normal, limits, Mode::retract);
  leaving_m_ = distance_m;
  leaving_n_ = status_.force_n;
  escape_.begin(status_.force_n);
}

void ArmController::lead() noexcept {
  stop_learning();
  status_.mode = Mode::lead;
  status_.contact_fault = ContactFault::none;
  status_.settled = true;
  spring_n_.setZero();
  settling_n_.setZero();
}

void ArmController::approach(const ToolPose& skin) noexcept {
  const Vector3 normal = skin.normal_in_base.normalized();
  const bool usable = skin.at_in_base.allFinite() && std::abs(normal.norm() - 1.0) < 1e-6;
  if (!usable) return give_up(ContactFault::bad_command);
  stop_learning();
  sense_.tare();
  settling_n_.setZero();
  target_ = {.at_in_base = skin.at_in_base, .normal_in_base = normal, .model = target_.model};
  reference_ = {.pose = centre_pose({skin.at_in_base, normal}, model_->table().tool_radius_m)};
  const Vector3 above = reference_.pose.at_in_base - centre_;
  // The search starts at rest where the spring already is.
  search_m_ = above.dot(normal) - spring_n_.dot(normal) / options_.force.stiffness_n_per_m;
  search_speed_ = 0.0;
  touched_s_ = quiet_s_ = 0.0;
  status_ = {.mode = Mode::approach, .settled = false, .normal_in_base = normal};
}

void ArmController::track(const ContactTarget& target) noexcept {
  if (status_.mode != Mode::contact) return;
  const bool usable = target.at_in_base.allFinite() && target.velocity_m_per_s.allFinite() &&
                      std::abs(target.normal_in_base.norm() - 1.0) < 1e-3 &&
                      std::isfinite(target.force_n) && target.model.tissue.alpha_n > 0.0 &&
                      target.model.tissue.beta_per_m > 0.0 && target.model.torso_n_per_m > 0.0;
  if (!usable) return give_up(ContactFault::bad_command);
  target_ = target;
  reference_ = {.pose = centre_pose({target.at_in_base, target.normal_in_base},
                                    model_->table().tool_radius_m),
                .velocity_m_per_s = target.velocity_m_per_s};
}

}  // namespace tuina::control
