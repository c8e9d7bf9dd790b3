// SPDX-License-Identifier: Apache-2.0
#include "apps/evaluation/safety/trial.hpp"

#include <algorithm>
#include <cmath>

#include "apps/evaluation/safety/trial_arm.hpp"
#include "apps/evaluation/safety/trial_truth.hpp"
#include "apps/evaluation/safety/trial_world.hpp"
#include "tuina/core/units.hpp"
#include "tuina/session/control_loop.hpp"
#include "tuina/session/guarded_zone.hpp"

namespace tuina::app {
namespace {

constexpr double dt_s = control_period_s;
constexpr double settle_s = 0.12;  // the wrist sensor's mean, which is its zero, takes 0.1 s
constexpr double standoff_m = 40_mm;
// A plan touches before it presses, and so does a trial.
constexpr double landing_s = 0.4, ramp_s = 0.5;
constexpr double max_leg_s = 3.0;  // of the way through the air, which takes a second
constexpr double stroke_m = 20_mm, stroke_hz = 0.4;
constexpr double gone_s = 1.3;      // an arm has left by then, and is seen for a while
constexpr double max_way_s = 10.0;  // of all that is not pressing

/// One trial from its first reading to its outcome. What drives the arm sees the readings of a
/// `FaultyRobot`; what judges it sees the plant's truth in every millisecond, those in which nobody
/// runs too.
class Trial {
 public:
  Trial(const TrialPlan& plan, sim::Plant& plant, sim::BackContact& skin, Random& random);
  TrialOutcome run();

 private:
  [[nodiscard]] safety::RobotProposal propose(const robot::RobotReading& reading);
  void conduct();
  void press();
  void begin_faults();
  void happen();
  void stray(Stray where);
  void judge_stop();
  [[nodiscard]] bool over() const;
  [[nodiscard]] Arm other_arm() const { return other(site_.arm); }
  /// A joint that carries the arm: three of the shoulder, and the elbow.
  [[nodiscard]] int joint() const {
    return plan_.joint >= 0 ? plan_.joint : static_cast<int>(plan_.seed % 4);
  }
  [[nodiscard]] Vector3 outward_in_couch() const {
    return std::cos(plan_.tilt_rad) * site_.normal_in_couch +
           std::sin(plan_.tilt_rad) * site_.along_in_couch;
  }
  [[nodiscard]] control::ToolPose tip(const Vector3& at_in_couch) const;

