// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <linux/can.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <vector>

#include "tuina/hardware/can/drive_device.hpp"

namespace tuina::app {

/// A drive of CiA 402 from the other side: its dictionary, by which all it does can be asked and
/// set, its states, its PDOs as they are mapped, a motor with a flywheel. It writes its bytes by
/// itself, knowing nothing of the driver's. Time goes by the SYNC, but for heartbeats.
class EmulatedDrive {
 public:
  struct Entry {
    int bytes = 4;
    std::uint32_t value = 0;
    bool writable = true;
  };
  using Send = std::function<void(const can_frame&)>;

  EmulatedDrive(const hardware::DriveDevice& device, Send send)
      : device_(device), send_(std::move(send)) {
    const auto fixed = [](std::uint32_t value, int bytes = 4) {
      return Entry{bytes, value, false};
    };
    entries_ = {
        {{0x1000, 0}, fixed(0x00020192)},
        {{0x1016, 1}, {}},
        {{0x1017, 0}, {2}},
        {{0x1018, 1}, fixed(0xFB)},
        {{0x1018, 2}, fixed(0x61500000)},
        {{0x1018, 4}, fixed(1000U + device.node)},
        {{0x603F, 0}, fixed(0, 2)},
        {{0x6007, 0}, {2}},
        {{0x6040, 0}, {2}},
        {{0x6041, 0}, fixed(0x40, 2)},
        {{0x605A, 0}, {2, 2}},
        {{0x6060, 0}, {1}},
        {{0x6064, 0}, fixed(0)},
        {{0x6065, 0}, {4, 2000}},
        {{0x6071, 0}, {2}},
        {{0x6072, 0}, {2, 1000}},
        {{0x6076, 0}, fixed(static_cast<std::uint32_t>(std::lround(1e3 * device.rated_torque_nm)))},
        {{0x6077, 0}, fixed(0, 2)},
        {{0x607A, 0}, {}},
        {{0x60C2, 1}, {1, 1}},
        {{0x60C2, 2}, {1, 0xFD}}};
    for (const int pdo : {0x1400, 0x1401, 0x1800, 0x1801}) {
      entries_[{pdo, 1}] = {4, pdo == 0x1801 ? 0x40000280U + device.node : 0x80000000U};
      entries_[{pdo, 2}] = {1, 255};
      for (int sub = 0; sub <= 4; ++sub) entries_[{pdo + 0x200, sub}] = {sub == 0 ? 1 : 4};
    }
    value(0x6064) = value(0x607A) = static_cast<std::uint32_t>(device.zero_count);
    counts_ = device.zero_count;
  }

  /// A value of the dictionary; zero where it has been forgotten.
  std::uint32_t& value(int index, int sub = 0) {
    const auto found = entries_.find({index, sub});
    return found != entries_.end() ? found->second.value : nothing_ = 0;
  }
  void forget(int index, int sub = 0) { entries_.erase({index, sub}); }
  void place_at(double q_rad) {
    counts_ = device_.zero_count + q_rad * device_.counts_per_rad();
    value(0x6064) = value(0x607A) = static_cast<std::uint32_t>(std::lround(counts_));
  }
  /// Something else than its own flywheel turns it; where it should be stays.
  void turn_to(double q_rad) { counts_ = device_.zero_count + q_rad * device_.counts_per_rad(); }
  void report(std::uint16_t code) {
    const auto low = static_cast<std::uint8_t>(code), high = static_cast<std::uint8_t>(code >> 8);
    send_({.can_id = 0x080U + device_.node, .can_dlc = 8, .data = {low, high, 0x20}});
  }
  void fall_into_fault(std::uint16_t code) {
    value(0x603F) = code;
    status_ = 0x08;
    value(0x6041) = status_;
    report(code);
  }
  void say_heartbeat(std::uint8_t state) {
    send_({.can_id = 0x700U + device_.node, .can_dlc = 1, .data = {state}});
  }
  void lose_power() {
    powered = false;
    status_ = 0x40;
  }
  void fall_into_fault_silently() { status_ = 0x08; }
  void stop_by_itself() {
    powered = false;
    status_ = value(0x6041) = 0x07;
  }

