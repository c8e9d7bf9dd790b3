// SPDX-License-Identifier: Apache-2.0
// The 1 kHz step of the arm controller; its commands are in arm_controller.cpp.
#include <algorithm>
#include <cmath>

#include "tuina/control/arm_controller.hpp"

namespace tuina::control {
namespace {

constexpr double typical_mass_kg = 4.0;  // apparent mass at the tool of a 9 kg arm, rotors included
constexpr double blocked_after_s = 0.02;
constexpr double touched_after_s = 0.003;
constexpr double quiet_after_s = 0.1;
constexpr double arrived_m = 3e-3;
constexpr double nearly_arrived_m = 10e-3;  // accepted distance of a tool that comes no closer
constexpr double patience_s = 2.0;
constexpr double settling_per_s = 3.0;
constexpr double max_settling_n = 15.0;
constexpr double still_m_per_s = 0.015;
constexpr double search_acceleration_m_per_s2 = 0.4;
// Sine of a little more than ten degrees: how far a normal may be off the guard's own way out.
constexpr double max_normal_error_sine = 0.18;

double inward(const Vector3& vector, const Vector3& normal) {
  return -vector.dot(normal);
}

}  // namespace

// Identification motion: joint springs follow slow sines that swell and fade, out of phase, so that
// the tool hardly travels.
JointVector ArmController::learning_torque(const ArmState& state, double dt_s) noexcept {
  constexpr double turn_rad = 0.02, rate = 2.0 * pi * 1.0, edge_s = 0.5;
  (void)friction_.step(state.q_rad);
  const auto joints = state.q_rad.size();
  const double t = learning_s_;
  const double swell = std::clamp(std::min(t, options_.learn_s - t) / edge_s, 0.0, 1.0);
  JointVector goal = learn_rad_, speed(joints), acceleration(joints), stiffness(joints);
  for (Eigen::Index i = 0; i < joints; ++i) {
    const double a = turn_rad * swell, phase = rate * t + pi * static_cast<double>(i % 2);
    goal[i] += a * std::sin(phase);
    speed[i] = a * rate * std::cos(phase);
    acceleration[i] = -a * rate * rate * std::sin(phase);
    stiffness[i] = 600.0 * dynamics_.mass_kg_m2(i, i);
  }
  if (swell >= 1.0 && learn_nm_.size() == joints) {
    friction_.learn(learn_nm_ - dynamics_.mass_kg_m2 * acceleration, state.dq_rad_per_s);
  }
  learn_nm_ = joint_impedance_torque(dynamics_, state.q_rad, state.dq_rad_per_s, goal, speed,
                                     acceleration, stiffness, 0.8);
  learning_s_ += dt_s;
  if (learning_s_ >= options_.learn_s) {
    friction_.end_learning();
    learning_s_ = -1.0;
    motion_.start({centre_, tool_normal(dynamics_.base_from_tool)});
    motion_s_ = 0.0;
    if (move_after_learning_) move_to(*move_after_learning_);
  }
  return learn_nm_;
}

// A tool that leaves presses less and less; where it presses more, the person comes after it.
bool ArmController::escapes(double dt_s) noexcept {
  leaving_n_ = std::min(leaving_n_, std::max(status_.force_n, 0.0));
  if (!escape_.step(status_.force_n, {leaving_n_, 0.0}, dt_s)) return false;
  const Vector3& outward = reference_.pose.normal_in_base;
  spring_n_ = escape_.push_n(velocity_.dot(outward)) * outward;
  flies_ = escape_.over();
  escaped_at_in_base_ = centre_;
  return true;
}

// Nothing slows a tool that has escaped: a person who gets up still comes after it, and would run
// into one that waits. Once it is well away, or has nearly come to rest, it goes the rest of its
// way.
bool ArmController::flies() noexcept {
  if (!flies_) return false;
  const Vector3& outward = reference_.pose.normal_in_base;
  const double flown_m = (centre_ - escaped_at_in_base_).dot(outward);
  flies_ =
      flown_m < options_.force.escape.flight_m && velocity_.dot(outward) > options_.retract_m_per_s;
  if (!flies_) {
    motion_.start({centre_, outward});
    motion_s_ = 0.0;
    retract(std::max(leaving_m_ - flown_m, 0.0));
  }
  status_.contact_fault = ContactFault::pushed_away;
  return flies_;
}

// Force on a tool in flight. A spring keeps it on its line; along the line nothing brakes it, and
// where the person who comes after it still touches it, it is pushed on outward.
Vector3 ArmController::flight_force() noexcept {
  const Vector3& outward = reference_.pose.normal_in_base;
  const auto aside = [&](const Vector3& vector) -> Vector3 {
    return vector - vector.dot(outward) * outward;
  };
  const double K = options_.stiffness_n_per_m;
  const bool followed = status_.force_n > options_.force.escape.min_felt_n;
  const double push_n = followed ? escape_.push_n(velocity_.dot(outward)) : 0.0;
  spring_n_ =
      push_n * outward + clamp_norm(K * aside(escaped_at_in_base_ - centre_), options_.max_pull_n);
  const double damping = 2.0 * options_.damping_ratio * std::sqrt(typical_mass_kg * K);
  return spring_n_ - damping * aside(velocity_);
}

Vector3 ArmController::free_force(const ArmState& state, double dt_s) noexcept {
  if (status_.mode == Mode::retract && escapes(dt_s)) return spring_n_;
  if (status_.mode == Mode::retract && flies()) return flight_force();
  motion_s_ += dt_s;
  reference_ = motion_.at(motion_s_);
  const Vector3 error = reference_.pose.at_in_base - centre_;
  const Vector3 velocity_error = reference_.velocity_m_per_s - velocity_;
  spring_n_ = clamp_norm(options_.stiffness_n_per_m * error, options_.max_pull_n);
  const double damping =
      2.0 * options_.damping_ratio * std::sqrt(typical_mass_kg * options_.stiffness_n_per_m);

  // Friction and gravity errors at the goal are removed slowly, within bounds.
  const bool over = motion_s_ >= motion_.duration_s();
  if (over)
    settling_n_ = clamp_norm(settling_n_ + settling_per_s * dt_s * spring_n_, max_settling_n);
  const bool patient = motion_s_ < motion_.duration_s() + patience_s;
  const double near_m = patient ? arrived_m : nearly_arrived_m;
  const bool still = over && error.norm() < near_m && velocity_.norm() < still_m_per_s;
  quiet_s_ = still ? quiet_s_ + dt_s : 0.0;
  status_.settled = quiet_s_ >= quiet_after_s;
  const bool pushed =
      status_.mode == Mode::move && state.contact_in_base.force_n.norm() > options_.blocked_n;
  blocked_s_ = pushed ? blocked_s_ + dt_s : 0.0;
  if (blocked_s_ > blocked_after_s) give_up(ContactFault::blocked);
  status_.stiffness_n_per_m = options_.stiffness_n_per_m;
  return spring_n_ + settling_n_ + damping * velocity_error;
}

// Approach fast above the uncertainty band of the skin, at search speed within it, give up below
// it.
double ArmController::approach_force(double depth_m, double speed, double dt_s) noexcept {
  const double goal_speed =
      search_m_ < -options_.search_from_m ? options_.approach_m_per_s : options_.search_m_per_s;
  // Largest speed from which braking to the search speed is possible.
  const double left_m = std::max(-options_.search_from_m - search_m_, 0.0);
  const double max_speed = std::sqrt(options_.search_m_per_s * options_.search_m_per_s +
                                     2.0 * search_acceleration_m_per_s2 * left_m);
  const double change = search_acceleration_m_per_s2 * dt_s;
  search_speed_ += std::clamp(std::min(goal_speed, max_speed) - search_speed_, -change, change);
  const double K = options_.force.stiffness_n_per_m;
  // The search waits for a blocked tool instead of winding up its spring.
  const double max_m = depth_m + options_.touch_pull_n / K;
  search_m_ = std::min(search_m_ + search_speed_ * dt_s, std::max(max_m, search_m_));
  const double spring_n = std::min(K * (search_m_ - depth_m), options_.touch_pull_n);
  const double damping = 2.0 * options_.damping_ratio * std::sqrt(typical_mass_kg * K);

  touched_s_ = status_.force_n > options_.touch_n ? touched_s_ + dt_s : 0.0;
  if (touched_s_ > touched_after_s) {
    force_target_.begin({.depth_m = depth_m, .force_n = status_.force_n, .model = target_.model},
                        spring_n);
    target_.force_n = options_.touch_n;
    status_.mode = Mode::contact;
  } else if (depth_m > options_.search_to_m) {
    give_up(ContactFault::no_skin_found);
  }
  return spring_n + damping * (search_speed_ - speed);
}

Vector3 ArmController::contact_force(double dt_s) noexcept {
  const Vector3& normal = reference_.pose.normal_in_base;
  const Vector3 error = reference_.pose.at_in_base - centre_;
  const double depth_m = error.dot(normal);
  const double speed = inward(velocity_, normal);
  status_.depth_m = depth_m;

  const double K = options_.stiffness_n_per_m;
  const Vector3 along_error = error - error.dot(normal) * normal;
  const Vector3 drag_spring_n = clamp_norm(K * along_error, options_.max_drag_n);

  double normal_n = 0.0, normal_spring_n = 0.0;
  if (status_.mode == Mode::approach) {
    normal_n = approach_force(depth_m, speed, dt_s);
    normal_spring_n =
        std::min(options_.force.stiffness_n_per_m * (search_m_ - depth_m), options_.touch_pull_n);
  } else {
    // The guard knows a way out of the body of its own. Where that is some degrees off this normal,
    // what is stretched along the skin pulls into the body, too.
    const double drag_inward_n = max_normal_error_sine * drag_spring_n.norm();
    normal_n = force_target_.step(
        {.depth_m = depth_m,
         .speed_m_per_s = speed,
         .path_speed_m_per_s = inward(reference_.velocity_m_per_s, normal),
         .slope_speed_m_per_s = -slope_.rise_in_base().dot(reference_.velocity_m_per_s),
         .force_n = status_.force_n,
         .set_force_n = target_.force_n,
         .mass_kg = robot::apparent_mass_kg(dynamics_, normal),
         .max_spring_n = target_.max_spring_n - drag_inward_n,
         .model = target_.model},
        dt_s);
    normal_spring_n = force_target_.spring_n();
    status_.set_force_n = force_target_.set_n();
    status_.skin_error_m = force_target_.skin_error_m();
    const bool quiet = std::abs(status_.force_n - status_.set_force_n) < 1.0;
    quiet_s_ = quiet ? quiet_s_ + dt_s : 0.0;
    status_.settled = quiet_s_ >= quiet_after_s;
    status_.contact_fault = force_target_.pushed_away() ? ContactFault::pushed_away
                            : force_target_.lost()      ? ContactFault::contact_lost
                                                        : ContactFault::none;
  }
  status_.stiffness_n_per_m = options_.force.stiffness_n_per_m;

  const double damping = 2.0 * options_.damping_ratio * std::sqrt(typical_mass_kg * K);
  const Vector3 velocity_error = reference_.velocity_m_per_s - velocity_;
  spring_n_ = drag_spring_n - normal_spring_n * normal;
  return drag_spring_n + damping * (velocity_error - velocity_error.dot(normal) * normal) -
         normal_n * normal;
}

// The thesis' laws get the same virtual target: indentation at the set force plus the deflection of
// their own spring.
JointVector ArmController::baseline_torque(const ArmState& state, double dt_s) noexcept {
  const Vector3& normal = reference_.pose.normal_in_base;
  (void)contact_force(dt_s);  // keeps set force, its rate and contact supervision running
  const double set_n = force_target_.set_n();
  const double expected_m = depth_at(target_.model, set_n);
  ToolReference reference = reference_;
  reference.pose.at_in_base -= expected_m * normal;
  if (options_.law == ControlLaw::thesis) {
    const double K = options_.thesis.stiffness_n_per_m;
    reference.pose.at_in_base -= set_n / K * normal;
    status_.virtual_target_in_base = reference.pose.at_in_base;
    status_.stiffness_n_per_m = K;
    return thesis_torque(dynamics_, model_->table(), state.q_rad, state.dq_rad_per_s, velocity_,
                         state.contact_in_base.force_n, reference, posture_rad_, options_.thesis,
                         options_.turning, options_.posture);
  }
  const auto joints = state.q_rad.size();
  const JointVector stiffness = JointVector::Constant(joints, options_.joint_stiffness_nm_per_rad);
  const Vector3 push_n = -set_n * normal;
  JointVector goal = follower_.step(*model_, rail_m_, reference.pose, posture_rad_);
  goal +=
      dynamics_.jacobian.topRows<3>().transpose() * push_n / options_.joint_stiffness_nm_per_rad;
  const JointVector still = JointVector::Zero(joints);
  return joint_impedance_torque(dynamics_, state.q_rad, state.dq_rad_per_s, goal, still, still,
                                stiffness, 0.8);
}

void ArmController::resume_from_here() noexcept {
  if (status_.mode != Mode::contact) {
    motion_s_ = std::max(0.0, motion_s_ - control_period_s);
    return;
  }
  force_target_.begin(
      {.depth_m = status_.depth_m, .force_n = status_.force_n, .model = target_.model},
      status_.force_n);
}

JointVector ArmController::next_torque(const ArmState& state, double dt_s) noexcept {
  here_rad_ = state.q_rad;
  dynamics_ = model_->evaluate(state.q_rad, state.dq_rad_per_s, rail_m_);
  centre_ = dynamics_.base_from_tool.translation();
  velocity_ = dynamics_.jacobian.topRows<3>() * state.dq_rad_per_s;
  const Vector3& believed = reference_.pose.normal_in_base;
  if (status_.mode == Mode::contact)
    slope_.learn(velocity_, believed, force_target_.deepening_m_per_s(), dt_s);
  else
    slope_.begin(believed);
  status_.force_n = state.contact_in_base.force_n.dot(slope_.normal_in_base());
  status_.touching = status_.force_n > 0.5 * options_.touch_n;

  const bool touching = status_.mode == Mode::approach || status_.mode == Mode::contact;
  const bool baseline = options_.law == ControlLaw::thesis || options_.law == ControlLaw::joint;
  JointVector torque_nm;
  if (learning_s_ >= 0.0) {
    const JointVector learning_nm = learning_torque(state, dt_s);
    status_.virtual_target_in_base = centre_;
    status_.normal_in_base = reference_.pose.normal_in_base;
    return learning_nm + dynamics_.gravity_nm + dynamics_.coriolis_nm;
  }
  if (status_.mode == Mode::lead) {
    reference_ = {.pose = {centre_, tool_normal(dynamics_.base_from_tool)}};
    posture_rad_ = state.q_rad;
    follower_.start(state.q_rad);
    PostureGains gains = options_.posture;
    gains.damping_nm_s_per_rad = options_.lead_damping_nm_s_per_rad;
    torque_nm = lead_through_torque(model_->table(), state.q_rad, state.dq_rad_per_s, gains);
    status_.virtual_target_in_base = centre_;
    status_.stiffness_n_per_m = 0.0;
  } else if (status_.mode == Mode::contact && baseline) {
    torque_nm = baseline_torque(state, dt_s);
  } else {
    const Vector3 force = touching ? contact_force(dt_s) : free_force(state, dt_s);
    torque_nm = task_torque(dynamics_, model_->table(), state.q_rad, state.dq_rad_per_s, force,
                            reference_, posture_rad_, options_.turning, options_.posture);
    follower_.start(state.q_rad);
    status_.virtual_target_in_base = centre_ + spring_n_ / status_.stiffness_n_per_m;
  }
  status_.normal_in_base = reference_.pose.normal_in_base;
  return torque_nm + dynamics_.gravity_nm + dynamics_.coriolis_nm + friction_.step(state.q_rad);
}

}  // namespace tuina::control
