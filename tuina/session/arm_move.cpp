// SPDX-License-Identifier: Apache-2.0
#include "tuina/session/arm_move.hpp"

#include <algorithm>
#include <limits>

#include "tuina/control/cartesian_impedance.hpp"

namespace tuina::session {
namespace {

constexpr double checked_every_s = 0.1;
constexpr double own_side_m = 30_mm;     // half of what two arms keep between them
constexpr double way_missed_rad = 0.35;  // so far from its posture an arm came round another way
constexpr double strain_rad = 1_deg;
constexpr double off_path_m = 5_mm;

ArmRest rest(const Stage& stage, Arm arm, const Hover& over, const JointVector& q_rad) {
  ArmRest rest{.over = over, .q_rad = q_rad, .parked = false, .stay = {}};
  rest.stay.q_rad = {q_rad};
  rest.stay.poses = {stage.models.get()[arm].kinematics(q_rad, stage.rail_m)};
  return rest;
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

/// Rehearses a move whose way and posture are known, with an elbow that is slow to follow its
/// springs and with one that is quick: which it will be depends on friction.
void rehearse(const Stage& stage, Arm arm, const ArmRest& from, ArmMove& move,
              const std::vector<robot::ContactGoal>& goals, const Hover& above,
              const Hover& after) {
  for (const double posture_share : {0.05, 0.3}) {
    Rehearsal rehearsal(stage.models.get()[arm], stage.rail_m, from.q_rad, posture_share);
    for (const control::ToolPose& pose : move.way_in_base) {
      rehearsal.fly(pose, move.posture_rad, move.air);
      // What it lags behind on a leg it makes up at its end, unless it is stuck.
      move.air.off_m = std::max(move.air.off_m, rehearsal.off_m());
    }
    move.above = move.after = rest(stage, arm, above, rehearsal.q_rad());
    if (goals.empty()) continue;
    rehearsal.slide(goals, move.posture_rad, move.skin);
    rehearsal.stay(move.posture_rad, move.skin);
    rehearsal.fly(pose_of(stage, after), move.posture_rad, move.skin);
    move.after = rest(stage, arm, after, rehearsal.q_rad());
  }
}

double clear_m(const Stage& stage) {
  return 0.75 * stage.standoff_m;
}

/// The posture of a path in which a joint is nearest to its end.
const JointVector& tightest(const robot::ArmModel& model,
                            const std::vector<robot::ContactPosture>& path) {
  const auto room_rad = [&](const robot::ContactPosture& posture) {
    double least_rad = std::numeric_limits<double>::infinity();
    for (int i = 0; i < model.joints(); ++i) {
      const robot::Link& link = model.table().links[static_cast<std::size_t>(i)];
      least_rad = std::min(
          {least_rad, posture.q_rad[i] - link.lowest_rad, link.highest_rad - posture.q_rad[i]});
    }
    return least_rad;
  };
  return std::min_element(path.begin(), path.end(),
                          [&](const auto& a, const auto& b) { return room_rad(a) < room_rad(b); })
      ->q_rad;
}

/// How much a move is to be avoided: over the middle, another way round than it was planned, or
/// with a joint at its end, where an arm may stay behind.
double badness(const Stage& stage, Arm arm, const ArmMove& move) {
  const robot::ArmModel& model = stage.models.get()[arm];
  const double inward_m = std::max(move.air.inward_m(model, arm), move.skin.inward_m(model, arm));
  const double missed_rad = (move.above.q_rad - move.posture_rad).cwiseAbs().maxCoeff();
  const double strained_rad = std::max(move.air.strained_rad, move.skin.strained_rad);
  return inward_m + (missed_rad > way_missed_rad ? 1.0 : 0.0) +
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

/// Home is a posture, not only a place: an arm that gets there with its wrist turned over would
/// swing round when the springs of the posture find their way.
bool finds_home(const Stage& stage, Arm arm, const ArmRest& from) {
  const ArmMove home = move_home(stage, arm, from);
  const double missed_rad = (home.after.q_rad - stage.ready_rad[arm]).cwiseAbs().maxCoeff();
  return home.air.off_m <= off_path_m && missed_rad <= way_missed_rad;
}

Result<ArmMove> move_to_path(const Stage& stage, Arm arm, const ArmRest& from,
                             const ContactPath& path, int index) {
  const robot::ArmModel& model = stage.models.get()[arm];
  const auto goals = goals_of(path, stage.base_from_couch);
  const Hover above = hover_over(path.points.front(), stage.standoff_m);
  const Hover after = hover_over(path.points.back(), stage.standoff_m);
  const auto way = way_between(stage.back, from.over, above, clear_m(stage), stage.base_from_couch);

  Result<ArmMove> best = tl::unexpected(Error{});
  double least_bad = std::numeric_limits<double>::infinity();
  const auto consider = [&](const JointVector& posture_rad) {
    ArmMove move{.path = index, .way_in_base = way, .posture_rad = posture_rad};
    rehearse(stage, arm, from, move, goals, above, after);
    const double off_m = std::max(move.air.off_m, move.skin.off_m);
    if (off_m > off_path_m) {
      if (!best) {
        best = fail(Fault::not_found, "on the way to it the arm gets stuck, {:.0f} mm off",
                    to_mm(off_m));
      }
      return;
    }
    const double bad = badness(stage, arm, move);
    if (bad >= least_bad) return;
    if (!finds_home(stage, arm, move.after)) {
      if (!best) best = fail(Fault::not_found, "from there the arm does not find its way home");
      return;
    }
    least_bad = bad;
    best = std::move(move);
  };

  // The elbow as far outward as the path allows: from a posture like the ready one, from the one
  // in which the way arrives, else from one that suits the middle or the end of the path.
  Rehearsal arrival(model, stage.rail_m, from.q_rad, 0.05);
  Passage flown;
  for (const control::ToolPose& pose : way) arrival.fly(pose, stage.ready_rad[arm], flown);
  for (const double elbow_outward_m : {250_mm, 150_mm, 0_mm}) {
    const robot::PostureOptions options{.elbow_outward_m = elbow_outward_m,
                                        .press_depth_m = press_depth_m};
    std::vector<JointVector> starts = {stage.ready_rad[arm], arrival.q_rad()};
    for (const std::size_t place : {goals.size() / 2, goals.size() - 1}) {
      const auto there =
          robot::find_posture(model, stage.rail_m, goals[place], stage.ready_rad[arm], options);
      if (!best && there.reach == robot::Reach::reached) starts.push_back(there.q_rad);
    }
    for (const JointVector& start : starts) {
      const auto followed = robot::follow(model, stage.rail_m, goals, start, options);
      if (!followed) {
        if (!best) best = tl::unexpected(followed.error());
        continue;
      }
      consider(followed->front().q_rad);
      if (least_bad > -own_side_m) consider(tightest(model, *followed));
      if (least_bad <= -own_side_m) break;
    }
    if (least_bad <= -own_side_m) break;
  }
  if (best) best->air_s = time_of_way_s(pose_of(stage, from.over), way);
  return best;
}

}  // namespace tuina::session
