// SPDX-License-Identifier: Apache-2.0
// How the massage goes through the air: from contact to contact, and home.
#include "tuina/motion/free_path.hpp"
#include "tuina/session/massage_step.hpp"

namespace tuina::session {

void MassageStep::next_job(Side& side) noexcept {
  ++side.job;
  side.phase = ArmPhase::waiting;
}

/// What comes next was rehearsed from the posture that the arm parks in. When it
/// comes back its tool may be home long before its elbow, so the springs of the posture get time.
bool MassageStep::stands_as_planned(Side& side, Arm arm, double time_s) noexcept {
  constexpr double springs_take_s = 8.0;
  const JointVector& from_rad = job_of(side)->from_rad;
  if (from_rad.size() == 0) return true;
  Eigen::Index joint = 0;
  const double off_rad = (side.q_rad - from_rad).cwiseAbs().maxCoeff(&joint);
  if (off_rad <= parked_within_rad) {
    side.amiss_s = -1.0;
    return true;
  }
  if (side.amiss_s < 0.0) side.amiss_s = time_s;
  if (side.job > 0 && time_s - side.amiss_s < springs_take_s) return false;
  stops_.push_back({time_s, arm, safety::Cause::not_as_planned, static_cast<int>(joint), off_rad});
  let_go(time_s);
  return false;
}

/// It has arrived where it goes down for its path.
bool MassageStep::above_path(const Side& side) const noexcept {
  const motion::ArmJob* job = job_of(side);
  return side.phase == ArmPhase::travel && job != nullptr && job->path >= 0 && side.detour_at < 0 &&
         side.waypoint + 1 == job->waypoints_in_base.size() && side.controller().status().settled;
}

/// It works in this step and has not come above its path yet: both hands go down together.
bool MassageStep::on_its_way(const Side& side) const noexcept {
  const motion::ArmJob* job = job_of(side);
  const bool flies = side.phase == ArmPhase::travel || side.phase == ArmPhase::waiting;
  return flies && job != nullptr && job->path >= 0 && job->step <= step_ && !above_path(side);
}

/// One leg is flown, or something holds the arm: then it goes no further there, and what comes next
/// may be reached.
void MassageStep::end_travel(Side& side, Arm arm, double time_s) noexcept {
  const motion::ArmJob& job = *job_of(side);
  const bool arrived = side.controller().status().settled;
  side.leg_s = time_s;
  if (side.detour_at >= 0) {
    if (arrived && ++side.detour_at < side.detour_legs) {
      side.controller().move_to(side.detour[static_cast<std::size_t>(side.detour_at)]);
      return;
    }
    side.detour_at = -1;
    if (wants_scan()) {
      side.job = side.jobs.size();
      side.phase = ArmPhase::waiting;
      return;
    }
    if (!arrived || !side.again) return next_job(side);
    return begin_approach(side, arm, time_s);
  }
  if (!arrived && job.path >= 0) {
    side.contact_s = time_s;
    side.contact_fault = control::ContactFault::blocked;
    return end_contact(side, arm, time_s);
  }
  if (!arrived) return next_job(side);
  if (++side.waypoint < job.waypoints_in_base.size()) {
    side.controller().move_to(job.waypoints_in_base[side.waypoint]);
  } else if (job.path < 0) {
    next_job(side);
  } else {
    begin_approach(side, arm, time_s);
  }
}

/// After a whole path the tool is where the next way begins. After one that was cut short, or that
/// shall be done again, it flies there, lifted over what lies between.
void MassageStep::end_retract(Side& side, double time_s) noexcept {
  const massage::PlannedPath* planned = path_of(side);
  if (wants_scan()) return fly_home(side, time_s);
  if (planned == nullptr || stopped_s_ >= 0.0 || !(side.cut_short || side.again)) {
    return next_job(side);
  }
  const auto& points = base_path_of(side).points;
  const BasePoint& goal = side.again ? points.front() : points.back();
  detour(side,
         motion::above({.at_in_base = goal.at_in_base, .normal_in_base = goal.normal_in_base},
                       options_.standoff_m),
         true, time_s);
}

/// To a place, lifted no more than the back between needs, since farther out the arm may come too
/// near to its own body; down on it from above if it is on the back.
void MassageStep::detour(Side& side, const control::ToolPose& goal, bool from_above,
                         double time_s) noexcept {
  const control::ToolPose here =
      control::tip_pose(side.controller().dynamics().base_from_tool, tool_radius_m_);
  const double lifted_m = motion::lift_over_back_m((goal.at_in_base - here.at_in_base).norm());
  side.detour = {motion::above(here, lifted_m), from_above ? motion::above(goal, lifted_m) : goal,
                 goal};
  side.detour_legs = from_above ? 3 : 2;
  side.detour_at = 0;
  side.leg_s = time_s;
  side.controller().move_to(side.detour.front());
  side.phase = ArmPhase::travel;
}

void MassageStep::fly_home(Side& side, double time_s) noexcept {
  constexpr double at_home_m = 20e-3;
  const control::ToolPose here =
      control::tip_pose(side.controller().dynamics().base_from_tool, tool_radius_m_);
  if ((here.at_in_base - side.home.at_in_base).norm() < at_home_m) {
    side.job = side.jobs.size();
    side.phase = ArmPhase::waiting;
    return;
  }
  side.controller().keep_posture(side.home_rad);
  detour(side, side.home, false, time_s);
}

/// The person has moved, or gone: contacts end, and every arm goes home.
void MassageStep::leave(double time_s) noexcept {
  moved_ = true;
  for (const Arm arm : both_arms) {
    Side& side = sides_[arm];
    if (side.phase == ArmPhase::contact || side.phase == ArmPhase::approach) {
      if (side.phase == ArmPhase::approach) side.contact_s = time_s;
      side.cut_short = true;
      end_contact(side, arm, time_s);
    } else if (side.phase == ArmPhase::travel || side.phase == ArmPhase::waiting) {
      fly_home(side, time_s);
    }
  }
}

}  // namespace tuina::session
