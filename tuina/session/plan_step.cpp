// SPDX-License-Identifier: Apache-2.0
#include "tuina/session/plan_step.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tuina/robot/clearance.hpp"
#include "tuina/robot/inverse_kinematics.hpp"

namespace tuina::session {
namespace {

constexpr double checked_every_s = 0.1;
constexpr double rail_goals_m = 20_mm;
constexpr double press_depth_m =
    8_mm;  // what 30 N press into soft tissue on a torso that gives way

using Postures = std::vector<robot::ContactPosture>;

std::vector<robot::ContactGoal> goals_of(const ContactPath& path,
                                         const Transform& base_from_couch) {
  const double spacing_s = path.points[1].time_s - path.points[0].time_s;
  const auto stride = static_cast<std::size_t>(std::max(1.0, checked_every_s / spacing_s));
  std::vector<robot::ContactGoal> goals;
  for (std::size_t i = 0; i < path.points.size(); i += stride) {
    goals.push_back({.at_in_base = base_from_couch * path.points[i].at_in_couch,
                     .normal_in_base = base_from_couch.linear() * path.points[i].normal_in_couch});
  }
  return goals;
}

/// How far a place is above the skin.
double height_m(const body::BackSurface& back, const Vector3& in_couch) {
  const body::SurfacePoint skin = back.nearest(in_couch);
  return (in_couch - skin.at_in_couch).dot(skin.normal_in_couch);
}

control::ToolPose in_base(const Transform& base_from_couch, const Vector3& at,
                          const Vector3& normal) {
  return {.at_in_base = base_from_couch * at, .normal_in_base = base_from_couch.linear() * normal};
}

struct Hover {
  Vector3 at_in_couch, normal_in_couch;
};

Hover hover_over(const ContactPoint& point, double standoff_m) {
  return {.at_in_couch = point.at_in_couch + standoff_m * point.normal_in_couch,
          .normal_in_couch = point.normal_in_couch};
}

/// Straight through the air where that stays clear of the back; else up, over and down, just high
/// enough.
std::vector<control::ToolPose> way_between(const body::BackSurface& back, const Hover& from,
                                           const Hover& to, double clear_m,
                                           const Transform& base_from_couch) {
  const Vector3 out = back.position() == Position::sitting ? Vector3::UnitY() : Vector3::UnitZ();
  const auto clear = [&](double lift_m) {
    constexpr int samples = 16;
    for (int i = 0; i <= samples; ++i) {
      const double u = static_cast<double>(i) / samples;
      const Vector3 at = (1 - u) * from.at_in_couch + u * to.at_in_couch + lift_m * out;
      if (height_m(back, at) < clear_m) return false;
    }
    return true;
  };
  constexpr double rise_m = 15_mm, most_m = 240_mm;
  double lift_m = 0.0;
  while (!clear(lift_m) && lift_m < most_m) lift_m += rise_m;
  std::vector<control::ToolPose> way;
  if (lift_m > 0.0) {
    way.push_back(in_base(base_from_couch, from.at_in_couch + lift_m * out, from.normal_in_couch));
    way.push_back(in_base(base_from_couch, to.at_in_couch + lift_m * out, to.normal_in_couch));
  }
  way.push_back(in_base(base_from_couch, to.at_in_couch, to.normal_in_couch));
  return way;
}

}  // namespace

Result<ReadyPlan> make_ready(massage::Plan plan, const body::BackSurface& back,
                             const robot::RobotMount& mount, const PerArm<robot::ArmModel>& models,
                             const Transform& base_from_couch, double standoff_m) {
  ReadyPlan ready;
  ready.ready_rad = robot::ready_posture(models[Arm::left].table(), mount);
  const robot::PostureOptions posture_options{.press_depth_m = press_depth_m};

  PerArm<std::vector<robot::ContactGoal>> all_goals;
  for (const massage::PlannedPath& planned : plan.paths) {
    // The base is placed by where the paths go, not by how often: turns and strokes go there again.
    std::vector<robot::ContactGoal>& goals = all_goals[planned.arm];
    for (const robot::ContactGoal& goal : goals_of(planned.path, base_from_couch)) {
      const bool is_near = std::any_of(goals.begin(), goals.end(), [&](const auto& other) {
        return (other.at_in_base - goal.at_in_base).norm() < rail_goals_m;
      });
      if (!is_near) goals.push_back(goal);
    }
  }
  // A plan may hold a path that no place of the base reaches; the others are still worth doing from
  // zero.
  const auto rail = robot::choose_rail({.of = {&models[Arm::left], &models[Arm::right]}}, mount,
                                       all_goals, ready.ready_rad, posture_options);
  ready.rail_m = rail.value_or(0.0);

  std::vector<massage::PlannedPath> reached;
  std::vector<Postures> postures;
  for (massage::PlannedPath& planned : plan.paths) {
    const auto goals = goals_of(planned.path, base_from_couch);
    auto followed = robot::follow(models[planned.arm], ready.rail_m, goals,
                                  ready.ready_rad[planned.arm], posture_options);
    if (!followed) {
      ready.reachable = false;
      plan.notes.push_back(
          fmt::format("{} is left out: {}", planned.path.name, followed.error().message));
      continue;
    }
    postures.push_back(std::move(*followed));
    reached.push_back(std::move(planned));
  }
  if (reached.empty())
    return fail(Fault::not_found, "no path of the plan is within reach of the arms");
  plan.paths = std::move(reached);

  // Paths of one step run together, so their postures are compared at equal times.
  ready.min_arm_distance_m = std::numeric_limits<double>::infinity();
  const int steps =
      1 + std::max_element(plan.paths.begin(), plan.paths.end(), [](const auto& a, const auto& b) {
            return a.step < b.step;
          })->step;
  PerArm<Hover> at;
  PerArm<bool> parked{.of = {true, true}};
  for (const Arm arm : both_arms) {
    const Transform tool = models[arm].base_from_tool(ready.ready_rad[arm], ready.rail_m);
    const Vector3 normal = control::tool_normal(tool);
    const Vector3 foremost = tool.translation() - models[arm].table().tool_radius_m * normal;
    at[arm] = {.at_in_couch = base_from_couch.inverse() * foremost,
               .normal_in_couch = base_from_couch.linear().transpose() * normal};
  }
  const PerArm<Hover> home = at;
  const double clear_m = 0.75 * standoff_m;
  for (int step = 0; step <= steps; ++step) {
    PerArm<const Postures*> running;
    for (const Arm arm : both_arms) {
      bool busy = false;
      for (std::size_t i = 0; i < plan.paths.size(); ++i) {
        const massage::PlannedPath& planned = plan.paths[i];
        if (planned.step != step || planned.arm != arm) continue;
        const Hover start = hover_over(planned.path.points.front(), standoff_m);
        ready.jobs[arm].push_back(
            {.path = static_cast<int>(i),
             .step = step,
             .way_in_base = way_between(back, at[arm], start, clear_m, base_from_couch),
             .posture_rad = postures[i].front().q_rad});
        at[arm] = hover_over(planned.path.points.back(), standoff_m);
        running[arm] = &postures[i];
        busy = true;
        parked[arm] = false;
      }
      // An arm with nothing to do keeps out of the other's way.
      if (!busy && !parked[arm]) {
        ready.jobs[arm].push_back(
            {.path = -1,
             .step = step,
             .way_in_base = way_between(back, at[arm], home[arm], clear_m, base_from_couch),
             .posture_rad = ready.ready_rad[arm]});
        at[arm] = home[arm];
        parked[arm] = true;
      }
    }
    if (step == steps) break;
    const std::size_t samples = std::max(running[Arm::left] ? running[Arm::left]->size() : 1,
                                         running[Arm::right] ? running[Arm::right]->size() : 1);
    const auto pose = [&](Arm arm, std::size_t i) {
      const JointVector& q = running[arm] == nullptr
                                 ? ready.ready_rad[arm]
                                 : (*running[arm])[std::min(i, running[arm]->size() - 1)].q_rad;
      return models[arm].kinematics(q, ready.rail_m);
    };
    for (std::size_t i = 0; i < samples; ++i) {
      ready.min_arm_distance_m =
          std::min(ready.min_arm_distance_m,
                   robot::distance_between_m(models[Arm::left], pose(Arm::left, i),
                                             models[Arm::right], pose(Arm::right, i)));
    }
  }
  ready.plan = std::move(plan);
  return ready;
}

}  // namespace tuina::session
