// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <doctest/doctest.h>

#include <chrono>
#include <functional>
#include <future>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "tests/hardware/scripted_wrist.hpp"
#include "tests/open_files.hpp"
#include "tuina/hardware/wrist_robot.hpp"
#include "tuina/robot/ready_posture.hpp"
#include "tuina/safety/robot_guard.hpp"

// What becomes of a wrist sensor that is at fault: refused before the start, or stopped by the
// guard.
namespace tuina::tests {

struct WristFault {
  const char* name;
  const char* said;
  ScriptedWrist::Script script = {};
  std::function<void(hardware::WristDevice&)> device = {};  ///< what its file says of it
};

inline const robot::RobotMount wrist_mount = robot::mount_for(BodyPosture::sitting);
inline const robot::ArmTable wrist_table = robot::thesis_arm();

/// The weight of a tool as its arm holds it, that stands ready.
inline PerArm<Wrench> weights_in_tool() {
  const auto models = robot::both_models(wrist_table, wrist_mount);
  const auto ready_rad = robot::ready_posture(wrist_table, wrist_mount);
  PerArm<Wrench> weights;
  for (const Arm arm : both_arms) {
    const Transform base_from_tool = models[arm].base_from_tool(ready_rad[arm], 0.0);
    weights[arm] = hardware::WristCalibration{.mass_kg = wrist_table.tool_mass_kg}.weight_in_tool(
        base_from_tool.linear());
  }
  return weights;
}

/// Arms that stand still. A millisecond of theirs goes by once the left sensor has measured again,
/// so that a busy machine makes no sample old.
class SteppedArms final : public robot::Robot {
 public:
  explicit SteppedArms(const ScriptedWrist& wrist) : wrist_(wrist) {}
  Result<void> stand_ready(const robot::ReadyPose& pose) override {
    const PerArm<Wrench> weights = weights_in_tool();
    for (const Arm arm : both_arms) {
      reading_.arms[arm].q_rad = pose.q_rad[arm];
      reading_.arms[arm].dq_rad_per_s = JointVector::Zero(wrist_table.joints);
      reading_.arms[arm].wrench_in_tool = weights[arm];
    }
    return {};
  }
  std::optional<robot::RobotReading> read() noexcept override {
    using namespace std::chrono_literals;
    if (reading_.tick == 0) measured_ = wrist_.sent();
    const auto until = std::chrono::steady_clock::now() + 1s;
    while (wrist_.sent() <= measured_ && !wrist_.gone() && std::chrono::steady_clock::now() < until)
      std::this_thread::sleep_for(100us);
    measured_ = wrist_.sent();
    std::this_thread::sleep_for(100us);  // until it has come
    ++reading_.tick;
    reading_.time_s += control_period_s;
    for (robot::ArmReading& arm : reading_.arms.of) {
      arm.wrench_time_s = reading_.time_s;
      arm.wrench_in_tool.torque_nm.z() += 1e-9;
    }
    return reading_;
  }
  void apply(const robot::RobotCommand&) noexcept override {}
  [[nodiscard]] const char* fault() const noexcept override { return nullptr; }

