// SPDX-License-Identifier: Apache-2.0
#include "apps/tuina/calibrate/wrist_poses.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <chrono>

#include "tuina/core/io/file.hpp"
#include "tuina/core/units.hpp"
#include "tuina/hardware/armlink_robot.hpp"
#include "tuina/hardware/device_file.hpp"
#include "tuina/hardware/wrist_sensor.hpp"
#include "tuina/robot/ready_posture.hpp"

namespace tuina::app {
namespace {

using namespace std::chrono_literals;

constexpr int poses_of_a_set = 12;
constexpr auto weighs = 500ms;

/// The mean of what the sensor says while it rests, as the tool would feel it.
Result<Wrench> weigh_once(const hardware::WristDevice& device) {
  auto sensor = hardware::WristSensor::open(device);
  if (!sensor) return tl::unexpected(sensor.error());
  const hardware::WristStream& stream = sensor->stream();
  Wrench sum;
  int count = 0;
  const auto until = std::chrono::steady_clock::now() + weighs;
  while (std::chrono::steady_clock::now() < until && stream.fault() == nullptr) {
    sensor->wait(until);
    if (!sensor->hear()) continue;
    sum.force_n += stream.in_tool().force_n;
    sum.torque_nm += stream.in_tool().torque_nm;
    ++count;
  }
  constexpr int min_samples = 50;
  if (stream.fault() != nullptr || count < min_samples)
    return fail(Fault::device, "{}: the sensor {}", device.address,
                stream.fault() != nullptr ? stream.fault() : "falls silent");
  return Wrench{.force_n = sum.force_n / count, .torque_nm = sum.torque_nm / count};
}

/// Nobody lies under the arm, so a gap that a guard would not bear is no reason to give up.
Result<Wrench> weigh(const hardware::WristDevice& device) {
  constexpr int more_tries = 2;
  auto told = weigh_once(device);
  for (int i = 0; i < more_tries && !told; ++i) told = weigh_once(device);
  return told;
}

std::string row_of(const Matrix3& base_from_tool, const Wrench& told) {
  const Eigen::Quaterniond turn(base_from_tool);
  return fmt::format("{},{},{},{},{},{},{},{},{},{}\n", turn.w(), turn.x(), turn.y(), turn.z(),
                     told.force_n.x(), told.force_n.y(), told.force_n.z(), told.torque_nm.x(),
                     told.torque_nm.y(), told.torque_nm.z());
}

}  // namespace

std::vector<JointVector> ways_to_hold(const robot::ArmModel& arm, const JointVector& from_rad,
                                      double rail_m, int count) {
  constexpr int steps = 5;
  constexpr double max_turn_rad = 75_deg, from_limit_rad = 5_deg, max_nearer_m = 20_mm;
  const Transform from = arm.base_from_tool(from_rad, rail_m);
  struct Way {
    JointVector q_rad;
    Vector3 down_in_tool;
  };
  std::vector<Way> ways;
  for (int i = 0; i < steps * steps * steps; ++i) {
    JointVector q_rad = from_rad;
    for (int k = 0, rest = i; k < 3; ++k, rest /= steps) {
      const Eigen::Index joint = from_rad.size() - 1 - k;
      const robot::Link& link = arm.table().links[static_cast<std::size_t>(joint)];
      const double turned =
          from_rad[joint] + max_turn_rad * (2.0 * (rest % steps) / (steps - 1) - 1.0);
      q_rad[joint] =
          std::clamp(turned, link.min_rad + from_limit_rad, link.max_rad - from_limit_rad);
    }
    const Transform held = arm.base_from_tool(q_rad, rail_m);
    // Never nearer to where a person lies or sits than the arm stands ready: not lower, not ahead.
    const Vector3 moved_m = held.translation() - from.translation();
    if (moved_m.z() < -max_nearer_m || moved_m.x() > max_nearer_m) continue;
    ways.push_back({q_rad, held.linear().transpose() * -Vector3::UnitZ()});
  }
  // One by one the direction that is farthest from all that were taken.
  std::vector<JointVector> taken;
  std::vector<double> nearest(ways.size(), 4.0);
  Vector3 last = from.linear().transpose() * -Vector3::UnitZ();
  while (static_cast<int>(taken.size()) < count && !ways.empty()) {
    for (std::size_t i = 0; i < ways.size(); ++i)
      nearest[i] = std::min(nearest[i], (ways[i].down_in_tool - last).norm());
    const auto best = std::max_element(nearest.begin(), nearest.end()) - nearest.begin();
    const Way& way = ways[static_cast<std::size_t>(best)];
    taken.push_back(way.q_rad);
    last = way.down_in_tool;
  }
  return taken;
}

Result<void> record_wrist_poses(const std::filesystem::path& device_file, Arm arm,
                                const robot::RobotPlacement& robot,
                                const std::filesystem::path& table, const Progress& progress) {
  const auto file = hardware::read_device_file(device_file);
  if (!file) return tl::unexpected(file.error());
  if (!file->arms || !file->wrists[arm])
    return fail(Fault::config, "{}: poses need arms of armlink and [wrist_sensor.{}]",
                device_file.string(), name_of(arm));
  hardware::WristDevice device = *file->wrists[arm];
  device.calibration.reset();
  if (const auto there = weigh(device); !there) return tl::unexpected(there.error());
  auto arms = hardware::ArmlinkRobot::open(*file->arms, robot.arm, robot.mount);
  if (!arms) return tl::unexpected(arms.error());
  const auto models = robot::both_models(robot.arm, robot.mount);
  robot::ReadyPose pose = {.q_rad = robot::ready_posture(robot.arm, robot.mount)};
  if (auto stands = (*arms)->stand_ready(pose); !stands) return stands;
  const auto ways = ways_to_hold(models[arm], pose.q_rad[arm], pose.rail_m, poses_of_a_set);
  std::string rows =
      "qw,qx,qy,qz,force_x_n,force_y_n,force_z_n,torque_x_nm,torque_y_nm,torque_z_nm\n";
  for (std::size_t i = 0; i < ways.size(); ++i) {
    pose.q_rad[arm] = ways[i];
    if (auto moved = (*arms)->move_to(pose); !moved) return moved;
    const JointVector q_rad = (*arms)->peer(arm).state().q_rad;
    (*arms)->rest();
    constexpr double max_off_rad = 3_deg;
    if ((q_rad - ways[i]).cwiseAbs().maxCoeff() > max_off_rad)
      return fail(Fault::device, "the {} arm stands {:.1f} deg from pose {}", name_of(arm),
                  to_deg((q_rad - ways[i]).cwiseAbs().maxCoeff()), i + 1);
    const auto told = weigh(device);
    if (!told) return tl::unexpected(told.error());
    rows += row_of(models[arm].base_from_tool(q_rad, pose.rail_m).linear(), *told);
    if (progress) progress(static_cast<double>(i + 1) / static_cast<double>(ways.size()));
  }
  return write_file(table, rows);
}

}  // namespace tuina::app
