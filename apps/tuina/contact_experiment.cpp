// SPDX-License-Identifier: Apache-2.0
#include "apps/tuina/contact_experiment.hpp"

#include <algorithm>
#include <cmath>

#include "tuina/massage/contact_path.hpp"
#include "tuina/massage/press.hpp"
#include "tuina/massage/tap.hpp"
#include "tuina/sim/plant.hpp"
#include "tuina/tissue/press_estimator.hpp"

namespace tuina::app {
namespace {

constexpr double dt_s = 1e-3;
constexpr double standoff_m = 40_mm;
constexpr double rub_radius_m = 30_mm;
constexpr double rub_hz = 0.5;
constexpr double stroke_m_per_s = 0.05;
constexpr double stroke_m = 0.25;
const Vector3 patch_in_couch(0.165, 0.03, 0.42);
const Vector3 normal_in_couch = Vector3::UnitY();

// The techniques on a plane: what they are on a person, room `massage` works out from its surface.
ContactPath path_of(const ContactExperiment& experiment) {
  const Vector3 along = Vector3::UnitZ(), across = Vector3::UnitX();
  const body::SurfacePoint place = {.at_in_couch = patch_in_couch,
                                    .normal_in_couch = normal_in_couch};
  switch (experiment.technique) {
    case Technique::press: {
      massage::PressOptions options{
          .force_n = experiment.force_n, .repeats = 1, .window = experiment.window};
      while (options.repeats < 1000) {
        options.repeats += 1;
        if (massage::plan_press(place, options, "").duration_s() > experiment.duration_s) break;
      }
      options.repeats -= 1;
      return massage::plan_press(place, options, "press");
    }
    case Technique::tap: {
      const double time_s = std::max(experiment.duration_s - 2.0 * massage::landing_s, 1.0);
      return massage::plan_tap(place, {.force_n = experiment.force_n, .time_s = time_s}, "tap");
    }
    default:
      break;
  }
  const bool rub = experiment.technique == Technique::rub;
  const double ramp_s = massage::force_ramp_s(experiment.force_n, 0.9);
  // Standing and pressing first, then moving, then standing again until the force is gone.
  massage::Slide slide{.length_m = stroke_m, .speed_m_per_s = stroke_m_per_s};
  const double moving_s =
      rub ? std::max(experiment.duration_s - 2.0 * ramp_s, 2.0 / rub_hz) : slide.duration_s();
  if (rub) {
    slide.speed_m_per_s = 2.0 * pi * rub_radius_m * rub_hz;
    slide.length_m = slide.speed_m_per_s * (moving_s - slide.ramp_s);
  }
  const double duration_s = moving_s + 2.0 * ramp_s;
  return massage::sampled(
      name_of(experiment.technique), experiment.technique, duration_s, [&](double t) {
        const double way_m = slide.way_m(std::clamp(t - ramp_s, 0.0, slide.duration_s()));
        const double angle = way_m / rub_radius_m;
        const Vector3 offset = rub ? Vector3(rub_radius_m * ((std::cos(angle) - 1.0) * across +
                                                             std::sin(angle) * along))
                                   : Vector3((0.5 * stroke_m - way_m) * along);
        const double share = massage::smooth_step(t, ramp_s) -
                             massage::smooth_step(t - (duration_s - ramp_s), ramp_s);
        return ContactPoint{.at_in_couch = patch_in_couch + offset,
                            .normal_in_couch = normal_in_couch,
                            .force_n = experiment.force_n * share};
      });
}

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

JointVector posture_for(const robot::ArmModel& model, const control::ToolPose& foremost) {
  JointVector q(model.joints());
  q.setZero();
  q.head<6>() << -0.3, model.shoulder_in_base(0.0).y() > 0.0 ? -0.3 : 0.3, 0.0, 0.3, 0.0, 0.0;
  const JointVector preferred = q;
  control::JointFollower follower;
  follower.start(q);
  const control::ToolPose centre = {
      foremost.at_in_base + model.table().tool_radius_m * foremost.normal_in_base,
      foremost.normal_in_base};
  for (int i = 0; i < 3000; ++i) q = follower.step(model, 0.0, centre, preferred);
  return q;
}

// One arm with its gate, as every session drives it.
struct GuardedArm {
  control::ArmController controller;
  safety::Guard guard;
  safety::Verdict verdict;
  ArmState state;

