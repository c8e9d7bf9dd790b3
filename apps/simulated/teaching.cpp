// SPDX-License-Identifier: Apache-2.0
#include "apps/simulated/teaching.hpp"

#include <algorithm>
#include <cmath>

#include "apps/cli/asked_to_end.hpp"
#include "apps/simulated/session_order.hpp"
#include "tuina/core/units.hpp"
#include "tuina/session/guarded_zone.hpp"
#include "tuina/session/scan_step.hpp"
#include "tuina/sim/person/person.hpp"

namespace tuina::app {
namespace {

using control::ToolPose;

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
  auto hand = TeachingHand::make(order, *person, placement);
  if (!hand) return tl::unexpected(hand.error());
  const motion::ReadyPlan& ready = hand->plan();
  auto made = TeachingStage::make(*person, placement, {ready.ready_rad, ready.rail_m}, config,
                                  common.seed, {order.device, order.robot});
  if (!made) return tl::unexpected(made.error());
  TeachingStage& stage = **made;
  const Arm arm = order.arm;
  const massage::PlannedPath& planned = ready.plan.paths.front();
  TaughtByHand taught{.motion = {.name = planned.path.name,
                                 .position = order.position,
                                 .robot = order.robot,
                                 .arm = arm,
                                 .rail_m = ready.rail_m,
                                 .zone = session::guarded_zone(planned.zone)}};
  const double end_s = hand->end_s();
  const Progress bar = progress_bar(common, "teach");
  std::optional<Error> stopped;
  const auto propose =
      [&](const robot::RobotReading& reading) -> std::optional<safety::RobotProposal> {
    const double time_s = reading.time_s - TeachingHand::learning_s;
    if (reading.time_s > end_s || asked_to_end()) return std::nullopt;
    stage.hear(reading);
    if (bar && reading.tick % 100 == 0) bar(reading.time_s / end_s);
    for (const Arm side : both_arms) stage.arms[side].sense(reading, side);
    control::ArmController& led = stage.arms[arm].controller;
    if (time_s >= 0.0 && led.status().mode != control::Mode::lead) led.lead();
    safety::RobotProposal proposal{.rail_m = ready.rail_m};
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
    const double time_s = reading.time_s - TeachingHand::learning_s;
    if (time_s < 0.0) return true;
    if (order.device.empty()) {
      const double push_n = hand->lead(*stage.world, reading.time_s).force_n.norm();
      taught.peak_hand_n = std::max(taught.peak_hand_n.value_or(0.0), push_n);
    }
    taught.truth.push_back(stage.row(arm, time_s));
    const ArmState& state = stage.arms[arm].state;
    taught.motion.samples.push_back(
        {.time_s = static_cast<double>(taught.motion.samples.size()) * control_period_s,
         .q_rad = state.q_rad,
         .force_n = state.contact_in_base.force_n.dot(control::tool_normal(state.base_from_tool))});
    return true;
  };
  if (auto driven = session::run_control_loop(stage.robot(), stage.guard(), propose, lead); !driven)
    return tl::unexpected(driven.error());
  if (stopped) return tl::unexpected(*stopped);
  taught.asked_to_end = asked_to_end();
  const auto presses = [](const session::TaughtSample& sample) { return sample.force_n > 1.0; };
  if (taught.asked_to_end && std::ranges::none_of(taught.motion.samples, presses))
    return fail(Fault::stopped, "asked to stop before the arm was on the skin; nothing is kept");
  if (bar) bar(1.0);
  taught.motion = session::smoothed(taught.motion);
  if (order.technique == Technique::stroke) {
    if (auto added = add_line(order, common, stage.models[arm], taught.motion); !added)
      return tl::unexpected(added.error());
  }
  return taught;
}

}  // namespace tuina::app
