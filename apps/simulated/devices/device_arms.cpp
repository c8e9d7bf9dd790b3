// SPDX-License-Identifier: Apache-2.0
#include "apps/simulated/devices/device_arms.hpp"

#include <cstring>
#include <span>

#include "tuina/hardware/can/emulated_bus.hpp"
#include "tuina/link/real_time.hpp"

namespace tuina::app {
namespace {

std::string text_of(std::span<const char> zeros_follow) {
  return {zeros_follow.data(), strnlen(zeros_follow.data(), zeros_follow.size())};
}

constexpr const char* real_arms =
    "these arms are real, and the scanner is simulated: an arm must not press where a simulated "
    "person was seen; name [camera] and [turntable], too";

/// What is true of the arms that this program simulates, if they stand in the world that the
/// session scans.
Result<SharedTruth> truth_of(const std::string& program, const char* verb,
                             const std::string& world) {
  auto truth = SharedTruth::map(truth_name(program), link::SharedMemory::Use::read);
  if (!truth) {
    return fail(Fault::device,
                "nobody tells what is true of the simulated arms `{}`, as `tuina robot {}` on "
                "this machine does",
                program, verb);
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

Result<hardware::DeviceFile> read_arms(const std::string& device_file) {
  auto file = hardware::read_device_file(device_file);
  if (file && !file->arms && !file->driven_arms) {
    return fail(Fault::config, "{}: names no arms; a massage needs [arm.left] and [arm.right]",
                device_file);
  }
  return file;
}

std::string name_of_arms(const hardware::DeviceFile& file) {
  if (file.arms) {
    const PerArm<hardware::ArmDevice>& arms = *file.arms;
    return fmt::format("armlink {}, {}", arms[Arm::left].address, arms[Arm::right].address);
  }
  std::string named = "drives on";
  for (const hardware::BusLoad& load : hardware::bus_loads(*file.driven_arms))
    named += " " + load.bus;
  return named;
}

Result<void> DeviceArms::open_armlink(const hardware::DeviceFile& file,
                                      const robot::RobotPlacement& placement,
                                      const std::string& world_name) {
  const PerArm<hardware::ArmDevice>& arms = *file.arms;
  auto robot = hardware::ArmlinkRobot::open(arms, placement.arm, placement.mount);
  if (!robot) return tl::unexpected(robot.error());
  armlink_ = std::move(*robot);
  if (world_name.empty()) return {};
  if (!armlink_->simulated()) return fail(Fault::device, "{}", real_arms);
  const std::string left(armlink_->peer(Arm::left).hello().called());
  const std::string right(armlink_->peer(Arm::right).hello().called());
  if (left != right)
    return fail(Fault::device, "the left arm is `{}` and the right one `{}`: not of one world",
                left, right);
  auto truth = truth_of(left, "armlink", world_name);
  if (!truth) return tl::unexpected(truth.error());
  truth_ = std::move(*truth);
  return {};
}

Result<void> DeviceArms::open_drives(const hardware::DeviceFile& file,
                                     const robot::RobotPlacement& placement,
                                     const std::string& world_name) {
  const auto program = hardware::emulator_of(hardware::bus_loads(*file.driven_arms).front().bus);
  if (!world_name.empty()) {
    if (!program) return fail(Fault::device, "{}", real_arms);
    auto truth = truth_of(*program, "can", world_name);
    if (!truth) return tl::unexpected(truth.error());
    truth_ = std::move(*truth);
  }
  drives_wait_ = program.has_value();
  hardware::CanBuses buses = {.wait = drives_wait_};
  if (drives_wait_) buses.patience = std::chrono::seconds(6);  // with a simulation that computes
  auto robot =
      hardware::Cia402Robot::open(*file.driven_arms, placement.arm, placement.mount, buses);
  if (!robot) return tl::unexpected(robot.error());
  drives_ = std::move(*robot);
  return {};
}

Result<std::unique_ptr<DeviceArms>> DeviceArms::open(const std::string& device_file,
                                                     const robot::RobotPlacement& placement,
                                                     const std::string& world_name) {
  std::unique_ptr<DeviceArms> made(new DeviceArms);
  const auto file = read_arms(device_file);
  if (!file) return tl::unexpected(file.error());
  made->named_ = name_of_arms(*file);
  auto opened = file->driven_arms ? made->open_drives(*file, placement, world_name)
                                  : made->open_armlink(*file, placement, world_name);
  if (opened && made->truth_) opened = judge_wrists(*file, *made->truth_);
  if (!opened) return fail(opened.error().fault, "{}: {}", device_file, opened.error().message);
  robot::Robot& arms = made->drives_ ? static_cast<robot::Robot&>(*made->drives_) : *made->armlink_;
  using Clock = hardware::WristRobot::Clock;
  auto joined = hardware::WristRobot::open(arms, file->wrists, placement.arm, placement.mount,
                                           made->lock_step() ? Clock::arms : Clock::host);
  if (!joined) return fail(joined.error().fault, "{}: {}", device_file, joined.error().message);
  made->wrists_ = std::move(*joined);
  return made;
}

DeviceArms::~DeviceArms() {
  link::end_real_time();
}

bool DeviceArms::lock_step() const noexcept {
  if (drives_) return drives_wait_;
  return armlink_->lock_step();
}

Result<void> DeviceArms::arm(const link::Arming& arming) {
  pace_ = lock_step() ? "each waits for the other"
                      : "real, " + link::be_real_time(link::Priority::loop);
  return guard_.arm(arming);
}

void DeviceArms::rest() noexcept {
  guard_.rest();
  if (armlink_) armlink_->rest();
  if (drives_) drives_->rest();
  wrists_->rest();
  link::end_real_time();
}

record::DeviceRecord::Traffic DeviceArms::traffic(Arm arm) const {
  const std::string wrist = wrist_said(wrists_->sensor(arm));
  if (drives_) {
    const hardware::DriveTraffic& seen = drives_->traffic();
    return {.cycles = seen.cycles, .lost = seen.lost[arm], .late = seen.late, .wrist = wrist};
  }
  const hardware::ArmTraffic& seen = armlink_->peer(arm).traffic();
  return {.cycles = seen.states,
          .lost = seen.lost,
          .late = seen.late,
          .unheard = seen.unheard,
          .rejected = seen.rejected,
          .wrist = wrist};
}

record::DeviceRecord DeviceArms::record(std::uint64_t truth_missed) const {
  record::DeviceRecord record{
      .arms = named_, .pace = pace_, .traffic = {}, .truth_missed = truth_missed};
  for (const Arm arm : both_arms) record.traffic[arm] = traffic(arm);
  return record;
}

}  // namespace tuina::app
