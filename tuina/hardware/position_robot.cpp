// SPDX-License-Identifier: Apache-2.0
#include "tuina/hardware/position_robot.hpp"

#include <algorithm>
#include <cmath>

namespace tuina::hardware {
namespace {

// Differences within a motion tell only how well the arms' lag is known, and neither controller nor
// guard should answer to them. What lasts this long is a real difference.
constexpr double lasting_s = 0.5;
constexpr int far_away_ticks = 5;
// Drives that were believed are so until the wrist feels all but this of what they press with.
constexpr double felt_again_n = 5.0;

/// What drives press with along the shaft of the tool beyond all that friction may bear. Of the
/// forces at a tool that hold such torques it is the one which leaves the arm unaccelerated
/// [khatib1987].
double pressing_n(const robot::ArmModel& model, const robot::ArmDynamics& dynamics,
                  const JointVector& dq_rad_per_s, const JointVector& driven_nm) noexcept {
  const Vector3 inward = dynamics.base_from_tool.linear().col(0);
  const JointVector lever = dynamics.jacobian.topRows<3>().transpose() * inward;
  const JointVector yields = robot::acceleration(dynamics.mass_kg_m2, lever);
  const double mobility_per_kg = lever.dot(yields);
  if (!(mobility_per_kg > 0.0)) return 0.0;
  const JointVector net_nm = driven_nm - dynamics.coriolis_nm - dynamics.gravity_nm;
  double friction_n = 0.0;
  for (Eigen::Index i = 0; i < yields.size(); ++i) {
    const robot::Link& link = model.table().links[static_cast<std::size_t>(i)];
    friction_n += std::abs(yields[i]) *
                  (link.coulomb_nm + link.viscous_nm_s_per_rad * std::abs(dq_rad_per_s[i]));
  }
  return (yields.dot(net_nm) - friction_n) / mobility_per_kg;
}

}  // namespace

PositionRobot::PositionRobot(robot::PositionDrives& drives, const PerArm<robot::ArmModel>& models,
                             const Options& options) noexcept
    : drives_(drives),
      options_(options),
      lag_ticks_(static_cast<std::size_t>(std::clamp(std::lround(options.lag_s / control_period_s),
                                                     0L, static_cast<long>(ring_ticks) / 2L - 1L))),
      sides_{{Side(models[Arm::left]), Side(models[Arm::right])}} {}

Result<void> PositionRobot::stand_ready(const robot::ReadyPose& pose) {
  started_ = false;
  if (drives_.driven_nm() == nullptr && !options_.bounded_by_wrist_alone)
    return fail(Fault::config,
                "these arms take places and tell no torques of their drives, so that nothing but "
                "the wrist sensor bounds what they press with; give PositionDrives::driven_nm, or "
                "set `bounded_by_wrist_alone` (docs/position_arms.md)");
  return drives_.stand_ready(pose);
}

void PositionRobot::begin(const robot::RobotReading& reading) noexcept {
  started_ = answered_ = true;
  fault_ = nullptr;
  for (const Arm arm : both_arms) {
    Side& side = sides_[arm];
    const JointVector& q_rad = reading.arms[arm].q_rad;
    side.arm.stand(q_rad);
    side.sent_rad.fill(q_rad);
    side.off_rad = JointVector::Zero(q_rad.size());
    side.far_ticks = 0;
  }
}

/// Whether the joints are anywhere near where they were sent a lag ago, or half of it, or two.
bool PositionRobot::follows(const Side& side, const JointVector& q_rad) const noexcept {
  JointVector low_rad = sent(side, lag_ticks_), high_rad = low_rad;
  for (std::size_t ago = lag_ticks_ / 2; ago <= 2 * lag_ticks_; ++ago) {
    low_rad = low_rad.cwiseMin(sent(side, ago));
    high_rad = high_rad.cwiseMax(sent(side, ago));
  }
  return (low_rad - q_rad).maxCoeff() < options_.max_off_rad &&
         (q_rad - high_rad).maxCoeff() < options_.max_off_rad;
}

/// The real arm, where it would be if it were not late; tells of one that is elsewhere.
void PositionRobot::compare(Arm arm, robot::ArmReading& reading) noexcept {
  Side& side = sides_[arm];
  const JointVector& due_rad = sent(side, lag_ticks_);
  const bool known = reading.q_rad.size() == due_rad.size() && reading.q_rad.allFinite();
  const JointVector off_rad =
      known ? JointVector(reading.q_rad - due_rad) : JointVector::Zero(due_rad.size());
  side.far_ticks = known && follows(side, reading.q_rad) ? 0 : side.far_ticks + 1;
  if (side.far_ticks >= far_away_ticks && fault_ == nullptr)
    fault_ = arm == Arm::left ? "the left arm is not where it was sent"
                              : "the right arm is not where it was sent";
  const JointVector change_rad =
      control_period_s / (lasting_s + control_period_s) * (off_rad - side.off_rad);
  side.off_rad += change_rad;
  reading.q_rad = side.arm.q_rad() + side.off_rad;
  reading.dq_rad_per_s = side.arm.dq_rad_per_s() + change_rad / control_period_s;
}

/// A wrist sensor that says too little would let an arm that takes places press as hard as its
/// drives can. Where they press much harder than it feels, the reading has their force. A sensor
/// that tells of a pull speaks for itself: no body pulls, and that is to be seen.
void PositionRobot::hear_drives(Arm arm, robot::ArmReading& reading,
                                const JointVector& driven_nm) noexcept {
  Side& side = sides_[arm];
  const robot::ArmModel& model = side.arm.model();
  if (driven_nm.size() != model.joints() || reading.q_rad.size() != model.joints() ||
      reading.dq_rad_per_s.size() != model.joints())
    return;
  const auto dynamics = model.evaluate(reading.q_rad, reading.dq_rad_per_s, rail_m_);
  const Vector3 weight_n(0.0, 0.0, -model.table().tool_mass_kg * gravity_m_per_s2);
  const double weight_along_n = dynamics.base_from_tool.linear().col(0).dot(weight_n);
  const double felt_n = weight_along_n - reading.wrench_in_tool.force_n.x();
  const double unfelt_n = pressing_n(model, dynamics, reading.dq_rad_per_s, driven_nm) - felt_n;
  const double max_unfelt_n = side.drives_believed ? felt_again_n : options_.max_unfelt_n;
  side.drives_believed = unfelt_n > max_unfelt_n && felt_n > -felt_again_n;
  if (side.drives_believed) reading.wrench_in_tool.force_n.x() -= unfelt_n;
}

/// Both virtual arms stand; called where nobody has answered the last reading with a command.
void PositionRobot::stop_both() noexcept {
  for (Side& side : sides_.of) side.arm.stand(side.arm.q_rad());
}

std::optional<robot::RobotReading> PositionRobot::read() noexcept {
  auto reading = drives_.read();
  if (!reading) return reading;
  if (!started_) begin(*reading);
  if (!answered_) stop_both();
  answered_ = false;
  time_s_ = reading->time_s;
  rail_m_ = reading->rail_m;
  const PerArm<JointVector>* driven_nm = drives_.driven_nm();
  for (const Arm arm : both_arms) {
    Side& side = sides_[arm];
    // The drives move the real arm; what is commanded moves the virtual one.
    reading->arms[arm].measured_torque_nm.resize(0);
    if (driven_nm != nullptr) hear_drives(arm, reading->arms[arm], (*driven_nm)[arm]);
    side.sent_rad[next_] = side.arm.q_rad();
    side.wrench_in_tool = reading->arms[arm].wrench_in_tool;
    side.sample_time_s = reading->arms[arm].wrench_time_s;
    compare(arm, reading->arms[arm]);
  }
  next_ = (next_ + 1) % ring_ticks;
  return reading;
}

void PositionRobot::apply(const robot::RobotCommand& command) noexcept {
  answered_ = true;
  if (!started_ || fault_ != nullptr) return;
  robot::PlaceCommand wanted{.rail_m = command.rail_m};
  for (const Arm arm : both_arms) {
    Side& side = sides_[arm];
    const double age_s = time_s_ - side.sample_time_s;
    const bool felt = std::abs(age_s) <= options_.max_wrench_age_s &&
                      side.wrench_in_tool.force_n.allFinite() &&
                      side.wrench_in_tool.torque_nm.allFinite();
    if (command.brake[arm])
      side.arm.stand(side.arm.q_rad());
    else
      side.arm.step(command.torque_nm[arm], side.wrench_in_tool, felt, rail_m_);
    wanted.q_rad[arm] = side.arm.q_rad();
  }
  drives_.follow(wanted);
}

}  // namespace tuina::hardware