  double inertia_kg_m2 = 0.0;  ///< of the joint; 0: it stands still whatever the torque
  bool blocked = false;        ///< where it is, while it should hold another place
  bool stays_in_fault = false;
  bool powered = true;       ///< its motor's supply
  int host_patience_ms = 0;  ///< instead of what the host has set, for machines that are busy

  [[nodiscard]] bool enabled() const { return status_ == 0x27; }
  [[nodiscard]] std::uint8_t mode() { return static_cast<std::uint8_t>(value(0x6060)); }
  [[nodiscard]] double q_rad() const {
    return (counts_ - device_.zero_count) / device_.counts_per_rad();
  }
  /// Whether its motor does what torques it is ordered, and which one at the joint since the SYNC.
  [[nodiscard]] bool obeys_torques() { return enabled() && mode() == 10; }
  [[nodiscard]] double torque_nm() {
    return 1e-3 * static_cast<std::int16_t>(value(0x6077)) * device_.rated_torque_at_joint_nm();
  }
  [[nodiscard]] int cycles_of_torque() const { return cycles_of_torque_; }
  [[nodiscard]] const hardware::DriveDevice& device() const { return device_; }

  void take(const can_frame& frame) {
    if (frame.can_id == 0x080) return synchronise();
    if (frame.can_id == 0x000 && (frame.data[1] == device_.node || frame.data[1] == 0))
      network_ = frame.data[0] == 1 ? 5 : frame.data[0] == 128 ? 127 : network_;
    if (frame.can_id == 0x77F) host_heard_ = std::chrono::steady_clock::now();
    if (frame.can_id == 0x600U + device_.node) answer(frame);
    for (const int pdo : {0x1400, 0x1401})
      if (network_ == 5 && value(pdo, 1) == frame.can_id) staged_.emplace_back(pdo, frame);
  }

  /// What goes by the clock and not by the SYNC.
  void live() {
    using namespace std::chrono;
    const auto now = steady_clock::now();
    const auto told_every = milliseconds(value(0x1017));
    if (told_every.count() > 0 && now > told_at_ + told_every) {
      told_at_ = now;
      say_heartbeat(network_);
    }
    const std::uint32_t wanted = value(0x1016, 1) & 0xFFFFU;
    const auto patience =
        milliseconds(host_patience_ms > 0 ? host_patience_ms : static_cast<int>(wanted));
    if (wanted == 0 || !host_heard_ || now < *host_heard_ + patience) return;
    host_heard_.reset();
    if (value(0x6007) == 3) fall_into_fault(0x8130);
  }

 private:
  static std::uint32_t read(const can_frame& frame, int at, int bytes) {
    std::uint32_t number = 0;
    for (int i = 0; i < bytes; ++i) number |= std::uint32_t{frame.data[at + i]} << (8 * i);
    return number;
  }
  static void write(can_frame& frame, int at, int bytes, std::uint32_t number) {
    for (int i = 0; i < bytes; ++i)
      frame.data[at + i] = static_cast<std::uint8_t>(number >> (8 * i));
  }

  void answer(const can_frame& asked) {
    can_frame reply = asked;
    reply.can_id = 0x580U + device_.node;
    const auto refuse = [&](std::uint32_t why) {
      reply.data[0] = 0x80;
      write(reply, 4, 4, why);
      send_(reply);
    };
    const auto found = entries_.find({static_cast<int>(read(asked, 1, 2)), asked.data[3]});
    if (found == entries_.end()) return refuse(0x06020000);
    Entry& entry = found->second;
    const auto index = found->first.first;
    if (asked.data[0] == 0x40) {
      reply.data[0] = entry.bytes == 1 ? 0x4F : entry.bytes == 2 ? 0x4B : 0x43;
      write(reply, 4, 4, entry.value);
      return send_(reply);
    }
    const int bytes = asked.data[0] == 0x2F ? 1 : asked.data[0] == 0x2B ? 2 : 4;
    if (bytes != entry.bytes) return refuse(0x06070010);
    if (!entry.writable) return refuse(0x06010002);
    const std::uint32_t wanted = read(asked, 4, bytes);
    if (index == 0x6072 && wanted > 5000) return refuse(0x06090030);
    const bool mapping = (index & 0xFE00) == 0x1600 || (index & 0xFE00) == 0x1A00;
    if (mapping && (value(index - 0x200, 1) >> 31U) == 0) return refuse(0x08000022);
    entry.value = wanted;
    write(reply, 4, 4, 0);
    reply.data[0] = 0x60;
    send_(reply);
    if (index == 0x6040) obey_control();
  }

