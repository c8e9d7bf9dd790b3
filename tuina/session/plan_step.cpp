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
constexpr double closest_arms_m = 60_mm;
constexpr double rail_goals_m = 20_mm;
constexpr double lifted_m = 45_mm;  // above the stand-off, on the way to the next contact
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

/// Where the base has to stand for: the places of each arm's paths, each once however often a path
/// goes there, and the places above their ends, lifted for the way from one to the next.
PerArm<std::vector<robot::ContactGoal>> goals_for_rail(const massage::Plan& plan,
                                                       const Transform& base_from_couch,
                                                       double standoff_m) {
  PerArm<std::vector<robot::ContactGoal>> goals;
  for (const massage::PlannedPath& planned : plan.paths) {
    std::vector<robot::ContactGoal>& of_arm = goals[planned.arm];
    auto places = goals_of(planned.path, base_from_couch);
    for (const ContactPoint* end : {&planned.path.points.front(), &planned.path.points.back()}) {
      const Hover hover = hover_over(*end, standoff_m + lifted_m);
      places.push_back({.at_in_base = base_from_couch * hover.at_in_couch,
                        .normal_in_base = base_from_couch.linear() * hover.normal_in_couch});
    }
    for (const robot::ContactGoal& place : places) {
      const bool is_near = std::any_of(of_arm.begin(), of_arm.end(), [&](const auto& other) {
        return (other.at_in_base - place.at_in_base).norm() < rail_goals_m;
      });
      if (!is_near) of_arm.push_back(place);
    }
  }
  return goals;
}

/// Closest the arms come while their paths run side by side from the same moment; an arm without a
/// path waits at its ready posture.
double closest_m(const PerArm<robot::ArmModel>& models, const PerArm<const Postures*>& running,
                 const PerArm<JointVector>& ready_rad, double rail_m) {
  std::size_t samples = 1;
  for (const Arm arm : both_arms) {
    if (running[arm] != nullptr) samples = std::max(samples, running[arm]->size());
  }
  const auto pose = [&](Arm arm, std::size_t i) {
    const Postures* postures = running[arm];
    return models[arm].kinematics(
        postures == nullptr ? ready_rad[arm] : (*postures)[std::min(i, postures->size() - 1)].q_rad,
        rail_m);
  };
  double nearest_m = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < samples; ++i) {
    nearest_m =
        std::min(nearest_m, robot::distance_between_m(models[Arm::left], pose(Arm::left, i),
                                                      models[Arm::right], pose(Arm::right, i)));
  }
  return nearest_m;
}

/// Follows a path without a jump, the elbow as far outward as the path allows: from a posture like
/// the ready one, else from one that suits its middle or end, where the arm may have had to swing
/// round.
Result<Postures> follow_path(const robot::ArmModel& model, double rail_m,
                             const std::vector<robot::ContactGoal>& goals,
                             const JointVector& ready_rad, robot::PostureOptions options) {
  Result<Postures> followed;
  for (const double elbow_outward_m : {250_mm, 150_mm, 0_mm}) {
    options.elbow_outward_m = elbow_outward_m;
    followed = robot::follow(model, rail_m, goals, ready_rad, options);
    for (const std::size_t place : {goals.size() / 2, goals.size() - 1}) {
      if (followed) return followed;
      const auto there = robot::find_posture(model, rail_m, goals[place], ready_rad, options);
      if (there.reach == robot::Reach::reached) {
        followed = robot::follow(model, rail_m, goals, there.q_rad, options);
      }
    }
    if (followed) return followed;
  }
  return followed;
}

/// Follows every path; those that no posture reaches leave the plan, with a note.
std::vector<Postures> keep_what_is_reached(ReadyPlan& ready, const PerArm<robot::ArmModel>& models,
                                           const Transform& base_from_couch,
                                           const robot::PostureOptions& options) {
  std::vector<massage::PlannedPath> reached;
  std::vector<Postures> postures;
  for (massage::PlannedPath& planned : ready.plan.paths) {
    auto followed =
        follow_path(models[planned.arm], ready.rail_m, goals_of(planned.path, base_from_couch),
                    ready.ready_rad[planned.arm], options);
    if (!followed) {
      ready.reachable = false;
      ready.plan.notes.push_back(
          fmt::format("{} is left out: {}", planned.path.name, followed.error().message));
      continue;
    }
    postures.push_back(std::move(*followed));
    reached.push_back(std::move(planned));
  }
  ready.plan.paths = std::move(reached);
  return postures;
}

