// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <unistd.h>

#include <atomic>
#include <functional>
#include <thread>

#include "tuina/hardware/armlink.hpp"
#include "tuina/hardware/device_file.hpp"
#include "tuina/robot/arm_table.hpp"

namespace tuina::tests {

/// Two arms without a world at the other ends of armlink, which stand still whatever they are told.
/// They wait for their host as simulated arms do, unless they say otherwise. The script spoils what
/// the left one says.
class ScriptedArms {
 public:
  using State = hardware::armlink::State;
  struct Script {
    std::function<void(hardware::armlink::Hello&)> hello = {};
    std::function<void(std::vector<std::byte>&)> hello_sent = {};
    /// Of the state of this sequence; what it leaves in `bytes` is sent.
    std::function<void(State&, std::vector<std::byte>& bytes)> state = {};
    bool waits = true;
    PerArm<Wrench> felt_in_tool = {};  ///< by the wrists, the weight of the tools included
  };
  explicit ScriptedArms(Script script) : script_(std::move(script)) {
    thread_ = std::thread([this] { live(); });
  }
  ~ScriptedArms() {
    ends_ = true;
    thread_.join();
  }
  [[nodiscard]] const PerArm<hardware::ArmDevice>& file() const { return file_; }
  /// The command that arm obeyed last, and the highest torque that was ever asked for.
  [[nodiscard]] std::uint64_t obeyed() const { return obeyed_; }
  /// How many commands have come to both.
  [[nodiscard]] std::uint64_t commands() const { return commands_; }

 private:
  struct End {
    hardware::UdpSocket socket;
    hardware::UdpAddress host = {};
    hardware::armlink::Command last = {};
    State state = {};
  };

  /// Takes free ports from where this process begins to look.
  static hardware::UdpSocket socket_at(hardware::ArmDevice& device) {
    static std::atomic<int> next = 20'000 + static_cast<int>(getpid() % 20'000);
    for (;;) {
      device.address = "127.0.0.1:" + std::to_string(next++);
      device.udp = *hardware::parse_udp_address(device.address);
      if (auto socket = hardware::UdpSocket::listen(device.udp)) return std::move(*socket);
    }
  }

  void say_hello(End& end, const hardware::armlink::Ask& ask, bool is_left) {
    const robot::ArmTable table = robot::thesis_arm();
    hardware::armlink::Hello hello{.session = ask.session, .sequence = ask.sequence, .modes = 11};
    hello.flags = hardware::armlink::flag::has_rail | hardware::armlink::flag::simulated;
    if (script_.waits) hello.flags |= hardware::armlink::flag::waits;
    hello.cycle_us = 1000;
    for (JointVector* limit :
         {&hello.max_torque_nm, &hello.max_speed_rad_per_s, &hello.min_rad, &hello.max_rad})
      limit->resize(table.joints);
    for (int i = 0; i < table.joints; ++i) {
      const robot::Link& link = table.links[static_cast<std::size_t>(i)];
      hello.max_torque_nm[i] = link.torque_limit_nm;
      hello.max_speed_rad_per_s[i] = link.speed_limit_rad_per_s;
      hello.min_rad[i] = link.min_rad, hello.max_rad[i] = link.max_rad;
    }
    hello.min_rail_m = -3.0, hello.max_rail_m = 3.0;
    if (is_left && script_.hello) script_.hello(hello);
    const auto sent = hardware::armlink::encode(hello);
    std::vector<std::byte> bytes(sent.begin(), sent.end());
    if (is_left && script_.hello_sent) script_.hello_sent(bytes);
    if (!bytes.empty()) end.socket.send(bytes, end.host);
  }

  void tell(End& end, bool is_left) {
    State state = end.state;
    auto sent = hardware::armlink::encode(state);
    std::vector<std::byte> bytes(sent.begin(), sent.end());
    if (is_left && script_.state) script_.state(state, bytes);
    if (!bytes.empty()) end.socket.send(bytes, end.host);
  }

  void obey(End& end, const hardware::armlink::Command& command) {
    using hardware::armlink::Mode;
    const bool next = command.mode == Mode::torque && command.answers == end.state.sequence;
    ++commands_;
    end.last = command;
    end.state.session = command.session;
    end.state.answers = command.sequence;
    end.state.mode = command.mode;
    if (command.mode == Mode::ready) {
      end.state.status = hardware::armlink::status::stands;
      end.state.q_rad = command.values;
      end.state.dq_rad_per_s = end.state.tau_nm = JointVector::Zero(command.values.size());
    }
    end.state.rail_m = command.rail_m;
    if (!next) return;
    ++obeyed_;
    end.state.status = 0;
    ++end.state.sequence;
    end.state.time_s += 1e-3;
    end.state.wrench_time_s = end.state.time_s - 1e-3;
    end.state.wrench_in_tool.torque_nm.z() += 1e-9;
  }

  void live() {
    using namespace std::chrono_literals;
    for (const Arm arm : both_arms)
      ends_of_[arm == Arm::left ? 0 : 1].state.wrench_in_tool = script_.felt_in_tool[arm];
    while (!ends_) {
      const std::array sockets = {ends_of_[0].socket.number(), ends_of_[1].socket.number()};
      hardware::wait_for_datagram(sockets, std::chrono::steady_clock::now() + 5ms);
      for (std::size_t i = 0; i < 2; ++i) {
        End& end = ends_of_[i];
        std::array<std::byte, hardware::armlink::max_size + 1> in;
        while (const auto size = end.socket.receive(in, &end.host)) {
          const hardware::armlink::Bytes bytes(in.data(), *size);
          if (const auto ask = hardware::armlink::decode_ask(bytes)) say_hello(end, *ask, i == 0);
          if (const auto command = hardware::armlink::decode_command(bytes)) obey(end, *command);
        }
        if (end.last.session != 0) tell(end, i == 0);
      }
    }
  }

  Script script_;
  PerArm<hardware::ArmDevice> file_;
  std::array<End, 2> ends_of_ = {End{socket_at(file_[Arm::left])},
                                 End{socket_at(file_[Arm::right])}};
  std::atomic<bool> ends_ = false;
  std::atomic<std::uint64_t> commands_ = 0;
  std::atomic<std::uint64_t> obeyed_ = 0;
  std::thread thread_;
};

}  // namespace tuina::tests
