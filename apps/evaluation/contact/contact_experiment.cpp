// SPDX-License-Identifier: Apache-2.0
#include "apps/evaluation/contact/contact_experiment.hpp"

#include <algorithm>
#include <cmath>

#include "apps/cli/asked_to_end.hpp"
#include "apps/evaluation/contact/late_robot.hpp"
#include "apps/evaluation/contact/patch_path.hpp"
#include "apps/simulated/placed_arms.hpp"
#include "tuina/control/beat_correction.hpp"
#include "tuina/control/late_force.hpp"
#include "tuina/massage/technique/contact_path.hpp"
#include "tuina/robot/ready_posture.hpp"
#include "tuina/robot/robot_model.hpp"
#include "tuina/session/control_loop.hpp"
#include "tuina/session/controlled_arm.hpp"
#include "tuina/tissue/press_estimator.hpp"

namespace tuina::app {
namespace {

constexpr double dt_s = control_period_s;
constexpr double standoff_m = 40_mm;

/// How much the true force trembles while its target stands still.
class Ripple {
 public:
  void add(double target_n, double true_n) noexcept {
    still_s_ = std::abs(target_n - target_n_) < 1e-9 && target_n > 0.0 ? still_s_ + dt_s : 0.0;
    target_n_ = target_n;
    mean_n_ += (true_n - mean_n_) * dt_s / 0.08;
    if (still_s_ < 0.5) return;
    squares_ += (true_n - mean_n_) * (true_n - mean_n_);
    ++samples_;
  }
  [[nodiscard]] double rms_n() const {
    return samples_ > 0 ? std::sqrt(squares_ / static_cast<double>(samples_)) : 0.0;
  }