/// Paths of one step whose arms would come too close get steps of their own.
void part_close_arms(ReadyPlan& ready, const std::vector<Postures>& postures,
                     const PerArm<robot::ArmModel>& models) {
  std::vector<massage::PlannedPath>& paths = ready.plan.paths;
  ready.min_arm_distance_m = std::numeric_limits<double>::infinity();
  int inserted = 0;
  for (std::size_t i = 0; i < paths.size();) {
    std::size_t end = i;
    while (end < paths.size() && paths[end].step == paths[i].step) ++end;
    PerArm<const Postures*> running;
    for (std::size_t k = i; k < end; ++k) running[paths[k].arm] = &postures[k];
    const bool two = running[Arm::left] != nullptr && running[Arm::right] != nullptr;
    double distance_m = closest_m(models, running, ready.ready_rad, ready.rail_m);
    const bool apart = distance_m >= closest_arms_m || !two;
    if (!apart) {
      distance_m = std::numeric_limits<double>::infinity();
      for (const Arm arm : both_arms) {
        PerArm<const Postures*> alone;
        alone[arm] = running[arm];
        distance_m = std::min(distance_m, closest_m(models, alone, ready.ready_rad, ready.rail_m));
      }
      ready.plan.notes.push_back(
          fmt::format("{} and {} run one after the other: the arms would touch", paths[i].path.name,
                      paths[end - 1].path.name));
    }
    ready.min_arm_distance_m = std::min(ready.min_arm_distance_m, distance_m);
    const double longest_s = paths[i].path.duration_s();
    for (std::size_t k = i; k < end; ++k) {
      if (!apart && k > i) {
        ++inserted;
        for (std::size_t later = k; later < paths.size(); ++later)
          paths[later].start_s += longest_s;
        ready.plan.duration_s += longest_s;
      }
      paths[k].step += inserted;
    }
    i = end;
  }
}

/// What each arm flies through before each path; an arm with nothing to do in a step keeps out of
/// the way.
void lay_jobs(ReadyPlan& ready, const std::vector<Postures>& postures,
              const body::BackSurface& back, const PerArm<robot::ArmModel>& models,
              const Transform& base_from_couch, double standoff_m) {
  PerArm<Hover> home;
  for (const Arm arm : both_arms) {
    const Transform tool = models[arm].base_from_tool(ready.ready_rad[arm], ready.rail_m);
    const Vector3 normal = control::tool_normal(tool);
    const Vector3 foremost = tool.translation() - models[arm].table().tool_radius_m * normal;
    home[arm] = {.at_in_couch = base_from_couch.inverse() * foremost,
                 .normal_in_couch = base_from_couch.linear().transpose() * normal};
  }
  PerArm<Hover> at = home;
  PerArm<bool> parked{.of = {true, true}};
  const double clear_m = 0.75 * standoff_m;
  const int last = ready.plan.paths.back().step + 1;
  std::size_t next = 0;
  for (int step = 0; step <= last; ++step) {
    PerArm<bool> busy;
    for (; next < ready.plan.paths.size() && ready.plan.paths[next].step == step; ++next) {
      const massage::PlannedPath& planned = ready.plan.paths[next];
      const Arm arm = planned.arm;
      const Hover start = hover_over(planned.path.points.front(), standoff_m);
      ready.jobs[arm].push_back(
          {.path = static_cast<int>(next),
           .step = step,
           .way_in_base = way_between(back, at[arm], start, clear_m, base_from_couch),
           .posture_rad = postures[next].front().q_rad});
      at[arm] = hover_over(planned.path.points.back(), standoff_m);
      busy[arm] = true;
      parked[arm] = false;
    }
    for (const Arm arm : both_arms) {
      if (busy[arm] || parked[arm]) continue;
      ready.jobs[arm].push_back(
          {.path = -1,
           .step = step,
           .way_in_base = way_between(back, at[arm], home[arm], clear_m, base_from_couch),
           .posture_rad = ready.ready_rad[arm]});
      at[arm] = home[arm];
      parked[arm] = true;
    }
  }
}

}  // namespace

Result<ReadyPlan> make_ready(massage::Plan plan, const body::BackSurface& back,
                             const robot::RobotMount& mount, const PerArm<robot::ArmModel>& models,
                             const Transform& base_from_couch, double standoff_m) {
  ReadyPlan ready{.plan = std::move(plan)};
  ready.ready_rad = robot::ready_posture(models[Arm::left].table(), mount);
  std::stable_sort(ready.plan.paths.begin(), ready.plan.paths.end(),
                   [](const auto& a, const auto& b) { return a.step < b.step; });
  const robot::PostureOptions options{.press_depth_m = press_depth_m};
  // A plan may hold a path that no place of the base reaches; the others are still worth doing from
  // zero.
  ready.rail_m = robot::choose_rail({.of = {&models[Arm::left], &models[Arm::right]}}, mount,
                                    goals_for_rail(ready.plan, base_from_couch, standoff_m),
                                    ready.ready_rad, options)
                     .value_or(0.0);
  const std::vector<Postures> postures =
      keep_what_is_reached(ready, models, base_from_couch, options);
  if (ready.plan.paths.empty()) {
    return fail(Fault::not_found, "no path of the plan is within reach of the arms");
  }
  part_close_arms(ready, postures, models);
  lay_jobs(ready, postures, back, models, base_from_couch, standoff_m);
  return ready;
}

}  // namespace tuina::session
