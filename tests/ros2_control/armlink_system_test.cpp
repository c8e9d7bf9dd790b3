// SPDX-License-Identifier: Apache-2.0
// `ros2/tuina_armlink` without ROS 2, against arms on loopback.
#include "armlink_system.hpp"

#include <arpa/inet.h>
#include <doctest/doctest.h>
#include <signal.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <limits>
#include <thread>

extern char** environ;

using hardware_interface::CallbackReturn;
using hardware_interface::HardwareInfo;
using hardware_interface::return_type;
using tuina_armlink::ArmlinkSystem;

namespace {

/// A port that nobody listens at, for now.
int free_port() {
  const int probe = socket(AF_INET, SOCK_DGRAM, 0);
  sockaddr_in any = {};
  any.sin_family = AF_INET;
  any.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof any;
  REQUIRE(bind(probe, reinterpret_cast<sockaddr*>(&any), size) == 0);
  REQUIRE(getsockname(probe, reinterpret_cast<sockaddr*>(&any), &size) == 0);
  close(probe);
  return ntohs(any.sin_port);
}

/// What a URDF says of an arm with two joints on a linear base.
HardwareInfo info_at(int port) {
  return {.hardware_parameters = {{"address", "127.0.0.1"},
                                  {"port", std::to_string(port)},
                                  {"rail_ready", "0.4"}},
          .joints = {{"one", {{"ready", "0.1"}}}, {"two", {{"ready", "-0.1"}}}},
          .sensors = {{"wrist"}}};
}

/// The reference arm, a program of its own.
struct Arm {
  Arm() {
    std::string words[] = {TUINA_ARM_CLIENT, std::to_string(port), "2"};
    char* pointers[] = {words[0].data(), words[1].data(), words[2].data(), nullptr};
    REQUIRE(posix_spawnp(&process, pointers[0], nullptr, nullptr, pointers, environ) == 0);
  }
  ~Arm() {
    kill(process, SIGKILL);
    waitpid(process, nullptr, 0);
  }
  [[nodiscard]] HardwareInfo info() const { return info_at(port); }
  int port = free_port();
  pid_t process = 0;
};

CallbackReturn configure_patiently(ArmlinkSystem& system) {
  for (int i = 0; i < 10; ++i) {
    if (system.on_configure({}) == CallbackReturn::SUCCESS) return CallbackReturn::SUCCESS;
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  return CallbackReturn::ERROR;
}

/// An arm without time: it answers each datagram at once, so that no test hangs on how busy the
/// machine is.
class PromptArm {
 public:
  PromptArm() : socket_(socket(AF_INET, SOCK_DGRAM, 0)) {
    sockaddr_in any = {};
    any.sin_family = AF_INET;
    any.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof any;
    REQUIRE(bind(socket_, reinterpret_cast<sockaddr*>(&any), size) == 0);
    REQUIRE(getsockname(socket_, reinterpret_cast<sockaddr*>(&any), &size) == 0);
    port_ = ntohs(any.sin_port);
    const timeval patience = {0, 20'000};
    setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    thread_ = std::thread([this] { serve(); });
  }
  ~PromptArm() {
    ends = true;
    thread_.join();
    close(socket_);
  }
  [[nodiscard]] HardwareInfo info() const { return info_at(port_); }

  std::atomic<int> status = 0;
  std::atomic<bool> silent = false, ends = false;
  std::atomic<int> torques = 0;    ///< commands of torque that came
  std::atomic<double> last = 0.0;  ///< torque of the first joint
  std::atomic<double> rail_m = 0.0;
  std::atomic<int> mode = ARMLINK_IDLE;

 private:
  void serve() {
    while (!ends) {
      std::uint8_t in[1024];
      sockaddr_in host = {};
      socklen_t size = sizeof host;
      const auto from = reinterpret_cast<sockaddr*>(&host);
      const auto count = static_cast<int>(recvfrom(socket_, in, sizeof in, 0, from, &size));
      const int kind = count > 0 ? armlink_kind(in, count) : 0;
      std::uint8_t out[ARMLINK_HELLO_SIZE];
      if (kind == ARMLINK_ASK) {
        armlink_hello hello = {};
        hello.session = static_cast<std::uint32_t>(armlink_get(in + ARMLINK_AT_SESSION, 4));
        hello.joints = 2;
        hello.flags = ARMLINK_HAS_RAIL;
        hello.modes = 1 << ARMLINK_IDLE | 1 << ARMLINK_TORQUE | 1 << ARMLINK_READY;
        armlink_write_hello(out, &hello);
        sendto(socket_, out, ARMLINK_HELLO_SIZE, 0, from, size);
      }
      armlink_command command = {};
      if (kind != ARMLINK_COMMAND || !armlink_read_command(in, &command)) continue;
      mode = command.mode;
      rail_m = command.rail_m;
      if (command.mode == ARMLINK_TORQUE) ++torques, last = command.values[0];
      if (silent) continue;
      armlink_state state = {};
      state.session = command.session;
      state.sequence = sequence_++;
      state.mode = command.mode;
      state.joints = 2;
      state.status =
          static_cast<std::uint16_t>(status | (command.mode == ARMLINK_READY ? ARMLINK_STANDS : 0));
      if (command.mode == ARMLINK_READY) std::copy_n(command.values, 2, state.q_rad);
      if (command.mode == ARMLINK_TORQUE) {
        std::copy_n(command.values, 2, state.tau_nm);
        std::copy_n(held_, 2, state.q_rad);
      } else {
        std::copy_n(state.q_rad, 2, held_);
      }
      state.wrench_in_tool[2] = -5.0;
      armlink_write_state(out, &state);
      sendto(socket_, out, ARMLINK_STATE_SIZE, 0, from, size);
    }
  }
  int socket_, port_ = 0;
  std::uint32_t sequence_ = 0xFFFF'FFF0U;  ///< goes on from zero soon
  double held_[2] = {};
  std::thread thread_;
};

/// Cycles of the controller manager, until one fails.
int cycles(ArmlinkSystem& system, int count) {
  for (int i = 0; i < count; ++i) {
    if (system.read({}, {}) != return_type::OK || system.write({}, {}) != return_type::OK) return i;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return count;
}

double& value(std::vector<hardware_interface::Interface>& all, const std::string& of,
              const std::string& name) {
  for (auto& one : all)
    if (one.prefix == of && one.name == name) return *one.value;
  FAIL("no interface " << of << "/" << name);
  return *all.front().value;
}

/// An arm that stands ready, and the hardware of ros2_control before it.
struct Ready {
  Ready() {
    REQUIRE(system.on_init(arm.info()) == CallbackReturn::SUCCESS);
    states = system.export_state_interfaces();
    commands = system.export_command_interfaces();
    REQUIRE(system.on_configure({}) == CallbackReturn::SUCCESS);
    REQUIRE(system.on_activate({}) == CallbackReturn::SUCCESS);
    REQUIRE(system.perform_command_mode_switch(efforts, {}) == return_type::OK);
  }
  const std::vector<std::string> efforts = {"one/effort", "two/effort"};
  PromptArm arm;
  ArmlinkSystem system;
  std::vector<hardware_interface::Interface> states, commands;
};

}  // namespace

TEST_CASE("the reference arm of armlink comes to the angles of the URDF") {
  const Arm arm;
  ArmlinkSystem system;
  REQUIRE(system.on_init(arm.info()) == CallbackReturn::SUCCESS);
  auto states = system.export_state_interfaces();
  REQUIRE(configure_patiently(system) == CallbackReturn::SUCCESS);
  REQUIRE(system.on_activate({}) == CallbackReturn::SUCCESS);
  CHECK(value(states, "one", "position") == doctest::Approx(0.1));
  CHECK(value(states, "two", "position") == doctest::Approx(-0.1));
  CHECK(system.on_deactivate({}) == CallbackReturn::SUCCESS);
}

TEST_CASE("torques go to the arm, joints and wrist come from it, and at the end it rests") {
  Ready ready;
  CHECK(ready.states.size() == 2 * 3 + 6);
  CHECK(ready.commands.size() == 2);
  value(ready.commands, "one", "effort") = 2.0;
  CHECK(cycles(ready.system, 100) == 100);
  CHECK(ready.arm.torques > 90);
  CHECK(ready.arm.last == doctest::Approx(2.0));
  CHECK(value(ready.states, "one", "effort") == doctest::Approx(2.0));
  CHECK(value(ready.states, "two", "effort") == doctest::Approx(0.0));
  CHECK(value(ready.states, "wrist", "force.z") == doctest::Approx(-5.0));
  CHECK(ready.system.on_deactivate({}) == CallbackReturn::SUCCESS);
  for (int i = 0; i < 500 && ready.arm.mode != ARMLINK_IDLE; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  CHECK(ready.arm.mode == ARMLINK_IDLE);
}

TEST_CASE("an arm whose efforts nobody claims is held by its own drives, its base where it is") {
  Ready ready;
  CHECK(cycles(ready.system, 10) == 10);
  CHECK(ready.arm.mode == ARMLINK_TORQUE);
  REQUIRE(ready.system.perform_command_mode_switch({}, {"two/effort"}) == return_type::OK);
  CHECK(cycles(ready.system, 150) == 150);
  CHECK(ready.arm.mode == ARMLINK_READY);
  CHECK(value(ready.states, "one", "position") == doctest::Approx(0.1));
  CHECK(ready.arm.rail_m == doctest::Approx(0.4));
  const int before = ready.arm.torques;
  value(ready.commands, "one", "effort") = std::numeric_limits<double>::quiet_NaN();
  CHECK(cycles(ready.system, 10) == 10);
  CHECK(ready.arm.torques == before);
  // The next controller begins with what the arm feels, not with what the last one left.
  REQUIRE(ready.system.perform_command_mode_switch({"two/effort"}, {}) == return_type::OK);
  CHECK(value(ready.commands, "one", "effort") == 0.0);
}

TEST_CASE("a torque that is no number is an error, and is not sent") {
  Ready ready;
  CHECK(cycles(ready.system, 10) == 10);
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  const int before = ready.arm.torques;
  value(ready.commands, "two", "effort") = std::numeric_limits<double>::quiet_NaN();
  CHECK(ready.system.write({}, {}) == return_type::ERROR);
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  CHECK(ready.arm.torques == before);
}

TEST_CASE("an arm that has stopped or has a fault is an error") {
  for (const int status : {ARMLINK_STOPPED, ARMLINK_DRIVE_FAULT, ARMLINK_EMERGENCY_STOP}) {
    Ready ready;
    CHECK(cycles(ready.system, 10) == 10);
    ready.arm.status = status;
    CHECK(cycles(ready.system, 500) < 500);
    CHECK(ready.system.read({}, {}) == return_type::ERROR);
  }
}

TEST_CASE("a silent arm is not driven after three cycles, and is an error after a hundred") {
  Ready ready;
  CHECK(cycles(ready.system, 10) == 10);
  ready.arm.silent = true;
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  (void)ready.system.read({}, {});  // what was on its way
  const int before = ready.arm.torques;
  CHECK(cycles(ready.system, 200) == 99);
  CHECK(ready.arm.torques - before <= 3);
}

TEST_CASE("what the URDF leaves out, and an arm that is not there, are refused") {
  const Arm arm;
  HardwareInfo info = arm.info();
  SUBCASE("no address") {
    info.hardware_parameters.erase("address");
  }
  SUBCASE("a port that is no number") {
    info.hardware_parameters["port"] = "left";
  }
  SUBCASE("no angle to begin at") {
    info.joints[1].parameters.clear();
  }
  SUBCASE("no joint") {
    info.joints.clear();
  }
  SUBCASE("eight joints") {
    info.joints.resize(8, info.joints.front());
  }
  CHECK(ArmlinkSystem().on_init(info) == CallbackReturn::ERROR);
  for (const char* wrong : {"joints", "nobody", "base"}) {
    HardwareInfo other = arm.info();
    if (wrong == std::string("joints")) other.joints.push_back(other.joints.front());
    if (wrong == std::string("base")) other.hardware_parameters.erase("rail_ready");
    if (wrong == std::string("nobody"))
      other.hardware_parameters["port"] = std::to_string(free_port());
    ArmlinkSystem system;
    REQUIRE(system.on_init(other) == CallbackReturn::SUCCESS);
    CHECK(system.on_configure({}) == CallbackReturn::ERROR);
  }
}