  GuardedArm(const robot::ArmModel& model, const control::ArmController::Options& options)
      : controller(model, options), guard({.torque_limit_nm = model.table().torque_limits_nm()}) {}

  void sense(const robot::RobotReading& reading, Arm arm) noexcept {
    state = controller.sense(reading.arms[arm], reading.time_s, reading.rail_m);
  }

  const JointVector& step(const robot::RobotReading& reading, Arm arm) noexcept {
    const JointVector torque = controller.step(state, reading.rail_m, dt_s);
    const control::ArmStatus& status = controller.status();
    const robot::ArmDynamics& dynamics = controller.dynamics();
    const Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, most_joints> jacobian =
        dynamics.jacobian.topRows<3>();
    constexpr std::array phase_of = {safety::Phase::free, safety::Phase::free,
                                     safety::Phase::approach, safety::Phase::contact,
                                     safety::Phase::retract};
    verdict = guard.check({.tick = reading.tick,
                           .time_s = reading.time_s,
                           .wrench_time_s = reading.arms[arm].wrench_time_s,
                           .q_rad = state.q_rad,
                           .dq_rad_per_s = state.dq_rad_per_s,
                           .force_in_base_n = state.contact_in_base.force_n,
                           .tool_in_base = dynamics.base_from_tool.translation(),
                           .tool_velocity_m_per_s = jacobian * state.dq_rad_per_s,
                           .jacobian = jacobian,
                           .gravity_nm = dynamics.gravity_nm},
                          {.torque_nm = torque,
                           .phase = phase_of[static_cast<std::size_t>(status.doing)],
                           .zone = safety::Zone::bench,
                           .set_force_n = status.set_force_n,
                           .normal_in_base = status.normal_in_base,
                           .virtual_target_in_base = status.virtual_target_in_base,
                           .stiffness_n_per_m = status.stiffness_n_per_m});
    return verdict.allowed_nm;
  }
};

}  // namespace

Result<ContactOutcome> run_contact(const ContactExperiment& experiment, const Progress& progress) {
  Random random = make_random(experiment.seed, "contact experiment");
  const robot::RobotMount mount = robot::mount_for(Position::sitting);
  const robot::ArmTable believed = robot::thesis_arm();
  PerArm<robot::ArmTable> arms;
  for (const Arm arm : both_arms) {
    arms[arm] = sim::draw_arm(believed,
                              {.mass_spread = experiment.mass_error,
                               .friction_spread = experiment.friction_error,
                               .friction_scale = experiment.friction_scale},
                              random);
  }

  // The truth: where the skin is, what it is made of, how it moves.
  const ContactPath path = path_of(experiment);
  sim::ContactOptions contact_options{.torso_n_per_m = experiment.torso_n_per_m,
                                      .breathing = experiment.breathing};
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

  const std::array<robot::ArmModel, 2> models = {robot::ArmModel(believed, mount, Arm::left),
                                                 robot::ArmModel(believed, mount, Arm::right)};
  const auto pose_above = [&](double height_m) {
    return control::ToolPose{mount.base_from_couch * Vector3(path.points.front().at_in_couch +
                                                             height_m * normal_in_couch),
                             mount.base_from_couch.linear() * normal_in_couch};
  };
  control::ToolPose aside = pose_above(0.12);
  aside.at_in_base.y() = -0.2;
  const sim::Plant::Start start = {
      .q_rad = {.of = {posture_for(models[0], pose_above(2.0 * standoff_m)),
                       posture_for(models[1], aside)}}};
  auto plant = sim::Plant::make(mount, arms, start, &person, {.seed = experiment.seed});
  if (!plant) return tl::unexpected(plant.error());

  PerArm<GuardedArm> guarded = {
      {GuardedArm(models[0], experiment.controller), GuardedArm(models[1], {})}};
  tissue::PressEstimator estimator(tissue::pressed_by_robot(35'000.0, believed.tool_mass_kg));
  ContactOutcome outcome;
  session::ForceErrorSum errors;
  errors.begin();
  enum class Act { settle, move, approach, track, retract, done } act = Act::settle;
  double act_s = 0.0, stopped_s = 0.0;
  bool left_skin = false;
  const double longest_s = path.duration_s() + 30.0;
  Arm arm = Arm::left;
  control::ArmController& controller = guarded[arm].controller;

  while (act != Act::done) {
    const robot::RobotReading reading = (*plant)->read();
    if (const char* fault = (*plant)->fault())
      return fail(Fault::device, "the robot says: {}", fault);
    for (const Arm side : both_arms) guarded[side].sense(reading, side);
    if (reading.tick == 0 || outcome.trace.empty()) {
      for (const Arm side : both_arms) guarded[side].controller.start(guarded[side].state);
    }
    const control::ArmStatus& status = controller.status();
    const auto next = [&](Act now) { act = now, act_s = 0.0; };
    act_s += dt_s;
    double target_n = 0.0;
    switch (act) {
      case Act::settle:
        if (act_s > 0.2) controller.move_to(pose_above(standoff_m)), next(Act::move);
        break;
      case Act::move:
        if (status.settled || act_s > 5.0)
          controller.approach(pose_above(0.0)), next(Act::approach);
        break;
      case Act::approach:
        if (status.doing != control::Doing::contact || (!status.settled && act_s < 4.0)) break;
        next(Act::track);
        for (sim::Shift shift : experiment.shifts) {
          shift.start_s += reading.time_s;
          person.add_shift(shift);
        }
        break;
      case Act::track: {
        if (experiment.steer && estimator.estimate().converged)
          model.tissue = estimator.estimate().tissue;
        const control::ContactTarget target = target_at(path, mount.base_from_couch, act_s, model);
        controller.track(target);
        target_n = act_s < path.duration_s() ? target.force_n : 0.0;
        if (act_s >= path.duration_s()) controller.retract(standoff_m), next(Act::retract);
        break;
      }
      case Act::retract:
        if (status.settled || act_s > 3.0) next(Act::done);
        break;
      case Act::done:
        break;
    }
    if (reading.time_s > longest_s) next(Act::done);

    robot::RobotCommand command;
    for (const Arm side : both_arms) command.torque_nm[side] = guarded[side].step(reading, side);
    (*plant)->apply(command);

    const sim::ArmTruth& truth = (*plant)->truth().arms[arm];
    // The approach counts too: in the air the estimator learns the zero of the force sensor.
    if (status.doing == control::Doing::approach || status.doing == control::Doing::contact) {
      const Press sample = {.depth_m = status.depth_m, .force_n = status.force_n};
      estimator.update(reading.time_s, sample);
      outcome.felt.push_back({reading.time_s, sample});
    }
    const bool pressing = target_n > 0.0;
    if (pressing) {
      errors.add(reading.time_s, target_n, truth.contact.force_n);
      outcome.fastest_m_per_s = std::max(outcome.fastest_m_per_s, truth.velocity_in_couch.norm());
    }
    outcome.highest_n = std::max(outcome.highest_n, truth.contact.force_n);
    left_skin = left_skin || (act >= Act::track && truth.contact.force_n == 0.0);
    if (left_skin)
      outcome.second_impact_n = std::max(outcome.second_impact_n, truth.contact.force_n);
    outcome.trace.push_back({reading.time_s, target_n, truth.contact.force_n, status.force_n,
                             truth.contact.depth_m, truth.velocity_in_couch.norm()});
    // After a stop the guard drives; a second and a half shows where that ends.
    const auto trouble = status.trouble;
    const safety::Verdict& verdict = guarded[arm].verdict;
    if (!outcome.stopped && (verdict.latched || trouble != control::Trouble::none)) {
      outcome.stopped = true;
      stopped_s = reading.time_s;
      outcome.stops.push_back(
          {reading.time_s, verdict.latched ? name_of(verdict.cause) : name_of(trouble)});
      if (!verdict.latched) controller.retract(standoff_m);
    }
    if (outcome.stopped && reading.time_s > stopped_s + 1.5) next(Act::done);
    if (progress && reading.tick % 100 == 0)
      progress(std::min(reading.time_s / (path.duration_s() + 5.0), 0.99));
  }
  if (progress) progress(1.0);
  if (!errors.empty()) outcome.force = errors.errors();
  outcome.estimate = estimator.estimate();
  return outcome;
}

}  // namespace tuina::app
