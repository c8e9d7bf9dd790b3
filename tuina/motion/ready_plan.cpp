// SPDX-License-Identifier: Apache-2.0
#include "tuina/motion/ready_plan.hpp"

#include <algorithm>
#include <limits>
#include <optional>

#include "tuina/core/parallel.hpp"
#include "tuina/core/units.hpp"
#include "tuina/motion/configuration_choice.hpp"
#include "tuina/motion/two_arm_schedule.hpp"
#include "tuina/robot/inverse_kinematics.hpp"
#include "tuina/robot/ready_posture.hpp"

namespace tuina::motion {
namespace {

constexpr double rail_goals_m = 20_mm;
constexpr double lifted_m = 45_mm;  // height above the stand-off in transfers

/// Goals for placing the base: the points of each arm's paths, repeated paths once, and the lifted
/// approach poses at their ends.
PerArm<std::vector<robot::ContactGoal>> goals_for_rail(const massage::Plan& plan,
                                                       const Transform& base_from_couch,
                                                       double standoff_m) {
  PerArm<std::vector<robot::ContactGoal>> goals;
  for (const massage::PlannedPath& planned : plan.paths) {
    std::vector<robot::ContactGoal>& of_arm = goals[planned.arm];
    auto places = goals_of(planned.path, base_from_couch);
    for (const ContactPoint* end : {&planned.path.points.front(), &planned.path.points.back()}) {
      const ApproachPose approach = approach_pose(*end, standoff_m + lifted_m);
      places.push_back({.at_in_base = base_from_couch * approach.at_in_couch,
                        .normal_in_base = base_from_couch.linear() * approach.normal_in_couch});
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

/// Schedules the paths step by step for a base at one place; gives up once more than
/// `max_left_out` paths are left out.
TwoArmSchedule schedule_paths(const Stage& stage, const std::vector<massage::PlannedPath>& paths,
                              std::size_t max_left_out) {
  TwoArmSchedule schedule(stage);
  for (std::size_t i = 0; i < paths.size() && schedule.left_out <= max_left_out;) {
    const int step = paths[i].step;
    PerArm<const massage::PlannedPath*> together;
    for (; i < paths.size() && paths[i].step == step; ++i) together[paths[i].arm] = &paths[i];
    schedule.add_step(together);
  }
  schedule.finish();
  return schedule;
}

/// Height of the lower tool above the skin while both arms stand ready.
double ready_height_m(const Stage& stage) {
  double lowest_m = std::numeric_limits<double>::infinity();
  for (const Arm arm : both_arms) {
    const Vector3 tool = rest_at_ready(stage, arm).over.at_in_couch;
    lowest_m = std::min(lowest_m, height_above_skin_m(stage.back, tool));
  }
  return lowest_m;
}

/// Fewer paths left out, or as many and a newton less given up.
bool is_better(const TwoArmSchedule& one, const TwoArmSchedule& other) {
  constexpr double counts_n = 1.0;
  if (one.left_out != other.left_out) return one.left_out < other.left_out;
  return one.lowered_n < other.lowered_n - counts_n;
}

}  // namespace

Result<ReadyPlan> make_ready(massage::Plan plan, const body::BackSurface& back,
                             const robot::RobotMount& mount, const PerArm<robot::ArmModel>& models,
                             const Transform& base_from_couch, double standoff_m,
                             std::optional<double> rail_m) {
  ReadyPlan ready{.plan = std::move(plan)};
  ready.ready_rad = robot::ready_posture(models[Arm::left].table(), mount);
  std::stable_sort(ready.plan.paths.begin(), ready.plan.paths.end(),
                   [](const auto& a, const auto& b) { return a.step < b.step; });
  const auto waiting = [&](double at_m) {
    return robot::ready_room(models, mount, ready.ready_rad, at_m);
  };
  const char* const position = name_of(back.position());
  for (const Arm arm : both_arms) {
    const double off_m = waiting(0.0).off_m[arm];
    if (off_m < robot::max_ready_off_m) continue;
    return fail(Fault::config,
                "the {} tool can only wait {:.0f} mm from where ready_mm of the robot's [{}] has "
                "it: out of reach, or past the ends of joints",
                name_of(arm), to_mm(off_m), position);
  }
  // A path may be unreachable from every place of the base; the others are then planned from zero.
  const double dexterous_m =
      robot::choose_rail({.of = {&models[Arm::left], &models[Arm::right]}}, mount,
                         goals_for_rail(ready.plan, base_from_couch, standoff_m), ready.ready_rad,
                         {.press_depth_m = press_depth_m})
          .value_or(0.0);
  // Where the tools are most dexterous the arms may collide, so other places are tried too.
  std::vector<double> stands_m;
  const auto offer = [&](double at_m) {
    if (at_m >= mount.min_rail_m && at_m <= mount.max_rail_m) stands_m.push_back(at_m);
  };
  if (rail_m) {
    offer(*rail_m);
  } else {
    for (const double aside_m :
         {0_mm, -100_mm, 100_mm, -200_mm, 200_mm, -50_mm, 50_mm, -150_mm, 150_mm})
      offer(dexterous_m + aside_m);
  }
  const auto stage_at = [&](double at_m) {
    return Stage{.back = back,
                 .models = models,
                 .base_from_couch = base_from_couch,
                 .rail_m = at_m,
                 .standoff_m = standoff_m,
                 .ready_rad = ready.ready_rad,
                 .obstacles = mount.obstacles};
  };
  // A base may stand where the paths are within reach and the tools that wait are in the person.
  std::erase_if(stands_m, [&](double at_m) { return ready_height_m(stage_at(at_m)) < standoff_m; });
  if (stands_m.empty()) {
    return fail(Fault::not_found,
                "wherever the base stands within reach, an arm that is ready would be less than "
                "{:.0f} mm from the skin",
                1e3 * standoff_m);
  }
  // From there on the guard lets no arm move.
  constexpr double guarded_m = 25_mm;
  const robot::ReadyRoom first = waiting(stands_m.front());
  std::erase_if(stands_m, [&](double at_m) { return waiting(at_m).min_m() < guarded_m; });
  if (stands_m.empty()) {
    return fail(Fault::config,
                "wherever the base stands within reach, arms wait nearer than {:.0f} mm to "
                "something: {}; ready_mm and ready_near_deg of the robot's [{}] say where and how",
                to_mm(guarded_m), first.nearest(), position);
  }
  std::optional<TwoArmSchedule> best;
  constexpr double worth_n = 10.0;  // given up by all paths together; a stand costs a whole plan
  const auto suits = [&] { return best && best->left_out == 0 && best->lowered_n < worth_n; };
  // The first place nearly always suffices; the others are tried two at a time.
  for (std::size_t next = 0; next < stands_m.size() && !suits();) {
    std::vector<std::optional<TwoArmSchedule>> tried(
        std::min<std::size_t>(next == 0 ? 1 : 2, stands_m.size() - next));
    for_each_in_parallel(tried.size(), [&](std::size_t i) {
      tried[i] = schedule_paths(stage_at(stands_m[next + i]), ready.plan.paths,
                                best ? best->left_out : ready.plan.paths.size());
    });
    for (std::optional<TwoArmSchedule>& one : tried) {
      const double at_m = stands_m[next++];
      if (best && !is_better(*one, *best)) continue;
      best = std::move(*one);
      ready.rail_m = at_m;
    }
  }
  if (!best || best->paths.empty()) {
    return fail(Fault::not_found, "no path of the plan is within reach of the arms{}",
                best && !best->notes.empty() ? ": " + best->notes.front().words : "");
  }
  ready.plan.paths = std::move(best->paths);
  ready.plan.duration_s = best->end_s;
  for (Sentence& note : best->notes) ready.plan.notes.push_back(std::move(note));
  ready.jobs = std::move(best->jobs);
  ready.min_arm_distance_m = best->min_arm_distance_m;
  ready.clear = best->clear;
  ready.reachable = best->left_out == 0;
  return ready;
}

}  // namespace tuina::motion
