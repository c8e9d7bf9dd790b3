// SPDX-License-Identifier: Apache-2.0
#include "apps/simulated/play_motion.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "apps/cli/asked_to_end.hpp"
#include "apps/simulated/session_order.hpp"
#include "tuina/control/cartesian_impedance.hpp"
#include "tuina/control/friction.hpp"
#include "tuina/robot/ready_posture.hpp"

namespace tuina::app {

Result<PlayedMotion> play_motion(const session::TaughtMotion& motion, const std::string& name,
                                 const session::Config& config, const CommonOptions& common,
                                 const std::string& device) {
  const auto person = sim::parse_person(name, motion.position, common.seed);
  if (!person) return tl::unexpected(person.error());
  const auto robot = robot::load_robot(motion.robot);
  if (!robot) return tl::unexpected(robot.error());
  const robot::RobotPlacement placement =
      robot::place_robot(*robot, motion.position, session::head_at_plus_y(person->acupoints));
  const robot::ArmTable& table = placement.arm;
  robot::ReadyPose start{.q_rad = robot::ready_posture(table, placement.mount),
                         .rail_m = motion.rail_m};
  start.q_rad[motion.arm] = motion.samples.front().q_rad;
  auto made =
      TeachingStage::make(*person, placement, start, config, common.seed, {device, motion.robot});
  if (!made) return tl::unexpected(made.error());
  TeachingStage& stage = **made;
  const robot::ArmModel& model = stage.models[motion.arm];
  const JointVector stiffness = JointVector::Constant(model.joints(), 200.0);
  const JointVector still = JointVector::Zero(model.joints());
  control::FrictionCompensation friction(table, {});
  friction.start(start.q_rad[motion.arm]);

  const double cap_n = safety::ceiling_of(motion.zone).set_n;
  PlayedMotion played;
  double way2 = 0.0, force2 = 0.0;
  constexpr double settle_s = 0.5;
  double stopped_s = -1.0;
  const Progress bar = progress_bar(common, "play");
  // Once it is stopped, the motion stands still where it was: it does not touch down anew.
  const auto wanted_at = [&](double time_s) {
    if (stopped_s < 0.0) return motion.at(time_s);
    auto wanted = motion.at(stopped_s - settle_s);
    wanted.dq_rad_per_s.setZero();
    return wanted;
  };
  // What the arm that plays proposes.
  const auto play = [&](const robot::RobotReading& reading, double time_s) -> safety::Proposal {
    session::ControlledArm& one = stage.arms[motion.arm];
    const auto wanted = wanted_at(time_s);
    const robot::ArmDynamics dynamics =
        model.evaluate(one.state.q_rad, one.state.dq_rad_per_s, reading.rail_m);
    const Vector3 out = control::tool_normal(dynamics.base_from_tool);
    const JointVector lever = dynamics.jacobian.topRows<3>().transpose() * out;
    // Where the skin has pushed back, the joints alone would press too little: the force that was
    // felt is given along.
    const double press_n = std::clamp(wanted.force_n, 0.0, cap_n);
    const JointVector torque =
        control::joint_impedance_torque(dynamics, one.state.q_rad, one.state.dq_rad_per_s,
                                        wanted.q_rad, wanted.dq_rad_per_s, still, stiffness, 0.8) -
        press_n * lever + dynamics.gravity_nm + dynamics.coriolis_nm +
        friction.step(one.state.q_rad);
    // The springs of the joints, seen along the tool's axis.
    const double n_per_m = 1.0 / lever.cwiseAbs2().cwiseQuotient(stiffness).sum();
    const bool skin = wanted.force_n > 0.5 || one.state.contact_in_base.force_n.norm() > 1.5;
    return {
        .torque_nm = torque,
        .phase = skin ? safety::Phase::contact : safety::Phase::free,
        .zone = motion.zone,
        .set_force_n = press_n,
        .normal_in_base = out,
        .virtual_target_in_base = model.base_from_tool(wanted.q_rad, reading.rail_m).translation(),
        .stiffness_n_per_m = n_per_m};
  };
  // How well it plays, against the truth.
  const auto judge = [&](double time_s) {
    const auto wanted = wanted_at(time_s);
    TeachRow row = stage.row(motion.arm, time_s);
    const Transform there = model.base_from_tool(wanted.q_rad, motion.rail_m);
    const Vector3 led_to =
        stage.mount().base_from_couch.inverse() *
        (there.translation() - model.table().tool_radius_m * control::tool_normal(there));
    way2 += (row.tool_in_couch - led_to).squaredNorm();
    if (wanted.force_n > 0.5) {
      force2 += std::pow(row.true_force_n - wanted.force_n, 2);
      played.contact_s += control_period_s;
    }
    played.peak_n = std::max(played.peak_n, row.true_force_n);
    played.truth.push_back(row);
  };
  const auto propose =
      [&](const robot::RobotReading& reading) -> std::optional<safety::RobotProposal> {
    const double time_s = reading.time_s - settle_s;
    if (time_s > motion.duration_s() + 0.5) return std::nullopt;
    if (stopped_s >= 0.0 && reading.time_s > stopped_s + 1.5) return std::nullopt;
    if (bar && reading.tick % 100 == 0) bar(std::clamp(time_s / motion.duration_s(), 0.0, 1.0));
    stage.hear(reading);
    safety::RobotProposal wanted{.rail_m = motion.rail_m};
    for (const Arm side : both_arms) {
      session::ControlledArm& one = stage.arms[side];
      one.sense(reading, side);
      wanted.arms[side] =
          side == motion.arm ? play(reading, time_s) : one.propose(reading, safety::Zone::denied);
    }
    if (time_s >= 0.0) judge(time_s);
    return wanted;
  };
  const auto look = [&](const robot::RobotReading& reading, const safety::RobotVerdict& verdict) {
    for (const safety::Verdict& one : verdict.arms.of) {
      if (stopped_s >= 0.0 || !one.latched) continue;
      stopped_s = reading.time_s;
      played.stop = safety::name_of(one.cause);
    }
    if (stopped_s < 0.0 && asked_to_end()) {
      stage.guard().expect_stop();  // it lifts an arm that presses away
      stopped_s = reading.time_s;
      played.stop = safety::name_of(safety::Cause::asked_to);
    }
    return true;
  };
  if (auto driven = session::run_control_loop(stage.robot(), stage.guard(), propose, look); !driven)
    return tl::unexpected(driven.error());
  if (bar) bar(1.0);
  const auto rms = [](double sum, double count) {
    return count > 0.0 ? std::sqrt(sum / count) : std::numeric_limits<double>::quiet_NaN();
  };
  played.tracking_rms_m = rms(way2, static_cast<double>(played.truth.size()));
  played.force_rmse_n = rms(force2, played.contact_s / control_period_s);
  return played;
}

std::string PlayedMotion::force() const {
  if (std::isnan(force_rmse_n)) return fmt::format("no force was taught, {:.1f} N at most", peak_n);
  return fmt::format("force {:.1f} N RMS from what was taught, {:.1f} N at most", force_rmse_n,
                     peak_n);
}

}  // namespace tuina::app
