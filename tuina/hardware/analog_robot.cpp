// SPDX-License-Identifier: Apache-2.0
#include "tuina/hardware/analog_robot.hpp"

#include <algorithm>
#include <cmath>
#include <thread>

#include "tuina/core/units.hpp"

namespace tuina::hardware {
namespace {

using namespace std::chrono_literals;

constexpr auto analog_cycle = 1ms;
constexpr int max_unread = 3;  // cycles in a row
constexpr double max_volts = 10.0;
constexpr double approach_rad_per_s = 15_deg, max_standing_off_rad = 1_deg;
constexpr int calming_cycles = 500;
// By springs of 40 rad/s, friction of 2.5 Nm leaves a joint of 0.15 kg m2 at 0.6 degrees.
constexpr double spring_rad_per_s = 40.0, spring_damping = 0.9;

}  // namespace

AnalogRobot::AnalogRobot(DacEncoder& card, const PerArm<std::vector<AnalogJoint>>& joints,
                         const robot::ArmTable& table, const robot::RobotMount& mount, Clock clock)
    : card_(card), joints_(joints), models_(robot::both_models(table, mount)), clock_(clock) {
  now_.rail_m = mount.min_rail_m;
  for (const Arm arm : both_arms) {
    channels_ += joints[arm].size();
    now_.arms[arm].q_rad = now_.arms[arm].dq_rad_per_s = JointVector::Zero(table.joints);
  }
}

Result<std::unique_ptr<AnalogRobot>> AnalogRobot::open(
    DacEncoder& card, const PerArm<std::vector<AnalogJoint>>& joints, const robot::ArmTable& table,
    const robot::RobotMount& mount, Clock clock) {
  if (mount.max_rail_m > mount.min_rail_m)
    return fail(
        Fault::config,
        "a card of joints has no linear base, and the table's goes from {:.0f} to {:.0f} mm",
        to_mm(mount.min_rail_m), to_mm(mount.max_rail_m));
  for (const Arm arm : both_arms) {
    if (joints[arm].size() != static_cast<std::size_t>(table.joints))
      return fail(Fault::config, "the {} arm has {} joints on the card, the table has {}",
                  name_of(arm), joints[arm].size(), table.joints);
    for (std::size_t i = 0; i < joints[arm].size(); ++i) {
      const AnalogJoint& joint = joints[arm][i];
      const double volts = std::abs(joint.volts_per_nm) * table.links[i].torque_limit_nm;
      if (volts > 0.0 && volts <= max_volts && std::isnormal(joint.counts_per_rad)) continue;
      return fail(
          Fault::config,
          "the {} {} has {:g} V a newton metre and {:g} counts a radian; for the {} Nm of the "
          "table it needs more than 0 V, 10 V at the most, and counts",
          name_of(arm), table.links[i].name, joint.volts_per_nm, joint.counts_per_rad,
          table.links[i].torque_limit_nm);
    }
  }
  return std::unique_ptr<AnalogRobot>(new AnalogRobot(card, joints, table, mount, clock));
}

AnalogRobot::~AnalogRobot() {
  if (standing_) brake();
}

void AnalogRobot::brake() noexcept {
  volts_ = {};
  card_.write({volts_.data(), channels_}, {.of = {false, false}});
}

/// How many milliseconds have passed since the one before.
std::int64_t AnalogRobot::wait_for_cycle() noexcept {
  using std::chrono::steady_clock;
  if (!next_) next_ = steady_clock::now();
  if (clock_ == Clock::card) return 1;
  std::this_thread::sleep_until(*next_);
  const std::int64_t passed = 1 + (steady_clock::now() - *next_) / analog_cycle;
  *next_ += passed * analog_cycle;
  return passed;
}

std::optional<robot::RobotReading> AnalogRobot::read() noexcept {
  if (!standing_ || fault_ != nullptr) return std::nullopt;
  const bool anew = !next_;
  now_.tick += static_cast<std::uint64_t>(wait_for_cycle());
  const double time_s = control_period_s * static_cast<double>(now_.tick);
  if (!card_.read({counts_.data(), channels_})) {
    if (++unread_in_row_ < max_unread) return std::nullopt;
    fault_ = "the card gives no counts";
    brake();
    return std::nullopt;
  }
  unread_in_row_ = 0;
  std::size_t channel = 0;
  for (const Arm arm : both_arms) {
    robot::ArmReading& told = now_.arms[arm];
    for (std::size_t i = 0; i < joints_[arm].size(); ++i, ++channel) {
      const AnalogJoint& joint = joints_[arm][i];
      const double q_rad =
          static_cast<double>(counts_.at(channel) - joint.zero_count) / joint.counts_per_rad;
      const auto row = static_cast<Eigen::Index>(i);
      told.dq_rad_per_s[row] = anew ? 0.0 : (q_rad - told.q_rad[row]) / (time_s - now_.time_s);
      told.q_rad[row] = q_rad;
    }
  }
  now_.time_s = time_s;
  return now_;
}

void AnalogRobot::apply(const robot::RobotCommand& command) noexcept {
  if (!standing_ || fault_ != nullptr) return;
  PerArm<bool> powered = {};
  std::size_t channel = 0;
  for (const Arm arm : both_arms) {
    powered[arm] = !command.brake[arm];
    if (!command.torque_nm[arm].allFinite()) fault_ = "a torque was ordered that is no number";
    for (std::size_t i = 0; i < joints_[arm].size(); ++i, ++channel) {
      const double limit_nm = models_[arm].table().links[i].torque_limit_nm;
      const double torque_nm = command.torque_nm[arm][static_cast<Eigen::Index>(i)];
      volts_.at(channel) =
          powered[arm] ? joints_[arm][i].volts_per_nm * std::clamp(torque_nm, -limit_nm, limit_nm)
                       : 0.0;
    }
  }
  if (fault_ != nullptr) return brake();
  card_.write({volts_.data(), channels_}, powered);
}

/// Each joint by itself hangs on a spring as stiff as its own inertia asks for.
robot::RobotCommand AnalogRobot::spring_to(const PerArm<JointVector>& q_rad) const noexcept {
  robot::RobotCommand command{.rail_m = now_.rail_m};
  for (const Arm arm : both_arms) {
    const robot::ArmReading& told = now_.arms[arm];
    const auto dynamics = models_[arm].evaluate(told.q_rad, told.dq_rad_per_s, now_.rail_m);
    const JointVector wanted = spring_rad_per_s * spring_rad_per_s * (q_rad[arm] - told.q_rad) -
                               2.0 * spring_damping * spring_rad_per_s * told.dq_rad_per_s;
    command.torque_nm[arm] = dynamics.gravity_nm + dynamics.mass_kg_m2 * wanted;
  }
  return command;
}

Result<void> AnalogRobot::move_to(const PerArm<JointVector>& q_rad) {
  PerArm<JointVector> from;
  double farthest_rad = 0.0;
  for (const Arm arm : both_arms) {
    from[arm] = now_.arms[arm].q_rad;
    farthest_rad = std::max(farthest_rad, (q_rad[arm] - from[arm]).cwiseAbs().maxCoeff());
  }
  const double duration_s = std::max(1.5 * farthest_rad / approach_rad_per_s, control_period_s);
  const double begun_s = now_.time_s;
  while (now_.time_s < begun_s + duration_s + calming_cycles * control_period_s) {
    if (!read() && fault_ != nullptr) return fail(Fault::device, "{}", fault_);
    const double s = std::min(1.0, (now_.time_s - begun_s) / duration_s);
    const double share = s * s * (3.0 - 2.0 * s);
    PerArm<JointVector> place;
    for (const Arm arm : both_arms) place[arm] = from[arm] + share * (q_rad[arm] - from[arm]);
    apply(spring_to(place));
  }
  return {};
}

Result<void> AnalogRobot::stand_ready(const robot::ReadyPose& pose) {
  if (standing_) return {};
  standing_ = true;
  for (int i = 0; i < max_unread && !read();) ++i;
  if (fault_ != nullptr) return fail(Fault::device, "{}", fault_);
  auto moved = move_to(pose.q_rad);
  brake();
  next_.reset();
  if (!moved) return moved;
  for (const Arm arm : both_arms) {
    const double off_rad = (now_.arms[arm].q_rad - pose.q_rad[arm]).cwiseAbs().maxCoeff();
    if (off_rad > max_standing_off_rad)
      return fail(Fault::device,
                  "a joint of the {} arm stands {:.1f} deg from where it is to be ready",
                  name_of(arm), to_deg(off_rad));
  }
  return {};
}

}  // namespace tuina::hardware
