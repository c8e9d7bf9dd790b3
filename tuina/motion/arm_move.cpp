// SPDX-License-Identifier: Apache-2.0
#include "tuina/motion/arm_move.hpp"

#include <algorithm>
#include <array>
#include <limits>

#include "tuina/control/cartesian_impedance.hpp"
#include "tuina/motion/configuration_choice.hpp"
#include "tuina/motion/startle.hpp"

namespace tuina::motion {
namespace {

constexpr double checked_every_s = 0.1;
// Shares of the posture error that a slow nullspace and a quick one make up in a step; friction
// decides which the real arm is.
constexpr std::array posture_shares = {0.05, 0.3};
// A larger difference is another branch of the inverse kinematics.
constexpr double max_posture_error_rad = 0.35;
constexpr double max_limit_excess_rad = 1_deg;
constexpr double max_tool_error_m = 5_mm;
constexpr double min_elbow_height_m = 60_mm;  // minimum height above the skin

ArmRest rest(const Stage& stage, Arm arm, const ApproachPose& over, const JointVector& q_rad) {
  ArmRest rest{.over = over,
               .q_rad = q_rad,
               .parked = false,
               .stay = {},
               .weak_springs_rad = {q_rad, q_rad}};
  rest.stay.q_rad = {q_rad};
  rest.stay.poses = {stage.models.get()[arm].kinematics(q_rad, stage.rail_m)};
  return rest;
}

robot::Clearances clear_of(const Stage& stage, Arm arm, const JointPath& joint_path) {
  robot::Clearances nearest;
  for (const auto& pose : joint_path.poses) {
    nearest.take_least(
        robot::clearances(stage.models.get()[arm], pose, stage.rail_m, stage.obstacles));
  }
  return nearest;
}

ApproachPose tool_approach_pose(const Stage& stage, Arm arm, const JointVector& q_rad) {
  const Transform tool = stage.models.get()[arm].base_from_tool(q_rad, stage.rail_m);
  const control::ToolPose tip =
      control::tip_pose(tool, stage.models.get()[arm].table().tool_radius_m);
  return {.at_in_couch = stage.base_from_couch.inverse() * tip.at_in_base,
          .normal_in_couch = stage.base_from_couch.linear().transpose() * tip.normal_in_base};
}

control::ToolPose pose_of(const Stage& stage, const ApproachPose& approach) {
  return {.at_in_base = stage.base_from_couch * approach.at_in_couch,
          .normal_in_base = stage.base_from_couch.linear() * approach.normal_in_couch};
}

/// Rolls out a move twice, with a slow nullspace and with a quick one.
void roll_out(const Stage& stage, Arm arm, const ArmRest& from, ArmMove& move,
              const std::vector<robot::ContactGoal>& goals, const ApproachPose& above,
              const ApproachPose& after) {
  JointPath above_either, after_either;  // end configurations of the slow and the quick rollout
  const auto add = [&](JointPath& stay, const JointVector& q_rad) {
    stay.q_rad.push_back(q_rad);
    stay.poses.push_back(stage.models.get()[arm].kinematics(q_rad, stage.rail_m));
  };
  for (const double posture_share : posture_shares) {
    Rollout rollout(stage.models.get()[arm], stage.rail_m, from.q_rad, posture_share);
    for (const control::ToolPose& pose : move.waypoints_in_base) {
      rollout.transfer(pose, move.posture_rad, move.transfer);
      // A lag on a leg is made up at its end, unless the arm is stuck.
      move.transfer.tool_error_m = std::max(move.transfer.tool_error_m, rollout.tool_error_m());
    }
    move.above = move.after = rest(stage, arm, above, rollout.q_rad());
    add(above_either, rollout.q_rad());
    if (goals.empty()) continue;
    rollout.slide(goals, move.posture_rad, move.contact);
    rollout.settle(move.posture_rad, move.contact);
    rollout.transfer(pose_of(stage, after), move.posture_rad, move.contact);
    move.after = rest(stage, arm, after, rollout.q_rad());
    add(after_either, rollout.q_rad());
  }
  move.after.stay = goals.empty() ? above_either : after_either;
  move.above.stay = std::move(above_either);
  move.clear = clear_of(stage, arm, move.transfer);
  move.clear.take_least(clear_of(stage, arm, move.contact));
  move.mass_kg = max_apparent_mass_kg(stage.models.get()[arm], stage.rail_m, move.contact);
}

double clear_m(const Stage& stage) {
  return 0.75 * stage.standoff_m;
}

/// True when the arm ends in another branch of the inverse kinematics (wrist flipped): the moves
/// after it were planned for this one.
bool misses_configuration(const ArmMove& move) {
  const auto near = [&](const JointVector& q_rad) {
    return (q_rad - move.posture_rad).cwiseAbs().maxCoeff() <= max_posture_error_rad;
  };
  return !near(move.above.q_rad) &&
         std::none_of(move.contact.q_rad.begin(), move.contact.q_rad.end(), near);
}

/// Cost of a move (m): past the midline, at a joint limit, low dexterity, felt as heavy by the
/// person, tight clearance.
double move_cost_m(const Stage& stage, Arm arm, const ArmMove& move) {
  const robot::ArmModel& model = stage.models.get()[arm];
  const double inward_m =
      std::max(move.transfer.inward_m(model, arm), move.contact.inward_m(model, arm));
  const double limit_excess_rad =
      std::max(move.transfer.limit_excess_rad, move.contact.limit_excess_rad);
  double dexterity_m = 0.0;
  for (const auto& pose : move.contact.poses)
    dexterity_m = std::max(dexterity_m, dexterity_cost_m(pose));
  const double tight_m = std::max(0.0, wanted_arm_distance_m - move.clear.min_m());
  return std::max(inward_m, -own_side_m) + dexterity_m + tight_m + mass_cost_m(move.mass_kg) +
         (limit_excess_rad > max_limit_excess_rad ? 0.5 : 0.0);
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
  ArmRest ready = rest(stage, arm, tool_approach_pose(stage, arm, ready_rad), ready_rad);
  ready.parked = true;
  return ready;
}

ArmMove move_home(const Stage& stage, Arm arm, const ArmRest& from) {
  const ApproachPose home = tool_approach_pose(stage, arm, stage.ready_rad[arm]);
  ArmMove move{.waypoints_in_base =
                   free_path(stage.back, from.over, home, clear_m(stage), stage.base_from_couch),
               .posture_rad = stage.ready_rad[arm]};
  move.transfer_s = transfer_time_s(pose_of(stage, from.over), move.waypoints_in_base);
  roll_out(stage, arm, from, move, {}, home, home);
  // A session waits before the next path until the springs have brought the arm home.
  for (ArmRest* rest : {&move.above, &move.after}) {
    rest->parked = true;
    rest->weak_springs_rad = {stage.ready_rad[arm], stage.ready_rad[arm]};
  }
  return move;
}

bool gets_there(const ArmMove& move) {
  return move.transfer.tool_error_m <= max_tool_error_m &&
         move.clear.min_m() >= closest_arm_distance_m;
}

bool comes_home(const Stage& stage, Arm arm, const ArmMove& home) {
  const double missed_rad = (home.after.q_rad - stage.ready_rad[arm]).cwiseAbs().maxCoeff();
  return gets_there(home) && missed_rad <= max_posture_error_rad;
}

ArmMove move_aside(const Stage& stage, Arm arm, const ArmRest& from, const Vector3& by_in_couch) {
  const ApproachPose there = {.at_in_couch = from.over.at_in_couch + by_in_couch,
                              .normal_in_couch = from.over.normal_in_couch};
  ArmMove move{.waypoints_in_base =
                   free_path(stage.back, from.over, there, clear_m(stage), stage.base_from_couch),
               .posture_rad = from.q_rad};
  move.transfer_s = transfer_time_s(pose_of(stage, from.over), move.waypoints_in_base);
  roll_out(stage, arm, from, move, {}, there, there);
  return move;
}

/// Branch of the inverse kinematics: an arm of six joints passes from one to another through a
/// posture in which its Jacobian is singular, such as a straight wrist. 0 with more joints.
int branch_of(const Stage& stage, Arm arm, const JointVector& q_rad) {
  const robot::Jacobian jacobian = stage.models.get()[arm].kinematics(q_rad, stage.rail_m).jacobian;
  if (jacobian.cols() != 6) return 0;
  return robot::Matrix6(jacobian).determinant() > 0.0 ? 1 : -1;
}

/// What it costs (m) that an arm may come to stand elsewhere than its rehearsal says. Rolls the
/// move out with springs as weak as the controller's, which pull no harder the farther a joint is
/// off, and leaves in `move` where they end. An arm that merely lags takes another way than was
/// looked at; one that ends, or comes home, in another branch would have to be stopped.
double stray_cost_m(const Stage& stage, Arm arm, const ArmRest& from, ArmMove& move,
                    const std::vector<robot::ContactGoal>& goals) {
  constexpr double lags_rad = 1.0, lag_cost_m = 100_mm;
  constexpr double missed_home_rad = 1.5, branch_cost_m = 300_mm;
  constexpr int until_springs_have_done = 60;
  const JointVector& ready_rad = stage.ready_rad[arm];
  const ApproachPose home = tool_approach_pose(stage, arm, ready_rad);
  const auto way_home =
      free_path(stage.back, move.after.over, home, clear_m(stage), stage.base_from_couch);
  double cost_m = 0.0;
  for (std::size_t i = 0; i < posture_shares.size(); ++i) {
    Rollout rollout(stage.models.get()[arm], stage.rail_m, from.weak_springs_rad[i],
                    posture_shares[i], control::PostureGains{}.max_error_rad);
    JointPath passed;
    for (const control::ToolPose& pose : move.waypoints_in_base)
      rollout.transfer(pose, move.posture_rad, passed);
    rollout.slide(goals, move.posture_rad, passed);
    rollout.settle(move.posture_rad, passed);
    rollout.transfer(pose_of(stage, move.after.over), move.posture_rad, passed);
    const JointVector after_rad = rollout.q_rad();
    move.after.weak_springs_rad[i] = after_rad;
    for (const control::ToolPose& pose : way_home) rollout.transfer(pose, ready_rad, passed);
    rollout.settle(ready_rad, passed, until_springs_have_done);
    const bool misses_home = (rollout.q_rad() - ready_rad).cwiseAbs().maxCoeff() > missed_home_rad;
    if (misses_home ||
        branch_of(stage, arm, after_rad) != branch_of(stage, arm, move.after.q_rad)) {
      cost_m = std::max(cost_m, branch_cost_m);
    } else if ((after_rad - move.after.q_rad).cwiseAbs().maxCoeff() > lags_rad) {
      cost_m = std::max(cost_m, lag_cost_m);
    }
  }
  return cost_m;
}

Result<ArmMove> move_to_path(const Stage& stage, Arm arm, const ArmRest& from,
                             const ContactPath& path, int index) {
  constexpr std::size_t max_rollouts = 12;
  constexpr double good_enough_m = 15_mm;
  const robot::ArmModel& model = stage.models.get()[arm];
  const auto goals = goals_of(path, stage.base_from_couch);
  const ApproachPose above = approach_pose(path.points.front(), stage.standoff_m);
  const ApproachPose after = approach_pose(path.points.back(), stage.standoff_m);
  const auto way = free_path(stage.back, from.over, above, clear_m(stage), stage.base_from_couch);

  Rollout arrival(model, stage.rail_m, from.q_rad, 0.05);
  JointPath transferred;
  for (const control::ToolPose& pose : way)
    arrival.transfer(pose, stage.ready_rad[arm], transferred);
  const ConfigurationChoice choice =
      choose_configurations(model, arm, stage.rail_m, goals, stage.ready_rad[arm], arrival.q_rad());

  Result<ArmMove> best = fail(Fault::not_found, "no posture of the arm suits it");
  double min_cost = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < std::min(choice.configurations_rad.size(), max_rollouts); ++i) {
    ArmMove move{
        .path = index, .waypoints_in_base = way, .posture_rad = choice.configurations_rad[i]};
    roll_out(stage, arm, from, move, goals, above, after);
    const double cost_m = move_cost_m(stage, arm, move);
    if (best && cost_m >= min_cost)
      continue;  // the return home is expensive to roll out, so it is checked last
    const double tool_error_m = std::max(move.transfer.tool_error_m, move.contact.tool_error_m);
    const char* wrong = tool_error_m > max_tool_error_m ? "on the way to it the arm gets stuck"
                        : move.contact.elbow_height_m < min_elbow_height_m
                            ? "the elbow would be in the person"
                        : move.clear.min_m() < closest_arm_distance_m
                            ? "the arm would come too near to the couch or to the robot's body"
                        : misses_configuration(move) ? "the arm would come there another way round"
                        : !comes_home(stage, arm, move_home(stage, arm, move.after))
                            ? "from there the arm does not find its way home"
                            : nullptr;
    if (wrong != nullptr) {
      if (!best) best = fail(Fault::not_found, "{}", wrong);
      continue;
    }
    move.stray_m = stray_cost_m(stage, arm, from, move, goals);
    const double with_stray_m = cost_m + move.stray_m;
    if (best && with_stray_m >= min_cost) continue;
    min_cost = with_stray_m;
    best = std::move(move);
    if (min_cost <= choice.min_cost_m + good_enough_m) break;
  }
  if (!best) {
    const auto followed = robot::follow(model, stage.rail_m, goals, stage.ready_rad[arm],
                                        {.press_depth_m = press_depth_m});
    if (!followed) return tl::unexpected(followed.error());
  }
  if (best) best->transfer_s = transfer_time_s(pose_of(stage, from.over), way);
  return best;
}

}  // namespace tuina::motion
