// SPDX-License-Identifier: Apache-2.0
// Sensors of the simulated robot, and its rail.
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>

#include "tuina/sim/robot/plant_world.hpp"

namespace tuina::sim {
namespace {

constexpr double rail_stiffness_per_s2 = 60.0 * 60.0;  // a servo of 60 rad/s, critically damped
constexpr double rail_speed_m_per_s = 0.1;
constexpr double rail_acceleration_m_per_s2 = 0.3;

/// Share of the step response of a first-order low-pass within one step.
double low_pass_share(double cutoff_hz, double step_s) {
  return cutoff_hz > 0.0 ? 1.0 - std::exp(-2.0 * pi * cutoff_hz * step_s) : 1.0;
}

}  // namespace

void Plant::World::touch(Arm side) noexcept {
  ArmDevices& arm = arms[side];
  const Eigen::Map<const Vector3> at_in_base(data->site_xpos + 3 * arm.site);
  const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> base_from_tool(
      data->site_xmat + 9 * arm.site);
  double motion[6];  // rotation first
  mj_objectVelocity(model.get(), data.get(), mjOBJ_SITE, arm.site, motion, 0);
  const Vector3 velocity_in_base(motion[3], motion[4], motion[5]);

  Wrench on_tool_in_base;
  if (person != nullptr) {
    const Matrix3 turn = couch_from_base.linear();
    const ContactTruth& contact =
        person->touch(side, data->time, couch_from_base * at_in_base, turn * velocity_in_base);
    on_tool_in_base.force_n = turn.transpose() * contact.on_tool_in_couch.force_n;
    on_tool_in_base.torque_nm = turn.transpose() * contact.on_tool_in_couch.torque_nm;
    if (contact.force_n > 0.0) {
      mj_applyFT(model.get(), data.get(), on_tool_in_base.force_n.data(),
                 on_tool_in_base.torque_nm.data(), at_in_base.data(), arm.tool_body,
                 data->qfrc_applied);
    }
  }
  const Wrench& hand = hands[side];
  mj_applyFT(model.get(), data.get(), hand.force_n.data(), hand.torque_nm.data(), at_in_base.data(),
             arm.tool_body, data->qfrc_applied);
  // The sensor carries the tool: it measures contact, tool weight and tool inertia.
  const Vector3 acceleration = (velocity_in_base - arm.last_velocity) / step_s;
  arm.last_velocity = velocity_in_base;
  Vector6 felt;
  felt.head<3>() = base_from_tool.transpose() *
                   (on_tool_in_base.force_n +
                    arm.tool_mass_kg * (Vector3(0.0, 0.0, -gravity_m_per_s2) - acceleration));
  felt.tail<3>() = base_from_tool.transpose() * on_tool_in_base.torque_nm;
  arm.felt += low_pass_share(options.wrist_low_pass_hz, step_s) * (felt - arm.felt);
}

void Plant::World::drive_rail() noexcept {
  // The set point moves with bounded speed and acceleration; the servo follows it.
  const double left = rail_wanted_m - rail_now_m;
  const double fastest =
      std::min(rail_speed_m_per_s, std::sqrt(2.0 * rail_acceleration_m_per_s2 * std::abs(left)));
  const double change = rail_acceleration_m_per_s2 * step_s;
  rail_speed += std::clamp(std::copysign(fastest, left) - rail_speed, -change, change);
  if (std::abs(left) < 1e-6 && std::abs(rail_speed) <= change) {
    rail_speed = 0.0;
    rail_now_m = rail_wanted_m;
  }
  rail_now_m += rail_speed * step_s;
  const double rate = std::sqrt(rail_stiffness_per_s2);
  data->qfrc_applied[rail_dof] +=
      moving_kg * (rail_stiffness_per_s2 * (rail_now_m - data->qpos[rail_dof]) +
                   2.0 * rate * (rail_speed - data->qvel[rail_dof]));
}

/// A position drive with gravity compensation, like that of the rail.
void Plant::World::hold(const Held& joint) noexcept {
  const double inertia = data->qM[model->dof_Madr[joint.dof]];
  const double rate = std::sqrt(rail_stiffness_per_s2);
  double effort = data->qfrc_bias[joint.dof] +
                  inertia * (rail_stiffness_per_s2 * (joint.q - data->qpos[joint.dof]) -
                             2.0 * rate * data->qvel[joint.dof]);
  if (joint.effort_limit > 0.0)
    effort = std::clamp(effort, -joint.effort_limit, joint.effort_limit);
  data->qfrc_applied[joint.dof] += effort;
}

void Plant::World::read_encoders(ArmDevices& arm) noexcept {
  const double share = low_pass_share(options.velocity_low_pass_hz, tick_s);
  const double count = options.encoder_counts > 0.0 ? 2.0 * pi / options.encoder_counts : 0.0;
  for (std::size_t k = 0; k < static_cast<std::size_t>(arm.joints); ++k) {
    const double angle = shaft(arm, k).rad;
    const double seen = count > 0.0 ? std::round(angle / count) * count : angle;
    const double difference = (seen - arm.encoder_rad[k]) / tick_s;
    arm.velocity_rad_per_s[k] += share * (difference - arm.velocity_rad_per_s[k]);
    arm.encoder_rad[k] = seen;
  }
}

void Plant::World::spoil_wrist(ArmDevices& arm, Random& random) {
  // A torque reads as the force that has it on a lever of 5 cm, and the other way round.
  constexpr double lever_m = 0.05;
  const auto size = [](int axis) { return axis < 3 ? 1.0 : lever_m; };
  for (int i = 0; i < 6; ++i) {
    SensorAxis& axis = arm.wrist_axes[static_cast<std::size_t>(i)];
    axis.drift_per_s = uniform(random, -1.0, 1.0) * options.flaws.wrist_drift_n_per_s * size(i);
    axis.hysteresis = options.flaws.wrist_hysteresis_share;
    axis.held = arm.felt[i];
    for (int j = 0; j < 6; ++j) {
      const double share = options.flaws.wrist_crosstalk_share * uniform(random, -1.0, 1.0);
      arm.crosstalk(i, j) += share * size(i) / size(j);
    }
  }
}

Wrench Plant::World::sample_wrist(ArmDevices& arm) noexcept {
  const Vector6 late = arm.sampled;  // a sample is on the bus for one millisecond
  Vector6 lagging;
  for (int i = 0; i < 6; ++i)
    lagging[i] = arm.wrist_axes[static_cast<std::size_t>(i)].lag(arm.felt[i]);
  const Vector6 mixed = arm.crosstalk * lagging;
  for (int i = 0; i < 3; ++i) {
    arm.sampled[i] = mixed[i] + gaussian(noise, options.wrist_noise_n);
    arm.sampled[i + 3] = mixed[i + 3] + gaussian(noise, options.wrist_noise_nm);
  }
  for (int i = 0; i < 6; ++i)
    arm.sampled[i] += arm.wrist_axes[static_cast<std::size_t>(i)].drift_per_s * data->time;
  return {late.head<3>(), late.tail<3>()};
}

void Plant::World::spoil_currents() {
  current_noise = make_random(options.seed, "noise of currents");
  Random random = make_random(options.seed, "errors of currents");
  for (ArmDevices& arm : arms.of) {
    for (std::size_t k = 0; k < static_cast<std::size_t>(arm.joints); ++k) {
      arm.current_scale[k] = 1.0 + options.current_scale_share * uniform(random, -1.0, 1.0);
      arm.current_offset_nm[k] =
          options.current_offset_share * arm.torque_limit_nm[k] * uniform(random, -1.0, 1.0);
    }
  }
}

/// The current of a motor is known after its filter, whatever the motor makes of it.
void Plant::World::flow(ArmDevices& arm, std::size_t joint, double motor_nm) noexcept {
  const double share =
      arm.current_known ? low_pass_share(options.current_low_pass_hz, step_s) : 1.0;
  arm.current_nm[joint] += share * (motor_nm - arm.current_nm[joint]);
}

JointVector Plant::World::measure_currents(const ArmDevices& arm) noexcept {
  JointVector measured_nm(options.drives_tell && arm.current_known ? arm.joints : 0);
  for (Eigen::Index i = 0; i < measured_nm.size(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double noise_nm = options.current_noise_share * arm.torque_limit_nm[k];
    measured_nm[i] = arm.current_scale[k] * arm.current_nm[k] + arm.current_offset_nm[k] +
                     gaussian(current_noise, noise_nm);
  }
  return measured_nm;
}

}  // namespace tuina::sim
