// SPDX-License-Identifier: Apache-2.0
#include "tuina/link/wire.hpp"

#include <zlib.h>

#include <algorithm>

namespace tuina::link::wire {
namespace {

Joints pack(const JointVector& vector) noexcept {
  Joints joints{.count = static_cast<std::int32_t>(vector.size())};
  std::copy_n(vector.data(), vector.size(), joints.of.begin());
  return joints;
}

JointVector unpack(const Joints& joints) noexcept {
  const bool possible = joints.count >= 0 && joints.count <= max_joints;
  JointVector vector(possible ? joints.count : 0);
  std::copy_n(joints.of.begin(), vector.size(), vector.data());
  return vector;
}

std::array<double, 3> pack(const Vector3& vector) noexcept {
  return {vector.x(), vector.y(), vector.z()};
}

Vector3 unpack(const std::array<double, 3>& numbers) noexcept {
  return {numbers[0], numbers[1], numbers[2]};
}

}  // namespace

SensorFrame to_frame(const robot::RobotReading& reading) noexcept {
  SensorFrame frame{.tick = reading.tick, .time_s = reading.time_s, .rail_m = reading.rail_m};
  for (std::size_t i = 0; i < 2; ++i) {
    const robot::ArmReading& arm = reading.arms.of[i];
    const Vector3& force = arm.wrench_in_tool.force_n;
    const Vector3& torque = arm.wrench_in_tool.torque_nm;
    frame.arms[i] = {
        .q_rad = pack(arm.q_rad),
        .dq_rad_per_s = pack(arm.dq_rad_per_s),
        .wrench_in_tool = {force.x(), force.y(), force.z(), torque.x(), torque.y(), torque.z()},
        .wrench_time_s = arm.wrench_time_s,
        .command_age = arm.command_age,
        .measured_torque_nm = pack(arm.measured_torque_nm)};
  }
  return frame;
}

robot::RobotReading from_frame(const SensorFrame& frame) noexcept {
  robot::RobotReading reading{
      .time_s = frame.time_s, .tick = frame.tick, .rail_m = frame.rail_m, .arms = {}};
  for (std::size_t i = 0; i < 2; ++i) {
    const SensorArm& arm = frame.arms[i];
    const auto& six = arm.wrench_in_tool;
    reading.arms.of[i] = {.q_rad = unpack(arm.q_rad),
                          .dq_rad_per_s = unpack(arm.dq_rad_per_s),
                          .wrench_in_tool = {{six[0], six[1], six[2]}, {six[3], six[4], six[5]}},
                          .wrench_time_s = arm.wrench_time_s,
                          .command_age = arm.command_age,
                          .measured_torque_nm = unpack(arm.measured_torque_nm)};
  }
  return reading;
}

StandFrame to_frame(const robot::ReadyPose& pose, std::uint64_t number) noexcept {
  return {.number = number,
          .rail_m = pose.rail_m,
          .q_rad = {pack(pose.q_rad[Arm::left]), pack(pose.q_rad[Arm::right])}};
}

robot::ReadyPose from_frame(const StandFrame& frame) noexcept {
  return {.q_rad = {.of = {unpack(frame.q_rad[0]), unpack(frame.q_rad[1])}},
          .rail_m = frame.rail_m};
}

ProposalFrame to_frame(const safety::RobotProposal& proposal, std::uint64_t answers_tick,
                       bool stop_asked) noexcept {
  ProposalFrame frame{.answers_tick = answers_tick,
                      .rail_m = proposal.rail_m,
                      .stop_asked = static_cast<std::uint8_t>(stop_asked)};
  for (std::size_t i = 0; i < 2; ++i) {
    const safety::Proposal& arm = proposal.arms.of[i];
    frame.arms[i] = {.torque_nm = pack(arm.torque_nm),
                     .normal_in_base = pack(arm.normal_in_base),
                     .virtual_target_in_base = pack(arm.virtual_target_in_base),
                     .set_force_n = arm.set_force_n,
                     .stiffness_n_per_m = arm.stiffness_n_per_m,
                     .phase = static_cast<std::uint8_t>(arm.phase),
                     .zone = static_cast<std::uint8_t>(arm.zone)};
  }
  return frame;
}

safety::RobotProposal from_frame(const ProposalFrame& frame) noexcept {
  safety::RobotProposal proposal{.arms = {}, .rail_m = frame.rail_m};
  for (std::size_t i = 0; i < 2; ++i) {
    const ProposedArm& arm = frame.arms[i];
    proposal.arms.of[i] = {.torque_nm = unpack(arm.torque_nm),
                           .phase = static_cast<safety::Phase>(arm.phase),
                           .zone = static_cast<safety::Zone>(arm.zone),
                           .set_force_n = arm.set_force_n,
                           .normal_in_base = unpack(arm.normal_in_base),
                           .virtual_target_in_base = unpack(arm.virtual_target_in_base),
                           .stiffness_n_per_m = arm.stiffness_n_per_m};
  }
  return proposal;
}

DriveFrame to_frame(const safety::RobotVerdict& verdict, std::uint64_t answers_tick) noexcept {
  DriveFrame frame{.answers_tick = answers_tick, .rail_m = verdict.command.rail_m};
  for (const Arm arm : both_arms) {
    const safety::Verdict& one = verdict.arms[arm];
    frame.arms[static_cast<std::size_t>(arm)] = {
        .torque_nm = pack(verdict.command.torque_nm[arm]),
        .brake = static_cast<std::uint8_t>(verdict.command.brake[arm]),
        .action = static_cast<std::uint8_t>(one.action),
        .cause = static_cast<std::uint8_t>(one.cause),
        .latched = static_cast<std::uint8_t>(one.latched)};
  }
  return frame;
}

safety::RobotVerdict from_frame(const DriveFrame& frame) noexcept {
  safety::RobotVerdict verdict;
  verdict.command.rail_m = frame.rail_m;
  for (const Arm arm : both_arms) {
    const DrivenArm& one = frame.arms[static_cast<std::size_t>(arm)];
    verdict.command.torque_nm[arm] = unpack(one.torque_nm);
    verdict.command.brake[arm] = one.brake != 0;
    verdict.arms[arm] = {.allowed_nm = verdict.command.torque_nm[arm],
                         .action = static_cast<safety::Action>(std::min(
                             one.action, static_cast<std::uint8_t>(safety::Action::brake))),
                         .cause = static_cast<safety::Cause>(std::min(
                             one.cause, static_cast<std::uint8_t>(safety::Cause::guard_silent))),
                         .latched = one.latched != 0};
  }
  return verdict;
}

std::uint32_t crc_of(const std::byte* bytes, std::size_t size) noexcept {
  return static_cast<std::uint32_t>(
      crc32_z(0, reinterpret_cast<const unsigned char*>(bytes), size));
}

}  // namespace tuina::link::wire