 private:
  double target_n_ = 0.0, still_s_ = 0.0, mean_n_ = 0.0, squares_ = 0.0;
  long samples_ = 0;
};

// Between the samples of a path, in the frame the controller speaks.
control::ContactTarget target_at(const ContactPath& path, const Transform& base_from_couch,
                                 double time_s, const control::ContactModel& model) {
  const double place =
      std::clamp(time_s / massage::sample_s, 0.0, static_cast<double>(path.points.size()) - 1.001);
  const auto k = static_cast<std::size_t>(place);
  const double share = place - static_cast<double>(k);
  const ContactPoint &a = path.points[k], &b = path.points[k + 1];
  return {.at_in_base =
              base_from_couch * Vector3((1.0 - share) * a.at_in_couch + share * b.at_in_couch),
          .velocity_m_per_s =
              base_from_couch.linear() * (b.at_in_couch - a.at_in_couch) / massage::sample_s,
          .normal_in_base = base_from_couch.linear() * a.normal_in_couch,
          .force_n = (1.0 - share) * a.force_n + share * b.force_n,
          .model = model};
}

/// Configuration in which the tool has this pose, found from where the robot's table says that the
/// search for its ready posture begins; without a word there, from arms bent a little, since those
/// stretched out at zero are singular.
Result<JointVector> configuration_for(const PerArm<robot::ArmModel>& models,
                                      const robot::RobotMount& mount, Arm arm,
                                      const control::ToolPose& tip) {
  const robot::ArmTable& table = models[arm].table();
  JointVector near = mount.ready_near_rad;
  if (near.size() != table.joints) {
    near = JointVector::Zero(table.joints);
    near.head<4>() << -0.3, -0.3, 0.0, 0.3;
  }
  if (arm == Arm::right) near = robot::mirrored(table, mount, near);
  control::JointFollower follower;
  follower.start(near);
  const control::ToolPose centre = {tip.at_in_base + table.tool_radius_m * tip.normal_in_base,
                                    tip.normal_in_base};
  constexpr int enough_steps = 3000;
  JointVector q = near;
  for (int i = 0; i < enough_steps; ++i) q = follower.step(models[arm], 0.0, centre, near);
  const double off_m =
      (models[arm].base_from_tool(q, 0.0).translation() - centre.at_in_base).norm();
  if (off_m > 1_mm) {
    return fail(Fault::not_found, "the {} arm comes to {:.0f} mm of the place where it is to begin",
                name_of(arm), to_mm(off_m));
  }
  return q;
}

}  // namespace

Result<ContactOutcome> run_contact(const ContactExperiment& experiment, const Progress& progress) {
  Random random = make_random(experiment.seed, "contact experiment");
  const auto model_of_robot = robot::load_robot(experiment.robot);
  if (!model_of_robot) return tl::unexpected(model_of_robot.error());
  const robot::RobotPlacement placement = robot::place_robot(*model_of_robot, BodyPosture::sitting);
  const robot::RobotMount& mount = placement.mount;
  const robot::ArmTable& believed = placement.arm;
  PerArm<robot::ArmTable> arms;
  for (const Arm arm : both_arms) {
    arms[arm] = sim::draw_arm(believed,
                              {.mass_spread = experiment.mass_error,
                               .friction_spread = experiment.friction_error,
                               .mass_scale = experiment.mass_scale,
                               .friction_scale = experiment.friction_scale,
                               .tool_mass_share = experiment.tool_weight_error},
                              random);
  }

  // The truth: where the skin is, what it is made of, how it moves.
  const BelievedPatch patch = {.bend_radius_m = experiment.believed_bend_radius_m};
  const Vector3 &patch_in_couch = patch.centre_in_couch, &normal_in_couch = patch.normal_in_couch;
  const ContactPath path = path_on(patch, {.technique = experiment.technique,
                                           .force_n = experiment.force_n,
                                           .duration_s = experiment.duration_s,
                                           .window = experiment.window,
                                           .stroke_across = experiment.stroke_across,
                                           .rub_shape = experiment.rub_shape,
                                           .tap_hz = experiment.tap_hz});
  sim::ContactOptions contact_options{.torso_n_per_m = experiment.torso_n_per_m,
                                      .friction = experiment.skin_friction,
                                      .breathing = experiment.breathing,
                                      .living = experiment.living,
                                      .seed = experiment.seed};
  Mesh skin = sim::make_patch(
      {.centre_in_couch = patch_in_couch - experiment.surface_error_m * normal_in_couch,
       .normal_in_couch = normal_in_couch,
       .size_m = 320_mm,
       .bend_radius_m = experiment.bend_radius_m});
  const Eigen::AngleAxisd lean(experiment.surface_tilt_rad, Vector3::UnitX());
  for (Vector3& vertex : skin.vertices) vertex = patch_in_couch + lean * (vertex - patch_in_couch);
  std::vector<TangentTissue> tissues(skin.vertices.size(), experiment.tissue);
  sim::BackContact person(std::move(skin), std::move(tissues), contact_options);

  // The belief.
  const auto wrong = [&] {
    return random() % 2 == 0 ? 1.0 + experiment.tissue_error : 1.0 - experiment.tissue_error;
  };
  control::ContactModel model;
  model.tissue.alpha_n = experiment.tissue.alpha_n * wrong();
  model.tissue.beta_per_m = experiment.tissue.beta_per_m * wrong();

  const PerArm<robot::ArmModel> models = robot::both_models(believed, mount);
  const auto pose_above = [&](double height_m) {
    return control::ToolPose{mount.base_from_couch * Vector3(path.points.front().at_in_couch +
                                                             height_m * normal_in_couch),
                             mount.base_from_couch.linear() * normal_in_couch};
  };
  const auto above = configuration_for(models, mount, Arm::left, pose_above(2.0 * standoff_m));
  if (!above) return tl::unexpected(above.error());
  // The other arm waits where it waits for a person.
  const JointVector waits_rad = robot::ready_posture(believed, mount)[Arm::right];
  const sim::Plant::Start start = {.q_rad = {.of = {*above, waits_rad}}};
  sim::PlantOptions devices = experiment.devices;
  devices.seed = experiment.seed;
  if (experiment.network) devices.watchdog_ticks = hardware::armlink::max_missed_cycles;
  if (experiment.position) as_within_a_loop(devices);
  auto plant = sim::Plant::make(placement, arms, start, &person, devices);
  if (!plant) return tl::unexpected(plant.error());

  const double lag_s = experiment.position && experiment.late_gains
                           ? believed_lag_s(*experiment.position, experiment.seed)
                           : 0.0;
  PerArm<session::ControlledArm> controlled = {
      {session::ControlledArm(models[Arm::left],
                              control::for_late_force(experiment.controller, lag_s)),
       session::ControlledArm(models[Arm::right])}};
  safety::RobotGuard guard(models, {.bench = true});
  tissue::PressEstimator estimator(tissue::pressed_by_robot(35'000.0, believed.tool_mass_kg));
  ContactOutcome outcome{.tissue = experiment.tissue};
  Vector3 highest_at_in_couch = Vector3::Zero();
  session::ForceErrorSum errors;
  errors.begin();
  enum class Act { settle, move, approach, track, retract, done } act = Act::settle;
  double act_s = 0.0, stopped_s = 0.0;
  bool left_skin = false;
  LateRobot late(**plant, experiment.late_ticks);
  std::optional<NetworkedArms> networked;
  if (experiment.network) networked.emplace(**plant, *experiment.network, experiment.seed);
  robot::Robot& near = networked ? static_cast<robot::Robot&>(*networked) : late;
  robot::Robot& seen = experiment.seen_as ? experiment.seen_as(near) : near;
  std::optional<PlacedArms> placed;
  if (experiment.position) placed.emplace(seen, models, *experiment.position, experiment.seed);
  robot::Robot& robot = placed ? static_cast<robot::Robot&>(placed->robot) : seen;
  Ripple ripple;
  const double max_duration_s = path.duration_s() + 30.0;
  Arm arm = Arm::left;
  control::ArmController& controller = controlled[arm].controller;
  double target_n = 0.0;
  control::BeatCorrection beats;
  beats.begin(experiment.force_n);
  const control::ArmStatus& status = controller.status();
  const auto next = [&](Act now) { act = now, act_s = 0.0; };
  const auto propose = [&](const robot::RobotReading& reading) {
    for (const Arm side : both_arms) controlled[side].sense(reading, side);
    act_s += dt_s;
    target_n = 0.0;
    switch (act) {
      case Act::settle:
        if (act_s > 0.2) controller.move_to(pose_above(standoff_m)), next(Act::move);
        break;
      case Act::move:
        if (status.settled || act_s > 5.0)
          controller.approach(pose_above(0.0)), next(Act::approach);
        break;
      case Act::approach:
        if (status.mode != control::Mode::contact || (!status.settled && act_s < 4.0)) break;
        next(Act::track);
        for (sim::Shift shift : experiment.shifts) {
          shift.start_s += reading.time_s;
          person.add_shift(shift);
        }
        break;
      case Act::track: {
        if (experiment.steer && estimator.estimate().converged)
          model.tissue = estimator.estimate().tissue;
        control::ContactTarget target = target_at(path, mount.base_from_couch, act_s, model);
        target_n = act_s < path.duration_s() ? target.force_n : 0.0;
        if (path.technique == Technique::tap)
          target.force_n = beats.command_n(target.force_n, status.force_n);
        controller.track(target);
        if (act_s >= path.duration_s()) controller.retract(standoff_m), next(Act::retract);
        break;
      }
      case Act::retract:
        if (status.settled || act_s > 3.0) next(Act::done);
        break;
      case Act::done:
        break;
    }
    if (reading.time_s > max_duration_s) next(Act::done);

    safety::RobotProposal wanted;
    for (const Arm side : both_arms)
      wanted.arms[side] = controlled[side].propose(reading, safety::Zone::bench);
    return wanted;
  };
  const auto look = [&](const robot::RobotReading& reading, const safety::RobotVerdict& judged) {
    const sim::ArmTruth& truth = (*plant)->truth().arms[arm];
    // The approach counts too: in the air the estimator learns the zero of the force sensor.
    if (status.mode == control::Mode::approach || status.mode == control::Mode::contact) {
      const Press sample = {.depth_m = status.depth_m, .force_n = status.force_n};
      estimator.update(reading.time_s, sample);
      outcome.felt.push_back({reading.time_s, sample});
    }
    const bool pressing = target_n > 0.0;
    if (pressing) {
      ripple.add(target_n, truth.contact.force_n);
      errors.add(reading.time_s, target_n, truth.contact.force_n);
      outcome.max_speed_m_per_s =
          std::max(outcome.max_speed_m_per_s, truth.velocity_in_couch.norm());
    }
    if (truth.contact.force_n > outcome.highest_n) {
      outcome.highest_n = truth.contact.force_n;
      outcome.tissue = truth.contact.tissue;
      highest_at_in_couch = truth.contact.at_in_couch;
    }
    left_skin =
        left_skin || (outcome.highest_n > 0.5 * experiment.force_n && truth.contact.force_n == 0.0);
    if (left_skin)
      outcome.second_impact_n = std::max(outcome.second_impact_n, truth.contact.force_n);
    outcome.trace.push_back({reading.time_s, target_n, truth.contact.force_n, status.force_n,
                             truth.contact.depth_m, truth.velocity_in_couch.norm()});
    // After a stop the guard drives; a second and a half shows where that ends.
    const auto contact_fault = status.contact_fault;
    const safety::Verdict& verdict = judged.arms[arm];
    const bool by_itself = networked && networked->stopped();
    if (!outcome.stopped && (verdict.latched || by_itself ||
                             contact_fault != control::ContactFault::none || asked_to_end())) {
      outcome.stopped = true;
      stopped_s = reading.time_s;
      outcome.stops.push_back({reading.time_s, verdict.latched  ? name_of(verdict.cause)
                                               : by_itself      ? "armlink broke off"
                                               : asked_to_end() ? name_of(safety::Cause::asked_to)
                                                                : name_of(contact_fault)});
      if (!verdict.latched) controller.retract(standoff_m);
    }
    if (outcome.stopped && reading.time_s > stopped_s + 1.5) next(Act::done);
    if (progress && reading.tick % 100 == 0)
      progress(std::min(reading.time_s / (path.duration_s() + 5.0), 0.99));
    return act != Act::done;
  };
  if (auto driven = session::run_control_loop(robot, guard, propose, look); !driven) {
    // Arms that could not go where they were sent have pressed as hard as they can.
    if (!placed || outcome.trace.empty()) return tl::unexpected(driven.error());
    outcome.stopped = true;
    outcome.stops.push_back({outcome.trace.back().time_s, driven.error().message});
  }
  if (progress) progress(1.0);
  if (!errors.empty()) outcome.force = errors.errors();
  outcome.ripple_n = ripple.rms_n();
  outcome.estimate = estimator.estimate();
  if (outcome.highest_n > 0.0)
    outcome.tissue = person.first_loading(outcome.tissue, highest_at_in_couch, outcome.highest_n);
  return outcome;
}

}  // namespace tuina::app
