// SPDX-License-Identifier: Apache-2.0
// The reference clients in C and in Python, as programs of their own on loopback.
#include <doctest/doctest.h>

#include <algorithm>
#include <thread>

#include "tests/hardware/arm_programs.hpp"
#include "tests/reason.hpp"
#include "tuina/hardware/armlink_robot.hpp"
#include "tuina/robot/inverse_kinematics.hpp"

using namespace tuina;
using namespace tuina::hardware;
using namespace std::chrono_literals;
using namespace tuina::tests;
using tuina::test::reason;

namespace {

/// A host that keeps every state that it hears.
class RawHost {
 public:
  explicit RawHost(const UdpAddress& address) : socket_(*UdpSocket::connect(address)) {}
  std::vector<armlink::State> states;

  /// In answer to the state that came so many cycles before the newest.
  void send(armlink::Mode mode, double value, std::uint32_t older = 0) {
    const std::uint32_t newest = states.empty() ? 0 : states.back().sequence;
    socket_.send(armlink::encode(armlink::Command{.session = 77,
                                                  .sequence = ++sequence_,
                                                  .answers = newest - older,
                                                  .mode = mode,
                                                  .values = JointVector::Constant(6, value)}));
  }
  void hear_for(std::chrono::milliseconds time) {
    const auto until = std::chrono::steady_clock::now() + time;
    while (std::chrono::steady_clock::now() < until) {
      const int number = socket_.number();
      wait_for_datagram({&number, 1}, until);
      std::array<std::byte, armlink::max_size + 1> in;
      while (const auto size = socket_.receive(in))
        if (const auto state = armlink::decode_state({in.data(), *size})) states.push_back(*state);
    }
  }
  /// The first state of which it holds.
  template <typename Holds>
  [[nodiscard]] const armlink::State* first(Holds&& holds) const {
    const auto found = std::find_if(states.begin(), states.end(), holds);
    return found == states.end() ? nullptr : &*found;
  }

 private:
  UdpSocket socket_;
  std::uint32_t sequence_ = 0;
};

/// The host is there until the arm is under torque, and then no more.
void die_before(const Program& program) {
  using armlink::Mode;
  const auto has = [](std::uint16_t bit) {
    return [bit](const armlink::State& state) { return (state.status & bit) != 0; };
  };
  const auto driven = [](const armlink::State& state) { return state.mode == Mode::torque; };
  const int port = free_port();
  const Child arm = start(program, port);
  const auto peer = open_patiently(address_of(port));
  REQUIRE_MESSAGE(peer.has_value(), reason(peer));
  CHECK(peer->hello().called() == "pretended arm");
  RawHost host(address_of(port));
  const auto until = std::chrono::steady_clock::now() + 20s;
  while (!host.first(has(armlink::status::stands)) && std::chrono::steady_clock::now() < until) {
    host.send(Mode::ready, 0.01);
    host.hear_for(5ms);
  }
  REQUIRE(host.first(has(armlink::status::stands)) != nullptr);
  host.send(Mode::torque, 0.0, armlink::max_answer_age_cycles + 1);
  host.hear_for(20ms);
  CHECK(host.first(driven) == nullptr);  // such a command was under way for too long
  // A loaded machine may answer a state too late for the arm; then once more.
  constexpr std::uint32_t two_ms_each_way = 5;
  while (!host.first(driven) && std::chrono::steady_clock::now() < until) {
    host.send(Mode::torque, 0.0, two_ms_each_way);
    host.hear_for(20ms);
  }
  while (!host.first(has(armlink::status::braked)) && std::chrono::steady_clock::now() < until)
    host.hear_for(20ms);
  const armlink::State* obeyed = host.first(driven);
  const armlink::State* stopped = host.first(has(armlink::status::stopped));
  const armlink::State* braked = host.first(has(armlink::status::braked));
  REQUIRE(obeyed != nullptr);
  REQUIRE(stopped != nullptr);
  CHECK(stopped->sequence - obeyed->sequence == armlink::max_missed_cycles);
  REQUIRE(braked != nullptr);  // after 0.3 s, for it stands still
  CHECK(braked->sequence - stopped->sequence == 300);
  // It heeds nobody until the next session.
  host.send(Mode::torque, 1.0);
  host.hear_for(20ms);
  CHECK(has(armlink::status::stopped)(host.states.back()));
  CHECK(host.states.back().q_rad == obeyed->q_rad);
  // Nor does a command of a session that is over open it again, however late it comes.
  host.send(Mode::idle, 0.0);
  host.hear_for(20ms);
  host.states.clear();
  host.send(Mode::ready, 0.5);
  host.hear_for(50ms);
  CHECK(host.states.empty());
}

}  // namespace

TEST_CASE("two arms in C are a robot that stands and turns as it is told") {
  const int left = free_port(), right = free_port();
  const Child one = start(in_c, left), other = start(in_c, right);
  for (const int port : {left, right}) REQUIRE(open_patiently(address_of(port)).has_value());
  const PerArm<ArmDevice> file = {
      .of = {ArmDevice{"left", address_of(left)}, ArmDevice{"right", address_of(right)}}};
  const robot::RobotMount mount = robot::mount_for(BodyPosture::sitting);
  robot::ReadyPose pose{.q_rad = {.of = {JointVector::Constant(6, 0.02), JointVector::Zero(6)}}};
  // Where others take the processor for three milliseconds, arms stop by themselves: once more
  // then, for a machine may be busy with other tests.
  double turned_rad = 0.0;
  int readings = 0;
  const auto until = std::chrono::steady_clock::now() + 60s;
  while (readings < 30 && std::chrono::steady_clock::now() < until) {
    auto robot = ArmlinkRobot::open(file, robot::thesis_arm(), mount);
    if (!robot) {
      // Its host before may be gone for less than a second.
      REQUIRE_MESSAGE(reason(robot).find("another host") != std::string::npos, reason(robot));
      std::this_thread::sleep_for(200ms);
      continue;
    }
    const auto stands = (*robot)->stand_ready(pose);
    REQUIRE_MESSAGE(stands.has_value(), reason(stands));
    readings = 0;
    while (readings < 30) {
      const auto reading = (*robot)->read();
      if ((*robot)->fault() != nullptr) break;
      if (!reading) continue;
      ++readings;
      turned_rad = reading->arms[Arm::left].q_rad[5] - 0.02;
      CHECK(reading->arms[Arm::right].q_rad[5] == 0.0);
      robot::RobotCommand command{
          .torque_nm = {.of = {JointVector::Zero(6), JointVector::Zero(6)}}};
      command.torque_nm[Arm::left][5] = 5.0;
      (*robot)->apply(command);
    }
  }
  CHECK(readings == 30);
  // 5 Nm turn 0.2 kg m2 by 25 rad/s2: 10 mrad in 28 ms, somewhat less by friction, more where a
  // cycle was skipped.
  CHECK(turned_rad > 5e-3);
  CHECK(turned_rad < 50e-3);
}

TEST_CASE("an arm in C stops three cycles after its host has died") {
  die_before(in_c);
}

TEST_CASE("an arm in Python stops three cycles after its host has died") {
  die_before(in_python);
}