  const TrialPlan& plan_;
  const Site& site_;
  sim::Plant& plant_;
  sim::BackContact& skin_;
  TrialTruth truth_;
  sim::FaultyRobot faulty_;
  TrialArm arm_;
  Vector3 believed_in_couch_;
  control::ContactModel believed_;
  Stage stage_;
  bool stays_;  // in the stage that it has reached
  double stage_s_ = 0.0, set_n_ = 0.0;
  std::vector<bool> happened_;
  double pressing_before_n_ = 0.0;
};

Trial::Trial(const TrialPlan& plan, sim::Plant& plant, sim::BackContact& skin, Random& random)
    : plan_(plan),
      site_(*plan.site),
      plant_(plant),
      skin_(skin),
      truth_(plan, plant),
      faulty_(truth_, plan.seed),
      arm_(site_),
      stage_(Stage::idle),
      stays_(!plan.whole),
      happened_(plan.onsets.size(), false) {
  const auto wrong = [&](double share) { return random() % 2 == 0 ? 1.0 + share : 1.0 - share; };
  const double skin_error_m = 3_mm * (wrong(1.0) - 1.0);
  believed_in_couch_ = site_.above_in_couch(skin_error_m);
  believed_.tissue = {.alpha_n = site_.tissue.alpha_n * plan.alpha_scale * wrong(0.3),
                      .beta_per_m = site_.tissue.beta_per_m * plan.beta_scale * wrong(0.3)};
}

control::ToolPose Trial::tip(const Vector3& at_in_couch) const {
  return {site_.mount.base_from_couch * at_in_couch,
          site_.mount.base_from_couch.linear() * site_.normal_in_couch};
}

TrialOutcome Trial::run() {
  const auto driven = session::run_control_loop(
      faulty_, arm_.guard(),
      [this](const robot::RobotReading& reading) { return propose(reading); },
      [this](const robot::RobotReading&, const safety::RobotVerdict& verdict) {
        arm_.heed(verdict, stage_);
        judge_stop();
        return !over();
      });
  if (!driven) {
    truth_.note_stop(driven.error().message, true);
    while (!over() && truth_.fault() == nullptr) (void)truth_.read();
  }
  return truth_.finish();
}

bool Trial::over() const {
  const double time_s = truth_.time_s();
  if (truth_.begun()) return time_s > truth_.onset_s() + plan_.watched_s;
  return truth_.outcome().stopped || time_s > max_way_s + plan_.press_s ||
         (plan_.onsets.empty() && stage_ == Stage::retract && stage_s_ > gone_s);
}

safety::RobotProposal Trial::propose(const robot::RobotReading& reading) {
  arm_.sense(reading);
  if (!arm_.frozen()) stage_s_ += dt_s;
  conduct();
  const bool due =
      stage_ > plan_.stage || (stage_ == plan_.stage && stage_s_ >= plan_.into_stage_s);
  if (!truth_.begun() && due && !plan_.onsets.empty() && !truth_.outcome().stopped) begin_faults();
  happen();
  truth_.want(set_n_);
  return arm_.propose(reading, stage_, set_n_);
}

/// Travel, approach, contact and the way out, as a session conducts them.
void Trial::conduct() {
  control::ArmController& controller = arm_.controller();
  const control::ArmStatus& status = controller.status();
  const auto next = [&](Stage stage) { stage_ = stage, stage_s_ = 0.0; };
  set_n_ = 0.0;
  if (arm_.stopped()) return;
  switch (stage_) {
    case Stage::idle:
      if (stage_s_ < settle_s || (stays_ && plan_.stage == Stage::idle)) return;
      if (first_stage(plan_) == Stage::approach) {
        controller.approach(tip(believed_in_couch_));
        return next(Stage::approach);
      }
      controller.move_to(tip(believed_in_couch_ + standoff_m * site_.normal_in_couch));
      return next(Stage::travel);
    case Stage::travel:
      if (stays_ && plan_.stage == Stage::travel) return;
      if (!status.settled && stage_s_ < max_leg_s) return;
      controller.approach(tip(believed_in_couch_));
      return next(Stage::approach);
    case Stage::approach:
      if (status.mode == control::Mode::contact) next(Stage::contact);
      return;
    case Stage::contact:
      press();
      if ((plan_.whole || plan_.stage == Stage::retract) && stage_s_ > plan_.press_s) {
        controller.retract(standoff_m);
        next(Stage::retract);
      }
      return;
    case Stage::retract:
      return;
  }
}

void Trial::press() {
  set_n_ = site_.force_n * std::clamp((stage_s_ - landing_s) / ramp_s, 0.0, 1.0);
  control::ContactTarget target{.at_in_base = tip(believed_in_couch_).at_in_base,
                                .normal_in_base = tip(believed_in_couch_).normal_in_base,
                                .force_n = set_n_,
                                .max_spring_n = session::max_spring_n(site_.zone),
                                .model = believed_};
  for (std::size_t i = 0; i < plan_.onsets.size(); ++i) {
    if (!happened_[i]) continue;
    const FaultClass& fault = *plan_.onsets[i].fault;
    if (fault.injection.madness == Madness::bad_tissue)
      target.model.tissue.alpha_n = std::numeric_limits<double>::quiet_NaN();
    if (!fault.strokes) continue;
    const double turn = 2.0 * pi * stroke_hz;
    const double since_s = truth_.time_s() - truth_.onset_s() - plan_.onsets[i].later_s;
    const Vector3 along = site_.mount.base_from_couch.linear() * site_.along_in_couch;
    target.at_in_base += stroke_m * std::sin(turn * since_s) * along;
    target.velocity_m_per_s = stroke_m * turn * std::cos(turn * since_s) * along;
  }
  arm_.controller().track(target);
}

/// From the next millisecond on.
void Trial::begin_faults() {
  truth_.begin(stage_ >= Stage::approach ? site_.force_n : 0.0);
  pressing_before_n_ = arm_.inward_n();
  for (const Onset& onset : plan_.onsets) {
    const Injection& injection = onset.fault->injection;
    const double start_s = truth_.onset_s() + onset.later_s;
    if (injection.robot) {
      sim::TimedFault fault = *injection.robot;
      fault.arm = site_.arm;
      fault.onset_s = start_s - 1e-6;
      const bool of_joint = fault.kind >= sim::RobotFault::encoder_frozen &&
                            fault.kind <= sim::RobotFault::drive_gain;
      if (of_joint) fault.part = joint();
      if (fault.kind != sim::RobotFault::drive_gain && fault.kind != sim::RobotFault::motor_gain)
        fault.size *= onset.severity;
      faulty_.add(fault);
    }
    if (injection.person) {
      const PersonMove& move = *injection.person;
      sim::Shift shift{.start_s = start_s,
                       .by_in_couch = onset.severity * move.outward_m * outward_in_couch(),
                       .speed_m_per_s = onset.severity * move.m_per_s,
                       .acceleration_m_per_s2 = move.m_per_s2};
      skin_.add_shift(shift);
      shift.start_s += move.back_after_s;
      shift.by_in_couch = -shift.by_in_couch;
      if (move.back_after_s > 0.0) skin_.add_shift(shift);
    }
  }
}

/// What begins by itself at its time: hands, power, and the controller's madness.
void Trial::happen() {
  if (!truth_.begun()) return;
  for (std::size_t i = 0; i < plan_.onsets.size(); ++i) {
    const Onset& onset = plan_.onsets[i];
    if (happened_[i] || truth_.time_s() < truth_.onset_s() + onset.later_s - 0.5 * dt_s) continue;
    happened_[i] = true;
    const Injection& injection = onset.fault->injection;
    if (injection.hand_inward_n > 0.0 || injection.hand_aside_n > 0.0) {
      const Vector3 hand_in_couch = injection.hand_aside_n * site_.along_in_couch -
                                    injection.hand_inward_n * outward_in_couch();
      plant_.push(site_.arm, {.force_n = onset.severity * site_.mount.base_from_couch.linear() *
                                         hand_in_couch});
    }
    if (injection.power_lost) plant_.cut_power(site_.arm);
    if (injection.emergency_stop) plant_.emergency_stop();
    if (injection.stop_ignored) arm_.guard().expect_stop();
    if (injection.stray != Stray::none) stray(injection.stray);
    if (injection.madness != Madness::none)
      arm_.go_mad(injection.madness, onset.severity * injection.size, injection.hz, joint());
  }
}

/// A controller sends an arm to where it must not be.
void Trial::stray(Stray where) {
  if (where == Stray::other_arm) {
    constexpr double over_place_m = 20_mm;
    return arm_.controller(other_arm()).move_to(tip(site_.above_in_couch(over_place_m)));
  }
  const auto kind = where == Stray::couch ? robot::Surrounding::couch : robot::Surrounding::body;
  for (const robot::Obstacle& obstacle : site_.mount.obstacles) {
    if (obstacle.kind != kind) continue;
    const Vector3 rail =
        obstacle.rides ? Vector3(site_.rail_m * site_.mount.rail_axis_in_base) : Vector3::Zero();
    return arm_.controller().move_to({.at_in_base = obstacle.base_from_box.translation() + rail,
                                      .normal_in_base = arm_.controller().status().normal_in_base});
  }
}

/// What guard and controller have done in this millisecond; to drives that hear neither it is none.
void Trial::judge_stop() {
  if (truth_.guard_killed()) return;
  for (const safety::Verdict* verdict : {&arm_.verdict(), &arm_.verdict(other_arm())}) {
    // A push that is clamped is answered in its millisecond, though nothing is stopped yet.
    if (verdict->action < safety::Action::freeze && verdict->cause != safety::Cause::inward_force)
      continue;
    truth_.note_action();
    if (verdict->latched) truth_.note_stop(name_of(verdict->cause), true);
  }
  const control::ContactFault fault = arm_.controller().status().contact_fault;
  if (fault != control::ContactFault::none && !arm_.stopped()) {
    truth_.note_action();
    truth_.note_stop(name_of(fault), false);
    if (stage_ == Stage::approach || stage_ == Stage::contact)
      arm_.controller().retract(standoff_m);
    stage_ = Stage::retract;
  }
  // A person is first met by the controller, which lets go before the guard has to.
  const bool of_body = std::any_of(plan_.onsets.begin(), plan_.onsets.end(), [](const auto& onset) {
    return onset.fault->injection.person.has_value() || onset.fault->injection.harder != 1.0;
  });
  if (truth_.begun() && of_body && stage_ == Stage::contact &&
      arm_.inward_n() < 0.5 * pressing_before_n_)
    truth_.note_action();
}

}  // namespace

double usual_time_s(Stage stage) {
  constexpr std::array at_s = {0.1, 0.25, 0.6, 1.2, 0.03};
  return at_s[static_cast<std::size_t>(stage)];
}

Result<TrialOutcome> run_trial(const TrialPlan& plan) {
  Random random = make_random(plan.seed, "safety trial");
  sim::BackContact skin = skin_of(plan);
  auto plant = plant_of(plan, skin, random);
  if (!plant) return tl::unexpected(plant.error());
  return Trial(plan, **plant, skin, random).run();
}

}  // namespace tuina::app
