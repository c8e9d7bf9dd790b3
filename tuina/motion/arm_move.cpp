// SPDX-License-Identifier: Apache-2.0
#include "tuina/motion/arm_move.hpp"

#include <algorithm>
#include <limits>

#include "tuina/control/cartesian_impedance.hpp"
#include "tuina/motion/configuration_choice.hpp"

namespace tuina::motion {
namespace {

constexpr double checked_every_s = 0.1;
constexpr double way_missed_rad =
    0.35;  // a larger difference is another branch of the inverse kinematics
constexpr double strain_rad = 1_deg;
constexpr double off_path_m = 5_mm;
constexpr double elbow_off_m = 60_mm;  // minimum height above the skin

ArmRest rest(const Stage& stage, Arm arm, const Hover& over, const JointVector& q_rad) {
  ArmRest rest{.over = over, .q_rad = q_rad, .parked = false, .stay = {}};
  rest.stay.q_rad = {q_rad};
  rest.stay.poses = {stage.models.get()[arm].kinematics(q_rad, stage.rail_m)};
  return rest;
}

robot::Clearances clear_of(const Stage& stage, Arm arm, const Passage& passage) {
  robot::Clearances nearest;
  for (const auto& pose : passage.poses) {
    nearest.take_least(
        robot::clearances(stage.models.get()[arm], pose, stage.rail_m, stage.obstacles));
  }
  return nearest;
}

Hover over_tool(const Stage& stage, Arm arm, const JointVector& q_rad) {
  const Transform tool = stage.models.get()[arm].base_from_tool(q_rad, stage.rail_m);
  const Vector3 normal = control::tool_normal(tool);
  const Vector3 foremost =
      tool.translation() - stage.models.get()[arm].table().tool_radius_m * normal;
  return {.at_in_couch = stage.base_from_couch.inverse() * foremost,
          .normal_in_couch = stage.base_from_couch.linear().transpose() * normal};
}

control::ToolPose pose_of(const Stage& stage, const Hover& hover) {
  return {.at_in_base = stage.base_from_couch * hover.at_in_couch,
          .normal_in_base = stage.base_from_couch.linear() * hover.normal_in_couch};
}

/// Rolls out a move twice, with a nullspace that follows its springs slowly and quickly: friction
/// decides which the real arm does.
void rehearse(const Stage& stage, Arm arm, const ArmRest& from, ArmMove& move,
              const std::vector<robot::ContactGoal>& goals, const Hover& above,
              const Hover& after) {
  Passage above_either, after_either;  // end configurations of the slow and the quick rollout
  const auto add = [&](Passage& stay, const JointVector& q_rad) {
    stay.q_rad.push_back(q_rad);
    stay.poses.push_back(stage.models.get()[arm].kinematics(q_rad, stage.rail_m));
  };
  for (const double posture_share : {0.05, 0.3}) {
    Rehearsal rehearsal(stage.models.get()[arm], stage.rail_m, from.q_rad, posture_share);
    for (const control::ToolPose& pose : move.way_in_base) {
      rehearsal.fly(pose, move.posture_rad, move.air);
      // A lag on a leg is made up at its end, unless the arm is stuck.
      move.air.off_m = std::max(move.air.off_m, rehearsal.off_m());
    }
    move.above = move.after = rest(stage, arm, above, rehearsal.q_rad());
    add(above_either, rehearsal.q_rad());
    if (goals.empty()) continue;
    rehearsal.slide(goals, move.posture_rad, move.skin);
    rehearsal.stay(move.posture_rad, move.skin);
    rehearsal.fly(pose_of(stage, after), move.posture_rad, move.skin);
    move.after = rest(stage, arm, after, rehearsal.q_rad());
    add(after_either, rehearsal.q_rad());
  }
  move.after.stay = goals.empty() ? above_either : after_either;
  move.above.stay = std::move(above_either);
  move.clear = clear_of(stage, arm, move.air);
  move.clear.take_least(clear_of(stage, arm, move.skin));
}

double clear_m(const Stage& stage) {
  return 0.75 * stage.standoff_m;
}

/// True when the arm ends in another branch of the inverse kinematics (wrist flipped): the moves
/// after it were planned for this one.
bool misses_posture(const ArmMove& move) {
  const auto near = [&](const JointVector& q_rad) {
    return (q_rad - move.posture_rad).cwiseAbs().maxCoeff() <= way_missed_rad;
  };
  return !near(move.above.q_rad) &&
         std::none_of(move.skin.q_rad.begin(), move.skin.q_rad.end(), near);
}

/// Cost of a move (m): past the midline, at a joint limit, low dexterity, tight clearance.
double badness(const Stage& stage, Arm arm, const ArmMove& move) {
  const robot::ArmModel& model = stage.models.get()[arm];
  const double inward_m = std::max(move.air.inward_m(model, arm), move.skin.inward_m(model, arm));
  const double strained_rad = std::max(move.air.strained_rad, move.skin.strained_rad);
  double clumsy_m = 0.0;
  for (const auto& pose : move.skin.poses) clumsy_m = std::max(clumsy_m, clumsiness_m(pose));
  const double tight_m = std::max(0.0, wanted_arm_distance_m - move.clear.min_m());
  return std::max(inward_m, -own_side_m) + clumsy_m + tight_m +
         (strained_rad > strain_rad ? 0.5 : 0.0);
}

}  // namespace

std::vector<robot::ContactGoal> goals_of(const ContactPath& path,
                                         const Transform& base_from_couch) {
  constexpr double apart_m = 1_mm;
  const double spacing_s = path.points[1].time_s - path.points[0].time_s;
  const auto stride = static_cast<std::size_t>(std::max(1.0, checked_every_s / spacing_s));
  std::vector<robot::ContactGoal> goals;
  for (std::size_t i = 0; i < path.points.size(); i += stride) {
    const Vector3 at = base_from_couch * path.points[i].at_in_couch;
    if (!goals.empty() && (goals.back().at_in_base - at).norm() < apart_m) continue;
    goals.push_back({.at_in_base = at,
                     .normal_in_base = base_from_couch.linear() * path.points[i].normal_in_couch});
  }
  return goals;
}

ArmRest rest_at_ready(const Stage& stage, Arm arm) {
  const JointVector& ready_rad = stage.ready_rad[arm];
  ArmRest ready = rest(stage, arm, over_tool(stage, arm, ready_rad), ready_rad);
  ready.parked = true;
  return ready;
}

ArmMove move_home(const Stage& stage, Arm arm, const ArmRest& from) {
  const Hover home = over_tool(stage, arm, stage.ready_rad[arm]);
  ArmMove move{.way_in_base =
                   way_between(stage.back, from.over, home, clear_m(stage), stage.base_from_couch),
               .posture_rad = stage.ready_rad[arm]};
  move.air_s = time_of_way_s(pose_of(stage, from.over), move.way_in_base);
  rehearse(stage, arm, from, move, {}, home, home);
  move.above.parked = move.after.parked = true;
  return move;
}

/// True when the arm returns to its home configuration, not only to the home pose: with the wrist
/// flipped the posture springs would swing it round.
bool finds_home(const Stage& stage, Arm arm, const ArmRest& from) {
  const ArmMove home = move_home(stage, arm, from);
  const double missed_rad = (home.after.q_rad - stage.ready_rad[arm]).cwiseAbs().maxCoeff();
  return home.air.off_m <= off_path_m && missed_rad <= way_missed_rad &&
         home.clear.min_m() >= closest_arm_distance_m;
}

Result<ArmMove> move_to_path(const Stage& stage, Arm arm, const ArmRest& from,
                             const ContactPath& path, int index) {
  constexpr std::size_t max_rehearsed = 12;
  constexpr double good_enough_m = 15_mm;
  const robot::ArmModel& model = stage.models.get()[arm];
  const auto goals = goals_of(path, stage.base_from_couch);
  const Hover above = hover_over(path.points.front(), stage.standoff_m);
  const Hover after = hover_over(path.points.back(), stage.standoff_m);
  const auto way = way_between(stage.back, from.over, above, clear_m(stage), stage.base_from_couch);

  Rehearsal arrival(model, stage.rail_m, from.q_rad, 0.05);
  Passage flown;
  for (const control::ToolPose& pose : way) arrival.fly(pose, stage.ready_rad[arm], flown);
  const PostureChoice choice =
      postures_for(model, arm, stage.rail_m, goals, stage.ready_rad[arm], arrival.q_rad());

  Result<ArmMove> best = fail(Fault::not_found, "no posture of the arm suits it");
  double least_bad = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < std::min(choice.postures_rad.size(), max_rehearsed); ++i) {
    ArmMove move{.path = index, .way_in_base = way, .posture_rad = choice.postures_rad[i]};
    rehearse(stage, arm, from, move, goals, above, after);
    const double bad = badness(stage, arm, move);
    if (best && bad >= least_bad)
      continue;  // the return home is expensive to roll out, so it is checked last
    const double off_m = std::max(move.air.off_m, move.skin.off_m);
    const char* wrong =
        off_m > off_path_m                       ? "on the way to it the arm gets stuck"
        : move.skin.elbow_height_m < elbow_off_m ? "the elbow would be in the person"
        : move.clear.min_m() < closest_arm_distance_m
            ? "the arm would come too near to the couch or to the robot's body"
        : misses_posture(move)                ? "the arm would come there another way round"
        : !finds_home(stage, arm, move.after) ? "from there the arm does not find its way home"
                                              : nullptr;
    if (wrong != nullptr) {
      if (!best) best = fail(Fault::not_found, "{}", wrong);
      continue;
    }
    least_bad = bad;
    best = std::move(move);
    if (least_bad <= choice.least_bad_m + good_enough_m) break;
  }
  if (!best) {
    const auto followed = robot::follow(model, stage.rail_m, goals, stage.ready_rad[arm],
                                        {.press_depth_m = press_depth_m});
    if (!followed) return tl::unexpected(followed.error());
  }
  if (best) best->air_s = time_of_way_s(pose_of(stage, from.over), way);
  return best;
}

}  // namespace tuina::motion
