// SPDX-License-Identifier: Apache-2.0
#include "apps/simulated/teaching.hpp"

#include <algorithm>
#include <cmath>

#include "apps/simulated/leading_hand.hpp"
#include "apps/simulated/session_order.hpp"
#include "tuina/body/back_surface.hpp"
#include "tuina/core/units.hpp"
#include "tuina/massage/plan.hpp"
#include "tuina/massage/programme.hpp"
#include "tuina/motion/ready_plan.hpp"
#include "tuina/session/guarded_zone.hpp"
#include "tuina/session/scan_step.hpp"
#include "tuina/sim/person/person.hpp"

namespace tuina::app {
namespace {

using control::ToolPose;

/// The first path of this technique on this side of the true back, and how the arm gets there.
Result<motion::ReadyPlan> plan_for(const sim::Person& person, const TeachOrder& order,
                                   const robot::RobotPlacement& placement) {
  PointCloud skin;
  skin.points = person.skin_in_couch.vertices;
  const auto back = body::fit_back(skin, {.position = order.position});
  if (!back) return tl::unexpected(back.error());
  const auto programme = massage::load_programme("relax");
  if (!programme) return tl::unexpected(programme.error());
  auto plan = massage::plan(*back, person.acupoints, person.landmarks, *programme);
  if (!plan) return tl::unexpected(plan.error());
  const auto wanted = std::find_if(
      plan->paths.begin(), plan->paths.end(), [&](const massage::PlannedPath& planned) {
        return planned.path.technique == order.technique && planned.arm == order.arm;
      });
  if (wanted == plan->paths.end()) {
    return fail(Fault::usage, "the programme `relax` has no {} for the {} arm",
                name_of(order.technique), name_of(order.arm));
  }
  plan->paths = {massage::PlannedPath(*wanted)};
  plan->paths.front().step = 0;
  const robot::RobotMount& mount = placement.mount;
  constexpr double standoff_m = 40_mm;
  return motion::make_ready(std::move(*plan), *back, mount,
                            robot::both_models(placement.arm, mount), mount.base_from_couch,
                            standoff_m);
}

HandMotion hand_motion(const motion::ReadyPlan& ready, const ToolPose& home, Arm arm,
                       const Transform& base_from_couch) {
  const ContactPath& path = ready.plan.paths.front().path;
  const auto& way = ready.jobs[arm].front().waypoints_in_base;
  const auto over = [&](const ContactPoint& point, double height_m) {
    const Vector3 normal = base_from_couch.linear() * point.normal_in_couch;
    return ToolPose{base_from_couch * point.at_in_couch + height_m * normal, normal};
  };
  HandMotion motion(home);
  for (const ToolPose& pose : way) motion.go(pose, 0.10);
  motion.go(over(path.points.front(), -2_mm), 0.04);
  motion.press(path, base_from_couch);
  motion.go(over(path.points.back(), 60_mm), 0.04);
  for (auto pose = way.rbegin(); pose != way.rend(); ++pose) motion.go(*pose, 0.10);
  motion.go(home, 0.10);
  return motion;
}

/// The way of the tool from its first touch to its farthest place, told by the points that the
/// session's own scan and map find on this back.
Result<void> add_line(const TeachOrder& order, const CommonOptions& common,
                      const robot::ArmModel& model, session::TaughtMotion& motion) {
  SessionOrder ordered;
  ordered.person = order.person;
  ordered.position = order.position;
  ordered.robot = order.robot;
  const session::Config config;
  const auto room = make_room(ordered, config, common);
  if (!room) return tl::unexpected(room.error());
  session::Observers nobody({});
  const auto mapped = session::scan_and_map(room->world->camera(), room->world->turntable(),
                                            room->order, config, nobody);
  if (!mapped) return tl::unexpected(mapped.error());
  const auto chart = massage::BackChart::from(mapped->located.acupoints, mapped->located.landmarks);
  if (!chart) return tl::unexpected(chart.error());
  const Transform couch_from_base = room->order.placed.base_from_couch.inverse();

  constexpr double working_n = 6.0, apart_m = 15_mm;
  std::vector<Vector3> way;
  std::vector<const session::TaughtSample*> worked;
  for (const session::TaughtSample& sample : motion.samples) {
    if (sample.force_n < working_n) continue;
    const Transform tool = model.base_from_tool(sample.q_rad, motion.rail_m);
    const Vector3 tip =
        tool.translation() - model.table().tool_radius_m * control::tool_normal(tool);
    way.push_back(couch_from_base * tip);
    worked.push_back(&sample);
  }
  if (way.empty()) return {};
  // Strokes are shown several times; the first ends where it is as far as any goes.
  const auto far_m = [&](const Vector3& place) { return (place - way.front()).norm(); };
  double max_distance_m = 0.0;
  for (const Vector3& place : way) max_distance_m = std::max(max_distance_m, far_m(place));
  constexpr double nearly_m = 10_mm;
  const auto end = std::find_if(way.begin(), way.end(), [&](const Vector3& place) {
    return far_m(place) > max_distance_m - nearly_m;
  });
  way.erase(end + 1, way.end());
  worked.resize(way.size());
  double length_m = 0.0;
  std::vector<double> forces;
  Vector3 last = way.front();
  motion.line = {chart->relative(chart->place_of(last))};
  for (std::size_t i = 0; i < way.size(); ++i) {
    forces.push_back(worked[i]->force_n);
    if ((way[i] - last).norm() < apart_m && i + 1 < way.size()) continue;
    length_m += (way[i] - last).norm();
    last = way[i];
    motion.line.push_back(chart->relative(chart->place_of(last)));
  }
  const auto middle = forces.begin() + static_cast<std::ptrdiff_t>(forces.size() / 2);
  std::nth_element(forces.begin(), middle, forces.end());
  motion.force_n = *middle;
  motion.speed_m_per_s = length_m / std::max(worked.back()->time_s - worked.front()->time_s, 0.1);
  return {};
}

}  // namespace

Result<TaughtByHand> record_by_hand(const TeachOrder& order, const session::Config& config,
                                    const CommonOptions& common) {
  const auto person = sim::parse_person(order.person, order.position, common.seed);
  if (!person) return tl::unexpected(person.error());
  const auto robot = robot::load_robot(order.robot);
  if (!robot) return tl::unexpected(robot.error());
  const robot::RobotPlacement placement =
      robot::place_robot(*robot, order.position, session::head_at_plus_y(person->acupoints));
  const auto ready = plan_for(*person, order, placement);
  if (!ready) return tl::unexpected(ready.error());
  auto made =
      TeachingStage::make(*person, placement, {.q_rad = ready->ready_rad, .rail_m = ready->rail_m},
                          config, common.seed);
  if (!made) return tl::unexpected(made.error());
  TeachingStage& stage = **made;
  const Arm arm = order.arm;
  const robot::ArmModel& model = stage.models[arm];
  const double radius_m = model.table().tool_radius_m;
  const Transform home = model.base_from_tool(ready->ready_rad[arm], ready->rail_m);
  const HandMotion wanted = hand_motion(
      *ready,
      {home.translation() - radius_m * control::tool_normal(home), control::tool_normal(home)}, arm,
      stage.mount().base_from_couch);

  const massage::PlannedPath& planned = ready->plan.paths.front();
  TaughtByHand taught{.motion = {.name = planned.path.name,
                                 .position = order.position,
                                 .robot = order.robot,
                                 .arm = arm,
                                 .rail_m = ready->rail_m,
                                 .zone = session::guarded_zone(planned.zone)}};
  Hand hand;
  constexpr double learning_s = 3.5;  // the arm learns its friction before it is led
  const double end_s = learning_s + wanted.duration_s() + 0.5;
  const Progress bar = progress_bar(common, "teach");
  std::optional<Error> stopped;
  const auto propose =
      [&](const robot::RobotReading& reading) -> std::optional<safety::RobotProposal> {
    const double time_s = reading.time_s - learning_s;
    if (reading.time_s > end_s) return std::nullopt;
    if (bar && reading.tick % 100 == 0) bar(reading.time_s / end_s);
    for (const Arm side : both_arms) stage.arms[side].sense(reading, side);
    control::ArmController& led = stage.arms[arm].controller;
    if (time_s >= 0.0 && led.status().mode != control::Mode::lead) led.lead();
    safety::RobotProposal proposal{.rail_m = ready->rail_m};
    for (const Arm side : both_arms) {
      session::ControlledArm& one = stage.arms[side];
      const JointVector torque = one.torque_nm(reading);
      const robot::ArmDynamics& dynamics = one.controller.dynamics();
      const bool skin = side == arm && one.state.contact_in_base.force_n.norm() > 1.5;
      proposal.arms[side] = {.torque_nm = torque,
                             .phase = skin ? safety::Phase::contact : safety::Phase::free,
                             .zone = side == arm ? taught.motion.zone : safety::Zone::denied,
                             .normal_in_base = control::tool_normal(dynamics.base_from_tool),
                             .virtual_target_in_base = dynamics.base_from_tool.translation()};
    }
    return proposal;
  };
  const auto lead = [&](const robot::RobotReading& reading, const safety::RobotVerdict& verdict) {
    for (const Arm side : both_arms) {
      if (!verdict.arms[side].latched) continue;
      stopped = Error{Fault::stopped,
                      fmt::format("the {} arm stopped while it was led: {}", name_of(side),
                                  safety::name_of(verdict.arms[side].cause))};
      return false;
    }
    const double time_s = reading.time_s - learning_s;
    if (time_s < 0.0) return true;
    const sim::ArmTruth& truth = stage.world->truth().arms[arm];
    const Transform& base_from_couch = stage.mount().base_from_couch;
    const Wrench push = hand.push(wanted.at(time_s), base_from_couch * truth.couch_from_tool,
                                  base_from_couch.linear() * truth.velocity_in_couch,
                                  truth.contact.force_n, radius_m);
    stage.world->plant().push(arm, push);
    taught.peak_hand_n = std::max(taught.peak_hand_n, push.force_n.norm());
    taught.truth.push_back(stage.row(arm, time_s));
    const ArmState& state = stage.arms[arm].state;
    taught.motion.samples.push_back(
        {.time_s = static_cast<double>(taught.motion.samples.size()) * control_period_s,
         .q_rad = state.q_rad,
         .force_n = state.contact_in_base.force_n.dot(control::tool_normal(state.base_from_tool))});
    return true;
  };
  if (auto driven = session::run_control_loop(stage.world->robot(), stage.guard, propose, lead);
      !driven)
    return tl::unexpected(driven.error());
  if (stopped) return tl::unexpected(*stopped);
  if (bar) bar(1.0);
  taught.motion = session::smoothed(taught.motion);
  if (order.technique == Technique::stroke) {
    if (auto added = add_line(order, common, model, taught.motion); !added)
      return tl::unexpected(added.error());
  }
  return taught;
}

}  // namespace tuina::app