  /// Each object of the PDO in turn: index, sub-index, bits.
  void each_mapped(int pdo, const std::function<void(std::uint32_t& value, int bytes)>& what) {
    for (int sub = 1; sub <= static_cast<int>(value(pdo + 0x200, 0)); ++sub) {
      const std::uint32_t mapped = value(pdo + 0x200, sub);
      what(value(static_cast<int>(mapped >> 16U), static_cast<int>(mapped >> 8U & 0xFFU)),
           static_cast<int>(mapped & 0xFFU) / 8);
    }
  }

  void synchronise() {
    for (const auto& [pdo, frame] : staged_) {
      int at = 0;
      each_mapped(pdo, [&, &from = frame](std::uint32_t& into, int bytes) {
        into = read(from, at, bytes);
        at += bytes;
      });
    }
    if (!staged_.empty()) obey_control();
    staged_.clear();
    move();
    if (network_ != 5 || (value(0x1800, 1) >> 31U) != 0 || value(0x1800, 2) != 1) return;
    can_frame told = {.can_id = value(0x1800, 1) & 0x7FFU};
    each_mapped(0x1800, [&](std::uint32_t& from, int bytes) {
      write(told, told.can_dlc, bytes, from);
      told.can_dlc = static_cast<std::uint8_t>(told.can_dlc + bytes);
    });
    send_(told);
  }

  /// The transitions of [cia402] that a control word asks for.
  void obey_control() {
    const std::uint32_t word = value(0x6040);
    if (status_ == 0x07 && !powered) return;
    if (status_ == 0x08) {
      if (word == 0x80 && !stays_in_fault) status_ = 0x40;
    } else if ((word & 0x02U) == 0 || !powered) {
      status_ = 0x40;
    } else if ((word & 0x04U) == 0) {
      status_ = status_ == 0x27 ? 0x07 : 0x40;
      value(0x607A) = value(0x6064);
    } else if ((word & 0x0FU) == 0x06) {
      status_ = 0x21;
    } else if ((word & 0x0FU) == 0x07) {
      status_ = status_ == 0x40 ? status_ : 0x23;
    } else if ((word & 0x0FU) == 0x0F) {
      status_ = status_ == 0x23 || status_ == 0x27 ? 0x27 : status_;
    }
    value(0x6041) = status_;
  }

  void move() {
    const bool torque = enabled() && mode() == 10;
    cycles_of_torque_ = torque ? cycles_of_torque_ + 1 : -1;
    const auto target = static_cast<std::int32_t>(value(0x607A));
    if (enabled() && mode() == 8 && !blocked) counts_ = target;
    const auto limit = static_cast<std::int16_t>(value(0x6072));
    const auto ordered = static_cast<std::int16_t>(value(0x6071));
    const int permille = torque ? std::clamp<int>(ordered, -limit, limit) : 0;
    if (torque && inertia_kg_m2 > 0.0) {
      const double nm = 1e-3 * permille * device_.rated_torque_at_joint_nm();
      speed_rad_per_s_ += 1e-3 * nm / inertia_kg_m2;
      counts_ += 1e-3 * speed_rad_per_s_ * device_.counts_per_rad();
    }
    value(0x6064) = static_cast<std::uint32_t>(static_cast<std::int32_t>(std::lround(counts_)));
    value(0x6077) = static_cast<std::uint16_t>(permille);
    if (enabled()) value(0x6041) = status_ | 0x1000U;
    const double behind = std::abs(target - counts_);
    if (enabled() && mode() == 8 && behind > value(0x6065)) fall_into_fault(0x8611);
  }

  hardware::DriveDevice device_;
  Send send_;
  std::map<std::pair<int, int>, Entry> entries_;
  std::uint32_t status_ = 0x40, nothing_ = 0;
  std::uint8_t network_ = 127;
  std::vector<std::pair<int, can_frame>> staged_;
  std::optional<std::chrono::steady_clock::time_point> host_heard_;
  std::chrono::steady_clock::time_point told_at_;
  double counts_ = 0.0, speed_rad_per_s_ = 0.0;
  int cycles_of_torque_ = -1;
};

}  // namespace tuina::app
