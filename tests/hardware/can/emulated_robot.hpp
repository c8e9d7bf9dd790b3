// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <deque>
#include <mutex>
#include <thread>

#include "apps/simulated/can/emulated_drive.hpp"
#include "tuina/hardware/can/cia402_robot.hpp"

namespace tuina::tests {

using app::EmulatedDrive;

/// A robot of twelve drives on four buses, three each, at the other ends of pairs of sockets.
class EmulatedRobot {
 public:
  struct Script {
    std::function<void(EmulatedDrive&)> every = {};  ///< before the start, of each drive
    std::function<void(EmulatedDrive&)> setup = {};  ///< before the start, of the left elbow
    /// Of the left elbow before each SYNC: how often it has obeyed a torque, -1 before it does.
    std::function<void(EmulatedDrive&, int cycles, EmulatedRobot&)> cycle = {};
    /// What the left elbow sends; it is not sent where this says false.
    std::function<bool(can_frame&, int cycles)> say = {};
    bool waits = true;  ///< for its host and for a busy machine
  };
  EmulatedRobot() : EmulatedRobot(Script{}) {}
  explicit EmulatedRobot(Script script) : script_(std::move(script)) {
    int node = 0;
    for (const Arm arm : both_arms)
      for (int i = 0; i < 6; ++i)
        file_[arm].joints.push_back({.bus = std::string("can") + char('0' + node / 3),
                                     .node = static_cast<std::uint8_t>(++node),
                                     .counts_per_turn = 4096,
                                     .gear = 100.0,
                                     .rated_torque_nm = 0.6,
                                     .zero_count = 1000 * node,
                                     .reversed = i % 2 == 1});
  }
  ~EmulatedRobot() {
    ends_ = true;
    if (thread_.joinable()) thread_.join();
    for (Bus& bus : buses_)
      if (bus.socket >= 0) ::close(bus.socket);
  }

  [[nodiscard]] const PerArm<hardware::DrivenArm>& file() const { return file_; }
  [[nodiscard]] PerArm<hardware::DrivenArm>& file() { return file_; }
  [[nodiscard]] hardware::CanBuses buses() {
    return {.open = [this](const std::string& name) { return open(name); }, .wait = script_.waits};
  }
  /// The other ends, while the drives stand still between two frames.
  template <typename Look>
  auto look(const Look& look) {
    const std::lock_guard lock(mutex_);
    return look(drives_);
  }
  /// Whatever else is on the bus of the left elbow.
  void say(can_frame frame) { (void)::send(buses_[1].socket, &frame, sizeof frame, MSG_NOSIGNAL); }
  void unplug() {
    ::close(buses_[1].socket);
    buses_[1].socket = -1;
  }

 private:
  struct Bus {
    std::string name;
    int socket = -1;
    std::vector<std::size_t> drives = {};
  };

  Result<hardware::CanBus> open(const std::string& name) {
    std::array<int, 2> ends = {};
    if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()) != 0)
      return fail(Fault::device, "no pair of sockets");
    const std::lock_guard lock(mutex_);
    buses_.push_back({name, ends[1]});
    const int socket = ends[1];
    for (const Arm arm : both_arms) {
      for (std::size_t i = 0; i < file_[arm].joints.size(); ++i) {
        const auto& device = file_[arm].joints[i];
        if (device.bus != name) continue;
        const bool elbow = arm == Arm::left && i == 3;
        buses_.back().drives.push_back(drives_.size());
        drives_.emplace_back(device, [this, socket, elbow](const can_frame& frame) {
          can_frame sent = frame;
          if (elbow && script_.say && !script_.say(sent, cycles_)) return;
          (void)::send(socket, &sent, sizeof sent, MSG_NOSIGNAL | MSG_DONTWAIT);
        });
        if (script_.waits) drives_.back().host_patience_ms = 5000;
        if (script_.every) script_.every(drives_.back());
        if (elbow && script_.setup) script_.setup(drives_.back());
        if (elbow) elbow_ = drives_.size() - 1;
      }
    }
    if (!thread_.joinable()) thread_ = std::thread([this] { live(); });
    return hardware::CanBus(name, ends[0]);
  }

  void live() {
    while (!ends_) {
      std::vector<pollfd> wanted;
      {
        const std::lock_guard lock(mutex_);
        for (const Bus& bus : buses_) wanted.push_back({.fd = bus.socket, .events = POLLIN});
      }
      (void)::poll(wanted.data(), wanted.size(), 1);
      const std::lock_guard lock(mutex_);
      for (std::size_t b = 0; b < buses_.size(); ++b) serve(buses_[b]);
      for (EmulatedDrive& drive : drives_) drive.live();
    }
  }

  void serve(Bus& bus) {
    can_frame frame = {};
    while (::recv(bus.socket, &frame, sizeof frame, MSG_DONTWAIT) == sizeof frame) {
      for (const std::size_t k : bus.drives) {
        if (k == elbow_) cycles_ = drives_[k].cycles_of_torque();
        if (k == elbow_ && frame.can_id == 0x080 && script_.cycle)
          script_.cycle(drives_[k], cycles_, *this);
        drives_[k].take(frame);
      }
    }
  }

  Script script_;
  PerArm<hardware::DrivenArm> file_;
  std::mutex mutex_;
  std::vector<Bus> buses_;
  std::deque<EmulatedDrive> drives_;
  std::size_t elbow_ = 99;
  int cycles_ = -1;
  std::atomic<bool> ends_ = false;
  std::thread thread_;
};

}  // namespace tuina::tests