 private:
  const ScriptedWrist& wrist_;
  int measured_ = 0;
  robot::RobotReading reading_;
};

/// Why it is not opened.
inline std::string refusal(const WristFault& fault) {
  using namespace std::chrono_literals;
  ScriptedWrist wrist(fault.script);
  hardware::WristDevice device = wrist.device();
  if (fault.device) fault.device(device);
  const auto begun = std::chrono::steady_clock::now();
  const auto sensor = hardware::WristSensor::open(device);
  if (sensor) return "opened";
  if (sensor.error().fault != Fault::device) return "another kind of fault";
  if (sensor.error().message.find(device.address) != 0)
    return "without its address: " + sensor.error().message;
  return std::chrono::steady_clock::now() - begun < 4s ? sensor.error().message : "too late";
}

/// What the guard says of arms with a sound sensor at the left one that is spoilt after it was
/// zeroed, and before that what the sensor has failed of, if it knows.
inline std::string stopped(const WristFault& fault) {
  ScriptedWrist::Script script = fault.script;
  script.from = 1 << 30;
  ScriptedWrist wrist(std::move(script));
  SteppedArms arms(wrist);
  hardware::WristDevice device = wrist.device();
  if (fault.device) fault.device(device);
  auto robot = hardware::WristRobot::open(arms, {.of = {device, std::nullopt}}, wrist_table,
                                          wrist_mount, hardware::WristRobot::Clock::arms);
  if (!robot) return robot.error().message;
  const robot::ReadyPose ready = {.q_rad = robot::ready_posture(wrist_table, wrist_mount)};
  if (const auto stands = (*robot)->stand_ready(ready); !stands) return stands.error().message;
  const auto models = robot::both_models(wrist_table, wrist_mount);
  safety::RobotGuard guard(models, {.bench = true});
  safety::RobotProposal proposal;
  for (const Arm arm : both_arms) {
    proposal.arms[arm].torque_nm = models[arm].gravity_nm(ready.q_rad[arm]);
    proposal.arms[arm].zone = safety::Zone::bench;
  }
  constexpr int sound = 60, enough = 500, named_after = 100;  // milliseconds
  std::string cause;
  int after = 0;
  const auto known = [&] { return (*robot)->sensor(Arm::left)->stream().fault(); };
  for (int i = 0; i < enough && after < named_after && !(after > 0 && known()); ++i) {
    if (i == sound) wrist.spoil_from_now();
    const safety::RobotVerdict verdict = guard.check(*(*robot)->read(), proposal);
    if (cause.empty() && verdict.arms[Arm::left].latched)
      cause = fmt::format("guard: {}", safety::name_of(verdict.arms[Arm::left].cause));
    if (i < sound && !cause.empty() && !fault.device) return "before its fault: " + cause;
    after += cause.empty() ? 0 : 1;
  }
  const std::string why = known() != nullptr ? known() : "";
  if (cause.empty()) return "nobody stops: " + why;
  return why.empty() ? cause : why + "; " + cause;
}

/// Each ends in the sentence or the stop that is said. All at the same time, since each waits most
/// of its own; one after the other where the guard has to see it.
inline void check_all(const std::vector<WristFault>& faults,
                      std::string (*judge)(const WristFault&)) {
  const std::size_t open = test::open_files();
  std::vector<std::future<std::string>> all;
  for (const WristFault& one : faults) {
    const bool guarded = std::string_view(one.said).starts_with("guard: ");
    all.push_back(std::async(guarded ? std::launch::deferred : std::launch::async, judge, one));
  }
  for (const bool deferred : {false, true}) {
    for (std::size_t i = 0; i < faults.size(); ++i) {
      const bool guarded = std::string_view(faults[i].said).starts_with("guard: ");
      if (guarded != deferred) continue;
      const std::string said = all[i].get();
      INFO(std::string(faults[i].name));
      CHECK_MESSAGE(said.find(faults[i].said) != std::string::npos, said);
    }
  }
  CHECK(test::open_files() == open);
}

/// What a sensor says that is none: a receiver of satellites.
inline void as_text(ScriptedWrist::Bytes& bytes) {
  constexpr std::string_view nmea = "$GPGGA,123519,4807.038,N,01131.000,E,1,08*47\r\n";
  bytes.assign(nmea.begin(), nmea.end());
}
inline void as_nothing(ScriptedWrist::Bytes& bytes) {
  bytes.clear();
}

using SpoilSample = std::function<void(ScriptedWrist::Sample&)>;

/// What it counts jumps once.
inline SpoilSample jump(int by) {
  return [by](ScriptedWrist::Sample& sample) {
    sample.sequence += static_cast<std::uint32_t>(by);
    sample.counter += static_cast<std::uint32_t>(by);
  };
}
/// It counts by so many.
inline SpoilSample count_by(std::uint32_t step) {
  return [step](ScriptedWrist::Sample& sample) {
    sample.sequence *= step;
    sample.counter *= step;
  };
}
/// It says one sample for ever.
inline SpoilSample hold() {
  return [kept = ScriptedWrist::Sample{}](ScriptedWrist::Sample& sample) mutable {
    if (kept.counter == 0) kept = sample;
    sample = kept;
  };
}
/// It goes on to count, and measures one thing for ever.
inline SpoilSample hold_counts() {
  return [kept = ScriptedWrist::Sample{}](ScriptedWrist::Sample& sample) mutable {
    if (kept.counter == 0) kept = sample;
    sample.counts = kept.counts;
  };
}
inline SpoilSample begin_anew_each(std::uint32_t samples) {
  return [samples](ScriptedWrist::Sample& sample) {
    sample.sequence %= samples;
    sample.counter %= samples;
  };
}
inline SpoilSample status(std::uint32_t bits) {
  return [bits](ScriptedWrist::Sample& sample) { sample.status = bits; };
}
inline SpoilSample counts(std::size_t axis, std::int32_t value) {
  return [axis, value](ScriptedWrist::Sample& sample) { sample.counts[axis] = value; };
}
/// It sends one sample in so many, and counts those that it sends.
inline ScriptedWrist::Script slowed(ScriptedWrist::Kind kind, int one_in) {
  struct Counted {
    std::uint32_t first = 0, passed = 0;
  };
  const auto counted = std::make_shared<Counted>();
  const auto each = static_cast<std::uint32_t>(one_in);
  return {.kind = kind,
          .sample =
              [=](ScriptedWrist::Sample& sample) {
                if (counted->first == 0) counted->first = sample.counter;
                sample.sequence = sample.counter = counted->first + counted->passed / each;
              },
          .bytes =
              [=](ScriptedWrist::Bytes& bytes) {
                if (counted->passed++ % each != 0) bytes.clear();
              }};
}
/// A calibration whose zero is no longer where the sensor's is.
inline std::function<void(hardware::WristDevice&)> drifted_by(double force_n) {
  return [force_n](hardware::WristDevice& device) {
    device.zero_at_start = false;
    // The sensor says 2, -4 and 6 N with the tool's weight at it.
    device.calibration = hardware::WristCalibration{.mass_kg = wrist_table.tool_mass_kg};
    device.calibration->offset_in_tool = {
        .force_n = Vector3(2.0, -4.0 - force_n, 6.0) - weights_in_tool()[Arm::left].force_n,
        .torque_nm = Vector3(0.01, -0.02, 0.03) - weights_in_tool()[Arm::left].torque_nm};
  };
}

}  // namespace tuina::tests
