// SPDX-License-Identifier: Apache-2.0
// What may be wrong with an arm at the other end of armlink: named before the start, by the driver
// or by the guard afterwards.
#include <doctest/doctest.h>

#include <future>
#include <limits>

#include "tests/hardware/scripted_arms.hpp"
#include "tests/open_files.hpp"
#include "tests/reason.hpp"
#include "tuina/hardware/armlink_robot.hpp"
#include "tuina/hardware/wrist_calibration.hpp"
#include "tuina/robot/ready_posture.hpp"
#include "tuina/safety/robot_guard.hpp"

using namespace tuina;
using namespace tuina::hardware;
using tests::ScriptedArms;
using Script = ScriptedArms::Script;
using State = ScriptedArms::State;
using Bytes = std::vector<std::byte>;
using Clock = std::chrono::steady_clock;

namespace {

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
constexpr std::uint32_t sound = 40;  // states, before an arm goes wrong under torque
const robot::RobotMount mount = robot::mount_for(BodyPosture::sitting);
const robot::ArmTable table = robot::thesis_arm();

struct FaultCase {
  const char* name;
  const char* said;
  Script script;
  const char* or_said = said;  ///< where driver and guard both see it and either may be first
};

/// The arms stand, and control wants nothing but that; what ends it, and by whom.
std::string outcome(Script script) {
  const robot::ReadyPose ready = {.q_rad = robot::ready_posture(table, mount), .rail_m = 0.1};
  const auto models = robot::both_models(table, mount);
  for (const Arm arm : both_arms) {
    const Transform base_from_tool = models[arm].base_from_tool(ready.q_rad[arm], ready.rail_m);
    script.felt_in_tool[arm] =
        WristCalibration{.mass_kg = table.tool_mass_kg}.weight_in_tool(base_from_tool.linear());
  }
  ScriptedArms arms(std::move(script));
  auto robot = ArmlinkRobot::open(arms.file(), table, mount);
  if (!robot) return "refused: " + robot.error().message;
  const auto stands = (*robot)->stand_ready(ready);
  if (!stands) return "refused: " + stands.error().message;
  safety::RobotGuard guard(models, {.bench = true});
  safety::RobotProposal proposal;
  proposal.rail_m = 0.1;
  for (const Arm arm : both_arms) {
    proposal.arms[arm].torque_nm = models[arm].gravity_nm(ready.q_rad[arm]);
    proposal.arms[arm].zone = safety::Zone::bench;
  }
  constexpr int enough = 300;
  for (int i = 0; i < enough; ++i) {
    const auto reading = (*robot)->read();
    if (const char* fault = (*robot)->fault()) return fault;
    if (!reading) continue;
    const safety::RobotVerdict verdict = guard.check(*reading, proposal);
    for (const Arm arm : both_arms)
      if (verdict.arms[arm].latched)
        return fmt::format("guard: {}", safety::name_of(verdict.arms[arm].cause));
    (*robot)->apply(verdict.command);
  }
  return "borne";
}

Script hello(std::function<void(armlink::Hello&)> wrong) {
  return {.hello = std::move(wrong)};
}
Script hello_sent(std::function<void(Bytes&)> wrong) {
  return {.hello_sent = std::move(wrong)};
}
void write(const State& state, Bytes& bytes) {
  const auto sent = armlink::encode(state);
  bytes.assign(sent.begin(), sent.end());
}
/// What the arm says of itself is wrong, in a sound datagram.
Script state(std::function<void(State&)> wrong, std::uint32_t from = sound) {
  return {.state = [=](State& state, Bytes& bytes) {
    if (state.sequence < from) return;
    wrong(state);
    write(state, bytes);
  }};
}
Script sent(std::function<void(Bytes&)> wrong, bool waits = true) {
  return {.state =
              [=](State& state, Bytes& bytes) {
                if (state.sequence >= sound) wrong(bytes);
              },
          .waits = waits};
}
Script status(std::uint16_t bit, std::uint32_t from = sound) {
  return state([bit](State& state) { state.status = bit; }, from);
}
template <typename Vector>
void shorten(std::initializer_list<Vector*> vectors) {
  for (Vector* vector : vectors) vector->conservativeResize(5);
}

const auto nothing = [](Bytes& bytes) { bytes.clear(); };
const auto garbage = [](Bytes& bytes) { bytes.assign(300, std::byte{7}); };

std::vector<FaultCase> before_the_start() {
  using armlink::Hello;
  return {
      {"weak drive", "gives 69.5 Nm at upper_arm_roll, the table believes in 70",
       hello([](Hello& h) { h.max_torque_nm[2] = 69.5; })},
      {"slow drive", "0.1 rad/s", hello([](Hello& h) { h.max_speed_rad_per_s[0] = 0.1; })},
      {"narrow joint", "turns wrist from", hello([](Hello& h) { h.max_rad[5] = 1.0; })},
      {"short base", "moves its base from", hello([](Hello& h) { h.max_rail_m = 0.0; })},
      {"no base", "has no linear base", hello([](Hello& h) { h.flags = 0; })},
      {"another's", "is driven by another host",
       hello([](Hello& h) { h.flags |= armlink::flag::busy; })},
      {"positions only", "cannot be driven by torques", hello([](Hello& h) { h.modes = 8; })},
      {"slow cycle", "2000 us, 1000 are needed", hello([](Hello& h) { h.cycle_us = 2000; })},
      {"five joints", "has 5 joints, the table 6", hello([](Hello& h) {
         shorten({&h.max_torque_nm, &h.max_speed_rad_per_s, &h.min_rad, &h.max_rad});
       })},
      {"no number", "nobody answers", hello([](Hello& h) { h.min_rad[1] = not_a_number; })},
      {"answer to another", "nobody answers", hello([](Hello& h) { h.sequence += 1; })},
      {"other session", "nobody answers", hello([](Hello& h) { h.session += 1; })},
      {"other version", "another version of armlink",
       hello_sent([](Bytes& b) { b[4] = std::byte{2}; })},
      {"other protocol", "nobody answers", hello_sent(garbage)},
      {"half a hello", "nobody answers", hello_sent([](Bytes& b) { b.resize(b.size() / 2); })},
      {"spoilt hello", "nobody answers", hello_sent([](Bytes& b) { b[60] ^= std::byte{1}; })},
      {"unplugged", "nobody answers", hello_sent(nothing)},
      {"unplugged before it stands",
       "says nothing once it is told to stand ready",
       {.state = [](State&, Bytes& bytes) { bytes.clear(); }}},
      {"stopped by hand before it stands", "was stopped by an emergency stop",
       status(armlink::status::emergency_stop, 0)},
      {"drive fault before it stands", "has a fault in its drives",
       status(armlink::status::drive_fault, 0)},
  };
}

std::vector<FaultCase> under_torque() {
  return {
      {"garbage", "sends what is no armlink", sent(garbage)},
      {"a bit", "wrong check sums", sent([](Bytes& b) { b[100] ^= std::byte{1}; })},
      {"other version", "another version", sent([](Bytes& b) { b[4] = std::byte{2}; })},
      {"half a packet", "of a wrong size", sent([](Bytes& b) { b.resize(b.size() / 2); })},
      {"a byte too many", "of a wrong size", sent([](Bytes& b) { b.push_back(std::byte{0}); })},
      {"a command", "of a wrong kind", sent([](Bytes& b) {
         const auto other = armlink::encode(armlink::Command{.values = JointVector::Zero(6)});
         b.assign(other.begin(), other.end());
       })},
      {"no number", "not finite", state([](State& s) { s.dq_rad_per_s[2] = not_a_number; })},
      {"no force", "not finite",
       state([](State& s) { s.wrench_in_tool.force_n.x() = not_a_number; })},
      {"endless angle", "not finite",
       state([](State& s) { s.q_rad[0] = std::numeric_limits<double>::infinity(); })},
      {"five joints", "another number of joints", state([](State& s) {
         shorten({&s.q_rad, &s.dq_rad_per_s, &s.tau_nm});
       })},
      {"reordered", "counts its states backwards", state([](State& s) { s.sequence -= 10; })},
      {"began anew", "counts its states backwards", state([](State& s) { s.sequence %= sound; })},
      {"clock ahead", "has a clock that jumps", state([](State& s) { s.time_s += 3600.0; })},
      {"clock back", "has a clock that jumps", state([](State& s) { s.time_s -= 0.05; })},
      {"clock stands", "guard: clock does not go with the ticks",
       state([](State& s) { s.time_s = s.wrench_time_s = 1e-3 * sound; })},
      {"two hosts", "obeys another host as well", state([](State& s) { ++s.session; })},
      {"deaf", "does not hear its commands", state([](State& s) { s.answers -= 11; })},
      {"stopped by hand", "was stopped by an emergency stop",
       status(armlink::status::emergency_stop)},
      {"drive fault", "has a fault in its drives", status(armlink::status::drive_fault)},
      {"stopped by itself", "has stopped by itself", status(armlink::status::stopped)},
      {"unplugged", "guard: force sensor stale", sent(nothing, false), "arm is silent"},
      {"frozen",
       "guard: force sensor stale",
       {.state =
            [kept = Bytes()](State& state, Bytes& bytes) mutable {
              if (state.sequence == sound) kept = bytes;
              if (state.sequence > sound) bytes = kept;
            },
        .waits = false},
       "arm is silent"},
      {"wrist stuck", "guard: force sensor stuck",
       state([](State& s) { s.wrench_in_tool.torque_nm.setZero(); })},
      {"wrist off its zero", "guard: force sensor off its zero",
       state([](State& s) { s.wrench_in_tool.force_n.y() += 5.0; }, 0)},
      {"wrist silent", "guard: force sensor stale",
       state([](State& s) { s.wrench_time_s = 1e-3 * sound; })},
      {"wrist of tomorrow", "guard: force sensor stale",
       state([](State& s) { s.wrench_time_s += 1.0; })},
      {"encoder jumps", "guard: ", state([](State& s) { s.q_rad[1] += 0.2; })},
      {"speed without way", "guard: ", state([](State& s) { s.dq_rad_per_s[1] = 1.0; })},
      {"base moves", "guard: linear base moved", state([](State& s) { s.rail_m += 0.05; })},
      {"600 N at once", "guard: ", state([](State& s) { s.wrench_in_tool.force_n.x() -= 600.0; })},
  };
}

void run_all(const std::vector<FaultCase>& cases) {
  const auto begun = Clock::now();
  const std::size_t open = test::open_files();
  std::vector<std::future<std::string>> all;
  for (const FaultCase& one : cases)
    all.push_back(std::async(std::launch::async, outcome, one.script));
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const std::string said = all[i].get();
    INFO(std::string(cases[i].name));
    const bool named = said.find(cases[i].said) != std::string::npos ||
                       said.find(cases[i].or_said) != std::string::npos;
    CHECK_MESSAGE(named, said);
  }
  CHECK(Clock::now() - begun < std::chrono::seconds(60));
  CHECK(test::open_files() == open);
}

}  // namespace

TEST_CASE("a sound arm bears what the faults of others do not") {
  CHECK(outcome({}) == "borne");
}

TEST_CASE("what is wrong with an arm is named before the start, by driver or guard afterwards") {
  const auto before = before_the_start(), after = under_torque();
  const std::size_t count = before.size() + after.size();
  MESSAGE(count << " faults of armlink");
  CHECK(count >= 40);
  run_all(before);
  run_all(after);
}
