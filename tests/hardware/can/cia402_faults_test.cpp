// SPDX-License-Identifier: Apache-2.0
// What may be wrong with a drive on CAN, its bus or its file: named before the start, by the driver
// or by the guard afterwards.
#include <doctest/doctest.h>
#include <linux/can/error.h>

#include "tests/hardware/can/emulated_robot.hpp"
#include "tests/open_files.hpp"
#include "tests/reason.hpp"
#include "tuina/core/units.hpp"
#include "tuina/hardware/wrist_calibration.hpp"
#include "tuina/robot/ready_posture.hpp"
#include "tuina/safety/robot_guard.hpp"

using namespace tuina;
using namespace tuina::hardware;
using tuina::app::EmulatedDrive;
using tuina::tests::EmulatedRobot;
using Script = EmulatedRobot::Script;

namespace {

constexpr int sound = 20;  // cycles of torque before a drive goes wrong
const robot::RobotMount mount = [] {
  robot::RobotMount standing = robot::mount_for(BodyPosture::sitting);
  standing.min_rail_m = standing.max_rail_m = 0.0;
  return standing;
}();
const robot::ArmTable table = robot::thesis_arm();

struct FaultCase {
  const char* name;
  const char* said;
  Script script;
  double extra_nm = 0.0;  ///< that control wants of the left elbow beside its weight
  bool guarded = true;    ///< else the drives get what control wants
};

/// The wrists feel the weight of the tools, and nothing else.
void feel(robot::RobotReading& reading, const PerArm<robot::ArmModel>& models) {
  for (const Arm arm : both_arms) {
    const Transform base_from_tool =
        models[arm].base_from_tool(reading.arms[arm].q_rad, reading.rail_m);
    reading.arms[arm].wrench_in_tool =
        WristCalibration{.mass_kg = table.tool_mass_kg}.weight_in_tool(base_from_tool.linear());
    reading.arms[arm].wrench_in_tool.torque_nm.z() += 1e-9 * static_cast<double>(reading.tick);
    reading.arms[arm].wrench_time_s = reading.time_s;
  }
}

/// The arms stand, and control wants nothing but that; what ends it, and by whom.
std::string outcome(const FaultCase& one) {
  const robot::ReadyPose ready = {.q_rad = robot::ready_posture(table, mount), .rail_m = 0.0};
  const auto models = robot::both_models(table, mount);
  EmulatedRobot drives(one.script);
  auto robot = Cia402Robot::open(drives.file(), table, mount, drives.buses());
  if (!robot) return "refused: " + robot.error().message;
  const auto stands = (*robot)->stand_ready(ready);
  if (!stands) return "refused: " + stands.error().message;
  safety::RobotGuard guard(models, {.bench = true});
  safety::RobotProposal proposal;
  for (const Arm arm : both_arms) {
    proposal.arms[arm].torque_nm = models[arm].gravity_nm(ready.q_rad[arm]);
    proposal.arms[arm].zone = safety::Zone::bench;
  }
  proposal.arms[Arm::left].torque_nm[3] += one.extra_nm;
  safety::RobotVerdict as_wanted;
  for (const Arm arm : both_arms) as_wanted.command.torque_nm[arm] = proposal.arms[arm].torque_nm;
  constexpr int enough = 200;
  for (int i = 0; i < enough; ++i) {
    auto reading = (*robot)->read();
    if (const char* fault = (*robot)->fault()) return fault;
    if (!reading) continue;
    feel(*reading, models);
    const auto verdict = one.guarded ? guard.check(*reading, proposal) : as_wanted;
    for (const Arm arm : both_arms)
      if (verdict.arms[arm].latched)
        return fmt::format("guard: {}", safety::name_of(verdict.arms[arm].cause));
    (*robot)->apply(verdict.command);
  }
  return "borne";
}

void run_all(const std::vector<FaultCase>& cases) {
  const std::size_t open = test::open_files();
  for (const FaultCase& one : cases) {
    const auto begun = std::chrono::steady_clock::now();
    const std::string said = outcome(one);
    INFO(std::string(one.name));
    CHECK_MESSAGE(said.find(one.said) != std::string::npos, said);
    CHECK(std::chrono::steady_clock::now() - begun < std::chrono::seconds(20));
  }
  CHECK(test::open_files() == open);
}

Script setup(std::function<void(EmulatedDrive&)> wrong) {
  return {.setup = std::move(wrong)};
}
Script say(std::function<bool(can_frame&)> spoil) {
  return {.say = [=](can_frame& frame, int) { return spoil(frame); }};
}
/// What it tells of each cycle is spoilt, once it has obeyed for a while.
Script tell(std::function<bool(can_frame&)> spoil) {
  return {.say = [=](can_frame& frame, int cycles) {
    return cycles < sound || (frame.can_id & 0x780U) != 0x180 || spoil(frame);
  }};
}
Script later(std::function<void(EmulatedDrive&, EmulatedRobot&)> wrong) {
  return {.cycle = [=](EmulatedDrive& drive, int cycles, EmulatedRobot& robot) {
    if (cycles == sound) wrong(drive, robot);
  }};
}
Script on_the_bus(canid_t id, std::uint8_t bytes) {
  return later(
      [=](EmulatedDrive&, EmulatedRobot& robot) { robot.say({.can_id = id, .can_dlc = bytes}); });
}
/// What it answers to the order to change to torques.
Script answer_torque(std::function<bool(can_frame&)> spoil) {
  return {.say = [=, times = 0](can_frame& frame, int) mutable {
    const bool mode = frame.can_id == 0x584 && frame.data[1] == 0x60 && frame.data[2] == 0x60;
    return !mode || ++times < 2 || spoil(frame);
  }};
}

const auto nothing = [](can_frame&) { return false; };
/// What is sent, but for this.
const auto but = [](auto change) {
  return [=](can_frame& frame) {
    change(frame);
    return true;
  };
};

std::vector<FaultCase> before_the_start() {
  return {
      {"unplugged", "left elbow: node 4 at can1 does not answer", say(nothing)},
      {"another node", "node 4 at can1 does not answer",
       say(but([](can_frame& frame) { ++frame.can_id; }))},
      {"half frames", "node 4 at can1 does not answer",
       say(but([](can_frame& frame) { frame.can_dlc = 3; }))},
      {"garbage", "node 4 at can1 does not answer",
       say(but([](can_frame& frame) { frame.data[0] = 0xEE; }))},
      {"other objects", "node 4 at can1 does not answer",
       say(but([](can_frame& frame) { ++frame.data[1]; }))},
      {"no drive", "is no drive of CiA 402: its device type is 0x00000191",
       setup([](EmulatedDrive& d) { d.value(0x1000) = 0x191; })},
      {"another motor", "says 900 for its rated torque 0x6076, which is not the 0.6 Nm",
       setup([](EmulatedDrive& d) { d.value(0x6076) = 900; })},
      {"torque in micronewtonmetres", "borne",
       setup([](EmulatedDrive& d) { d.value(0x6076) = 600'000; })},
      {"no rated torque", "does not tell 0x6076: it has no such object",
       setup([](EmulatedDrive& d) { d.forget(0x6076); })},
      {"no following error", "for 0x6065:0: it has no such object",
       setup([](EmulatedDrive& d) { d.forget(0x6065); })},
      {"no heartbeats", "for 0x1016:1: it has no such object",
       setup([](EmulatedDrive& d) { d.forget(0x1016, 1); })},
      {"no cyclic modes", "for 0x6060:0", setup([](EmulatedDrive& d) { d.forget(0x6060); })},
      {"a fault that stays", "stays in fault 0x3210: voltage", setup([](EmulatedDrive& d) {
         d.fall_into_fault(0x3210);
         d.stays_in_fault = true;
       })},
      {"a fault that goes", "borne", setup([](EmulatedDrive& d) { d.fall_into_fault(0x3210); })},
      {"not homed", "left elbow: stands at 75.0 deg, beyond -85.0 to 60.0; is it homed",
       setup([](EmulatedDrive& d) { d.place_at(75_deg); })},
      {"no motor supply", "the left elbow does not obey: switch on disabled",
       setup([](EmulatedDrive& d) { d.powered = false; })},
      {"no PDO", "the left elbow tells nothing upon a SYNC",
       say([](can_frame& frame) { return (frame.can_id & 0x780U) != 0x180; })},
      {"a blocked joint", "the left elbow reports error 0x8611: following error",
       setup([](EmulatedDrive& d) { d.blocked = true; })},
      {"unplugged on its way",
       "the bus can1 was unplugged",
       {.cycle =
            [](EmulatedDrive& d, int, EmulatedRobot& r) {
              if (d.enabled()) r.unplug();
            }}},
  };
}

std::vector<FaultCase> under_torque() {
  const auto stuck = but([](can_frame& frame) { frame.data[6] = 0xE8, frame.data[7] = 0x03; });
  return {
      {"silent", "the left elbow is silent", tell(nothing)},
      {"a lost frame",
       "borne",
       {.say = [](can_frame& frame, int cycles) { return cycles != sound || frame.can_dlc != 8; }}},
      {"half a PDO", "tells PDOs of another size",
       tell(but([](can_frame& frame) { frame.can_dlc = 6; }))},
      {"an empty PDO", "tells PDOs of another size",
       tell(but([](can_frame& frame) { frame.can_dlc = 0; }))},
      {"an emergency", "the left elbow reports error 0x2310: current",
       later([](EmulatedDrive& d, EmulatedRobot&) { d.report(0x2310); })},
      {"too hot", "reports error 0x4210: temperature",
       later([](EmulatedDrive& d, EmulatedRobot&) { d.fall_into_fault(0x4210); })},
      {"an emergency that has gone", "borne",
       later([](EmulatedDrive& d, EmulatedRobot&) { d.report(0); })},
      {"a fault without a word", "is in fault and does not say why",
       later([](EmulatedDrive& d, EmulatedRobot&) { d.fall_into_fault_silently(); })},
      {"safe torque off", "obeys no more: switch on disabled",
       later([](EmulatedDrive& d, EmulatedRobot&) { d.lose_power(); })},
      {"a quick stop of its own", "obeys no more: quick stop active",
       later([](EmulatedDrive& d, EmulatedRobot&) { d.stop_by_itself(); })},
      {"begun anew", "has begun anew",
       later([](EmulatedDrive& d, EmulatedRobot&) { d.say_heartbeat(0); })},
      {"stopped in the network", "has left the cycles: its network state is 4",
       later([](EmulatedDrive& d, EmulatedRobot&) { d.say_heartbeat(4); })},
      {"torques refused", "refuses torques: the value is out of its range (0x06090030)",
       answer_torque(but([](can_frame& frame) {
         constexpr std::array<std::uint8_t, 8> refusal = {0x80, 0x60, 0x60, 0, 0x30, 0, 0x09, 0x06};
         std::copy(refusal.begin(), refusal.end(), frame.data);
       }))},
      {"no answer to torques", "does not change from positions to torques", answer_torque(nothing)},
      {"does not follow", "does not follow the torques",
       tell(but([](can_frame& frame) { frame.data[1] &= 0xEF; }))},
      {"stuck torque", "guard: a drive does not give what it is told", tell(stuck)},
      {"stuck torque, no guard", "gives 1000 permille of its rated torque, ", tell(stuck), 0.0,
       false},
      {"stuck encoder", "guard: a drive does not give what it is told", {}, 30.0},
      {"encoder jumps", "guard: encoder jump",
       tell(but([](can_frame& frame) { ++frame.data[4]; }))},
      {"another host's SYNC", "the bus can1 has another host", on_the_bus(0x080, 0)},
      {"another host's network", "the bus can1 has another host", on_the_bus(0x000, 2)},
      {"another host's torques", "the left elbow is ordered about by another host",
       on_the_bus(0x204, 4)},
      {"another host's question", "the left elbow is ordered about by another host",
       on_the_bus(0x604, 8)},
      {"other devices", "borne", on_the_bus(0x1A5, 8)},
      {"long identifiers", "borne", on_the_bus(0x80000184U, 8)},
      {"bus off", "the bus can1 is off after too many errors",
       on_the_bus(CAN_ERR_FLAG | CAN_ERR_BUSOFF, 8)},
      {"bus begun anew", "the bus can1 was off and began anew",
       on_the_bus(CAN_ERR_FLAG | CAN_ERR_RESTARTED, 8)},
      {"unplugged", "the bus can1 was unplugged",
       later([](EmulatedDrive&, EmulatedRobot& r) { r.unplug(); })},
  };
}

std::string refused(const PerArm<DrivenArm>& arms, const robot::RobotMount& on = mount) {
  EmulatedRobot drives;
  const auto robot = Cia402Robot::open(arms, table, on, drives.buses());
  REQUIRE_FALSE(robot.has_value());
  CHECK(robot.error().fault == Fault::config);
  return robot.error().message;
}

}  // namespace

TEST_CASE("sound drives bear what the faults of others do not") {
  CHECK(outcome({}) == "borne");
}

TEST_CASE("what is wrong with a drive on CAN is named before the start") {
  run_all(before_the_start());
}

TEST_CASE("what goes wrong with a drive under torque is named by driver or guard") {
  std::vector<FaultCase> all = before_the_start();
  const auto under = under_torque();
  all.insert(all.end(), under.begin(), under.end());
  const auto count = std::count_if(all.begin(), all.end(), [](const FaultCase& one) {
    return std::string(one.said) != "borne";
  });
  MESSAGE(count << " faults of drives on CAN, and " << all.size() - static_cast<std::size_t>(count)
                << " that are borne");
  CHECK(count >= 40);
  run_all(under);
}

TEST_CASE("all drives stop when one is at fault") {
  EmulatedRobot drives(later([](EmulatedDrive& d, EmulatedRobot&) { d.report(0x2310); }));
  auto robot = Cia402Robot::open(drives.file(), table, mount, drives.buses());
  REQUIRE_MESSAGE(robot.has_value(), test::reason(robot));
  REQUIRE((*robot)->stand_ready({.q_rad = robot::ready_posture(table, mount)}).has_value());
  const robot::RobotCommand command = {
      .torque_nm = {.of = {JointVector::Zero(6), JointVector::Zero(6)}}};
  while ((*robot)->read()) (*robot)->apply(command);
  REQUIRE((*robot)->fault() != nullptr);
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  drives.look([](auto& all) {
    for (EmulatedDrive& drive : all) CHECK_FALSE(drive.enabled());
  });
}

TEST_CASE("arms that the table does not describe are refused before a bus is opened") {
  const PerArm<DrivenArm> arms = EmulatedRobot().file();
  CHECK(refused(arms, robot::mount_for(BodyPosture::sitting)).find("no linear base") !=
        std::string::npos);
  PerArm<DrivenArm> other = arms;
  other[Arm::left].joints.pop_back();
  CHECK(refused(other) == "the left arm names 5 joints, the table has 6");
  other = arms;
  other[Arm::right].joints[0].rated_torque_nm = 0.1;
  CHECK(
      refused(other).find("the right shoulder_pitch is believed to give 120 Nm, which is more than "
                          "5 times the rated 10.0 Nm") != std::string::npos);
  const auto missing = CanBus::open("can_of_nobody");
  REQUIRE_FALSE(missing.has_value());
  CHECK(missing.error().message.find("there is no such CAN interface") != std::string::npos);
}
