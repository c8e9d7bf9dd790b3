// SPDX-License-Identifier: Apache-2.0
#include "apps/simulated/device_arms.hpp"

#include <sched.h>

#include <cstring>
#include <span>

namespace tuina::app {
namespace {

std::string text_of(std::span<const char> zeros_follow) {
  return {zeros_follow.data(), strnlen(zeros_follow.data(), zeros_follow.size())};
}

/// What is true of these arms, if they stand in the world that the session scans.
Result<SharedTruth> truth_of(const hardware::ArmlinkRobot& robot, const std::string& world) {
  if (!robot.simulated()) {
    return fail(Fault::device,
                "these arms are real, and the scanner is simulated: an arm must not press where a "
                "simulated person was seen");
  }
  const std::string left(robot.peer(Arm::left).hello().called());
  const std::string right(robot.peer(Arm::right).hello().called());
  if (left != right)
    return fail(Fault::device, "the left arm is `{}` and the right one `{}`: not of one world",
                left, right);
  auto truth = SharedTruth::map(truth_name(left), link::SharedMemory::Use::read);
  if (!truth) {
    return fail(Fault::device,
                "nobody tells what is true of the simulated arms `{}`, as `tuina robot armlink` on "
                "this machine does",
                left);
  }
  const std::string there = text_of((*truth)->world);
  if (there != world.substr(0, (*truth)->world.size()))
    return fail(Fault::device, "the arms are before {}; the session is of {}", there, world);
  return truth;
}

/// Whether the sensors of the file are those by which these arms feel.
Result<void> judge_wrists(const hardware::DeviceFile& file, const SharedTruth& truth) {
  for (const Arm arm : both_arms) {
    const std::string there = text_of(truth->wrists[arm]);
    const std::string named = file.wrists[arm] ? file.wrists[arm]->address : "";
    if (named == there) continue;
    if (there.empty()) {
      return fail(Fault::device,
                  "names the wrist sensor {}, and these arms are simulated: no real sensor feels "
                  "what they touch; `tuina robot armlink --wrist` gives them simulated ones",
                  named);
    }
    return fail(Fault::device,
                "the {} arm feels by the wrist sensor {}; name it as `address` of "
                "[wrist_sensor.{}]",
                name_of(arm), there, name_of(arm));
  }
  return {};
}

/// What has come from a sensor, and what it has failed of; empty where the arm has none.
std::string wrist_said(const hardware::WristSensor* sensor) {
  if (sensor == nullptr) return {};
  const hardware::WristStream& stream = sensor->stream();
  const hardware::WristTraffic& traffic = stream.traffic();
  const std::string counted = fmt::format("{}: {} samples, {} lost", stream.device().address,
                                          traffic.samples, traffic.lost);
  return stream.fault() == nullptr ? counted
                                   : fmt::format("{}; the sensor {}", counted, stream.fault());
}

}  // namespace

Result<std::unique_ptr<DeviceArms>> DeviceArms::open(const std::string& device_file,
                                                     const sim::World& world,
                                                     const std::string& world_name) {
  std::unique_ptr<DeviceArms> made(new DeviceArms);
  auto file = hardware::read_device_file(device_file);
  if (!file) return tl::unexpected(file.error());
  if (file->driven_arms) {
    return fail(Fault::device,
                "{}: drives on CAN are real, and the scanner is simulated: an arm must not press "
                "where a simulated person was seen",
                device_file);
  }
  if (!file->arms) {
    return fail(Fault::config, "{}: names no arms; a massage needs [arm.left] and [arm.right]",
                device_file);
  }
  made->arms_ = std::move(*file->arms);
  auto robot = hardware::ArmlinkRobot::open(made->arms_, world.robot_table(), world.mount());
  if (!robot) return tl::unexpected(robot.error());
  made->robot_ = std::move(*robot);
  auto truth = truth_of(*made->robot_, world_name);
  if (!truth) return fail(truth.error().fault, "{}: {}", device_file, truth.error().message);
  made->truth_ = std::move(*truth);
  if (const auto good = judge_wrists(*file, made->truth_); !good)
    return fail(good.error().fault, "{}: {}", device_file, good.error().message);
  using Clock = hardware::WristRobot::Clock;
  auto joined =
      hardware::WristRobot::open(*made->robot_, file->wrists, world.robot_table(), world.mount(),
                                 made->lock_step() ? Clock::arms : Clock::host);
  if (!joined) return fail(joined.error().fault, "{}: {}", device_file, joined.error().message);
  made->wrists_ = std::move(*joined);
  return made;
}

bool DeviceArms::lock_step() const noexcept {
  return robot_->peer(Arm::left).waits() && robot_->peer(Arm::right).waits();
}

Result<void> DeviceArms::arm(const link::Arming& arming) {
  pace_ = lock_step() ? "each waits for the other" : "real, " + link::be_real_time();
  return guard_.arm(arming);
}

void DeviceArms::rest() noexcept {
  guard_.rest();
  robot_->rest();
  wrists_->rest();
  const sched_param usual = {};
  (void)sched_setscheduler(0, SCHED_OTHER, &usual);
}

record::DeviceRecord DeviceArms::record(std::uint64_t truth_missed) const {
  record::DeviceRecord record{
      .arms = fmt::format("armlink {}, {}", arms_[Arm::left].address, arms_[Arm::right].address),
      .pace = pace_,
      .traffic = {},
      .truth_missed = truth_missed};
  for (const Arm arm : both_arms) {
    const hardware::ArmTraffic& seen = robot_->peer(arm).traffic();
    record.traffic[arm] = {.cycles = seen.states,
                           .lost = seen.lost,
                           .late = seen.late,
                           .unheard = seen.unheard,
                           .rejected = seen.rejected,
                           .wrist = wrist_said(wrists_->sensor(arm))};
  }
  return record;
}

}  // namespace tuina::app
