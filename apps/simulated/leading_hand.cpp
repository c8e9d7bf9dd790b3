// SPDX-License-Identifier: Apache-2.0
#include "apps/simulated/leading_hand.hpp"

#include <algorithm>
#include <cmath>

#include "tuina/body/back_surface.hpp"
#include "tuina/control/cartesian_impedance.hpp"
#include "tuina/core/units.hpp"
#include "tuina/massage/plan.hpp"
#include "tuina/massage/programme.hpp"

namespace tuina::app {

using control::ToolPose;

namespace {

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

}  // namespace

void HandMotion::go(const ToolPose& to, double speed_m_per_s) {
  const double way_m = (to.at_in_base - last_.at_in_base).norm();
  const double turn_rad =
      std::acos(std::clamp(to.normal_in_base.dot(last_.normal_in_base), -1.0, 1.0));
  const double duration_s = std::max({way_m / speed_m_per_s, turn_rad / 0.4, 0.2});
  legs_.push_back({.begin_s = end_s_, .end_s = end_s_ + duration_s, .from = last_, .to = to});
  end_s_ = legs_.back().end_s;
  last_ = to;
}

void HandMotion::press(const ContactPath& path, const Transform& base_from_couch) {
  legs_.push_back({.begin_s = end_s_, .end_s = end_s_ + path.duration_s(), .path = &path});
  base_from_couch_ = base_from_couch;
  end_s_ = legs_.back().end_s;
  last_ = pose(path.points.back());
}

HandMotion::Now HandMotion::at(double time_s) const {
  const auto next =
      std::find_if(legs_.begin(), legs_.end(), [&](const Leg& leg) { return time_s < leg.end_s; });
  const Leg& leg = next == legs_.end() ? legs_.back() : *next;
  const double length_s = leg.end_s - leg.begin_s;
  const double u = std::clamp((time_s - leg.begin_s) / length_s, 0.0, 1.0);
  if (leg.path != nullptr) return along(*leg.path, u * length_s);
  // The straight way with the least jerk (Flash and Hogan 1985).
  const double s = u * u * u * (10.0 + u * (6.0 * u - 15.0));
  const double ds = 30.0 * u * u * (1.0 - u) * (1.0 - u) / length_s;
  const Vector3 way = leg.to.at_in_base - leg.from.at_in_base;
  return {.tip = {leg.from.at_in_base + s * way,
                  ((1.0 - s) * leg.from.normal_in_base + s * leg.to.normal_in_base).normalized()},
          .velocity = ds * way};
}

ToolPose HandMotion::pose(const ContactPoint& point) const {
  return {base_from_couch_ * point.at_in_couch, base_from_couch_.linear() * point.normal_in_couch};
}

HandMotion::Now HandMotion::along(const ContactPath& path, double path_s) const {
  const double step_s = path.points[1].time_s - path.points[0].time_s;
  const auto last = static_cast<double>(path.points.size() - 1);
  const double place = std::clamp(path_s / step_s, 0.0, last - 1e-6);
  const auto k = static_cast<std::size_t>(place);
  const double u = place - static_cast<double>(k);
  const ToolPose a = pose(path.points[k]), b = pose(path.points[k + 1]);
  return {.tip = {(1.0 - u) * a.at_in_base + u * b.at_in_base,
                  ((1.0 - u) * a.normal_in_base + u * b.normal_in_base).normalized()},
          .velocity = (b.at_in_base - a.at_in_base) / step_s,
          .press_n = (1.0 - u) * path.points[k].force_n + u * path.points[k + 1].force_n};
}

Wrench Hand::push(const HandMotion::Now& wanted, const Transform& base_from_tool,
                  const Vector3& velocity, double felt_n, double radius_m) {
  constexpr double tick_s = 1e-3;
  constexpr double stiffness = 1500.0, damping = 60.0, max_n = 60.0;
  constexpr double turn_stiffness = 10.0, turn_damping = 0.5, force_per_s = 3.0;
  const Vector3& normal = wanted.tip.normal_in_base;
  const Vector3 centre = wanted.tip.at_in_base + radius_m * normal;
  Vector3 force =
      stiffness * (centre - base_from_tool.translation()) + damping * (wanted.velocity - velocity);
  if (wanted.press_n > 0.0) {
    force -= force.dot(normal) * normal;
    leaning_n_ += tick_s * force_per_s * (wanted.press_n - felt_n);
    force -= (wanted.press_n + leaning_n_ + damping * velocity.dot(normal)) * normal;
  } else {
    leaning_n_ = 0.0;
  }
  const Vector3 axis = control::tool_normal(base_from_tool);
  const Vector3 turning =
      last_axis_.isZero() ? Vector3::Zero() : Vector3((axis - last_axis_) / tick_s);
  last_axis_ = axis;
  return {.force_n = control::clamp_norm(force, max_n),
          .torque_nm = turn_stiffness * axis.cross(normal) - turn_damping * axis.cross(turning)};
}

Result<TeachingHand> TeachingHand::make(const TeachOrder& order, const sim::Person& person,
                                        const robot::RobotPlacement& placement) {
  auto plan = plan_for(person, order, placement);
  if (!plan) return tl::unexpected(plan.error());
  auto kept = std::make_unique<const motion::ReadyPlan>(std::move(*plan));
  const robot::ArmModel model = robot::both_models(placement.arm, placement.mount)[order.arm];
  const Transform home = model.base_from_tool(kept->ready_rad[order.arm], kept->rail_m);
  HandMotion wanted = hand_motion(*kept, control::tip_pose(home, model.table().tool_radius_m),
                                  order.arm, placement.mount.base_from_couch);
  return TeachingHand(order.arm, std::move(kept), std::move(wanted));
}

Wrench TeachingHand::lead(sim::World& world, double time_s) {
  if (time_s < learning_s) return {};
  const sim::ArmTruth& truth = world.truth().arms[arm_];
  const Transform& base_from_couch = world.mount().base_from_couch;
  Wrench push = hand_.push(wanted_.at(time_s - learning_s), base_from_couch * truth.couch_from_tool,
                           base_from_couch.linear() * truth.velocity_in_couch,
                           truth.contact.force_n, world.robot_table().tool_radius_m);
  world.plant().push(arm_, push);
  return push;
}

}  // namespace tuina::app
