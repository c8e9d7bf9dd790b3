// SPDX-License-Identifier: Apache-2.0
// What arms do whose host is killed.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <chrono>

#include "tests/hardware/arm_programs.hpp"
#include "tuina/hardware/armlink_robot.hpp"
#include "tuina/robot/inverse_kinematics.hpp"

using namespace tuina;
using namespace tuina::hardware;
using namespace tuina::tests;
using namespace std::chrono_literals;

namespace {

/// The network between a host and an arm, which keeps what the arm has said.
class Wire {
 public:
  explicit Wire(const UdpAddress& arm)
      : port_(free_port()),
        front_(*UdpSocket::listen(address_of(port_))),
        back_(*UdpSocket::connect(arm)) {}
  std::vector<armlink::State> states;

  [[nodiscard]] int port() const { return port_; }
  [[nodiscard]] std::array<int, 2> sockets() const { return {front_.number(), back_.number()}; }
  void carry() {
    std::array<std::byte, armlink::max_size + 1> in;
    while (const auto size = front_.receive(in, &host_)) back_.send(std::span(in).first(*size));
    while (const auto size = back_.receive(in)) {
      if (const auto state = armlink::decode_state({in.data(), *size})) states.push_back(*state);
      front_.send(std::span(in).first(*size), host_);
    }
  }

 private:
  int port_;
  UdpSocket front_, back_;
  UdpAddress host_;
};

/// Drives two arms for ever, as a session does.
[[noreturn]] void be_host(const PerArm<ArmDevice>& file) {
  const PerArm<JointVector> zeros = {.of = {JointVector::Zero(6), JointVector::Zero(6)}};
  auto robot =
      ArmlinkRobot::open(file, robot::thesis_arm(), robot::mount_for(BodyPosture::sitting));
  const auto stands =
      robot ? (*robot)->stand_ready({.q_rad = zeros}) : tl::unexpected(robot.error());
  if (!stands) _exit(1);
  while ((*robot)->fault() == nullptr)
    if ((*robot)->read()) (*robot)->apply({.torque_nm = zeros});
  _exit(2);
}

bool has_stopped(const armlink::State& state) {
  return (state.status & armlink::status::stopped) != 0;
}

/// How many states an arm has told from the last command that it obeyed to its own stop.
int cycles_to_stop(const std::vector<armlink::State>& states) {
  // An arm that has stopped before tells so until the next session.
  const auto moved = std::find_if_not(states.begin(), states.end(), has_stopped);
  const auto stopped = std::find_if(moved, states.end(), has_stopped);
  if (stopped == states.end()) return -1;
  const auto obeyed = std::find_if(moved, stopped, [&](const armlink::State& state) {
    return state.answers == stopped->answers;
  });
  return static_cast<int>(stopped->sequence - obeyed->sequence);
}

}  // namespace

TEST_CASE("two arms in C stop within three cycles when the process that drives them is killed") {
  const int left = free_port(), right = free_port();
  const Child one = start(in_c, left), other = start(in_c, right);
  for (const int port : {left, right}) REQUIRE(open_patiently(address_of(port)).has_value());
  std::array wires = {Wire(address_of(left)), Wire(address_of(right))};
  const PerArm<ArmDevice> file = {.of = {ArmDevice{"left", address_of(wires[0].port())},
                                         ArmDevice{"right", address_of(wires[1].port())}}};
  const auto carry_until = [&](std::chrono::steady_clock::time_point until, const auto& done) {
    while (std::chrono::steady_clock::now() < until && !done()) {
      const auto a = wires[0].sockets(), b = wires[1].sockets();
      const std::array all = {a[0], a[1], b[0], b[1]};
      wait_for_datagram(all, std::min(until, std::chrono::steady_clock::now() + 10ms));
      for (Wire& wire : wires) wire.carry();
    }
  };
  const auto driven = [](const Wire& wire) {
    return std::count_if(wire.states.begin(), wire.states.end(), [](const auto& state) {
             return state.mode == armlink::Mode::torque && !has_stopped(state);
           }) >= 3;
  };
  // Where others take the processor an arm stops before: once more then.
  int status = 0;
  const auto until = std::chrono::steady_clock::now() + 60s;
  while (!WIFSIGNALED(status) && std::chrono::steady_clock::now() < until) {
    for (Wire& wire : wires) wire.states.clear();
    const pid_t host = fork();
    REQUIRE(host >= 0);
    if (host == 0) be_host(file);
    bool ended = false;
    carry_until(until, [&] {
      ended = waitpid(host, &status, WNOHANG) == host;
      return ended || std::all_of(wires.begin(), wires.end(), driven);
    });
    if (!ended) kill(host, SIGKILL);
    if (!ended) waitpid(host, &status, 0);
    carry_until(std::chrono::steady_clock::now() + 5s, [&] {
      return std::all_of(wires.begin(), wires.end(),
                         [](const Wire& wire) { return cycles_to_stop(wire.states) >= 0; });
    });
  }
  REQUIRE(WIFSIGNALED(status));
  // Its last command may have come once more in the cycle after the one that first obeyed it.
  constexpr int fewest = armlink::max_missed_cycles, most = fewest + 1;
  for (const Wire& wire : wires) {
    const int cycles = cycles_to_stop(wire.states);
    CHECK(cycles >= fewest);
    CHECK(cycles <= most);
  }
}
