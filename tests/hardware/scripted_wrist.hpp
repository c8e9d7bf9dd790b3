// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "tests/hardware/pseudo_terminal.hpp"
#include "tuina/hardware/wrist_device.hpp"

namespace tuina::tests {

/// A force sensor at the other end of a pty or of loopback UDP, as the published documents say what
/// goes over the wire, byte by byte and with nothing of the driver's. The script spoils what it
/// sends from its `from`-th sample on.
class ScriptedWrist {
 public:
  using Kind = hardware::WristDevice::Kind;
  using Bytes = std::vector<std::uint8_t>;
  struct Sample {
    std::uint32_t sequence = 0, counter = 0, status = 0;
    std::array<std::int32_t, 6> counts = {};
  };
  struct Script {
    Kind kind = Kind::hex_serial;
    int from = 0;
    std::function<void(Sample&)> sample = {};                    ///< before it is written
    std::function<void(Bytes&)> bytes = {};                      ///< as they are sent
    std::function<void(std::vector<Bytes>& told)> answers = {};  ///< of its configuration
    std::array<std::int32_t, 6> counts = {100, -200, 300, 10, -20, 30};
    bool quiet = false;      ///< its counts have no noise
    bool unplugged = false;  ///< from there
    bool empty = false;      ///< its datagrams have no bytes, from there
    int rate_hz = 1000;
    int at_once = 1;  ///< samples that come together
  };

  explicit ScriptedWrist(Script script) : script_(std::move(script)) {
    if (script_.kind == Kind::hex_serial) {
      open_line();
    } else {
      open_port();
    }
    thread_ = std::jthread([this](const std::stop_token& stop) { live(stop); });
  }
  ~ScriptedWrist() {
    thread_.request_stop();
    thread_.join();
    unplug();
  }
  ScriptedWrist(const ScriptedWrist&) = delete;
  ScriptedWrist& operator=(const ScriptedWrist&) = delete;

  /// As a device file names it: 50 counts per newton, 1000 per newton metre, axes as the tool's.
  [[nodiscard]] hardware::WristDevice device() const {
    hardware::WristDevice device{.kind = script_.kind, .address = address_};
    if (script_.kind != Kind::hex_serial) device.udp = *hardware::parse_udp_address(address_);
    device.counts_per_n.setConstant(50.0);
    device.counts_per_nm.setConstant(1000.0);
    device.zero_at_start = true;
    return device;
  }
  [[nodiscard]] std::string section(const std::string& arm) const {
    const char* kind = script_.kind == Kind::hex_serial ? "hex_serial"
                       : script_.kind == Kind::hex_udp  ? "hex_udp"
                                                        : "ati_udp";
    return "[wrist_sensor." + arm + "]\nkind = \"" + kind + "\"\naddress = \"" + address_ +
           "\"\ncounts_per_n = [50, 50, 50]\ncounts_per_nm = [1000, 1000, 1000]\n"
           "x = [1, 0, 0]\nz = [0, 0, 1]\nat_mm = [0, 0, 0]\n" +
           (script_.kind == Kind::ati_udp ? "" : "filter = \"150Hz\"\n");
  }
  /// All that it was ever told, one packet after the other.
  [[nodiscard]] std::vector<Bytes> told() const {
    const std::lock_guard lock(mutex_);
    return told_;
  }
  [[nodiscard]] int sent() const { return sent_; }
  /// It has been unplugged.
  [[nodiscard]] bool gone() const { return gone_; }
  void spoil_from_now() { spoils_from_ = sent_.load(); }

 private:
  void open_line() {
    end_ = line_.emplace().end();
    address_ = line_->address();
  }
  void open_port() {
    static std::atomic<int> next = 41'000 + static_cast<int>(getpid() % 8'000);
    end_ = ::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK, 0);
    do {
      address_ = "127.0.0.1:" + std::to_string(next++);
      own_ = hardware::parse_udp_address(address_)->of;
    } while (::bind(end_, reinterpret_cast<const sockaddr*>(&own_), sizeof own_) != 0);
  }
  void unplug() {
    gone_ = true;
    if (!line_ && end_ >= 0) ::close(end_);
    line_.reset();
    end_ = -1;
  }

  static void put(Bytes& bytes, std::uint32_t value, int size) {
    for (int i = size - 1; i >= 0; --i)
      bytes.push_back(static_cast<std::uint8_t>(value >> (8 * i) & 0xFFU));
  }
  static void put_sum(Bytes& bytes) {
    std::uint32_t sum = 0;
    for (const std::uint8_t byte : bytes) sum += byte;
    put(bytes, sum & 0xFFFFU, 2);
  }
  [[nodiscard]] Bytes written(const Sample& sample) const {
    Bytes bytes;
    if (script_.kind == Kind::hex_serial) {
      bytes = {0xAA, 0x07, 0x08, 0x10};
      put(bytes, sample.counter & 0xFFFFU, 2);
      put(bytes, sample.status, 2);
      for (const std::int32_t count : sample.counts)
        put(bytes, static_cast<std::uint32_t>(count) & 0xFFFFU, 2);
      put_sum(bytes);
      return bytes;
    }
    put(bytes, sample.sequence, 4);
    put(bytes, sample.counter, 4);
    put(bytes, sample.status, 4);
    for (const std::int32_t count : sample.counts) put(bytes, static_cast<std::uint32_t>(count), 4);
    return bytes;
  }
  void send(const Bytes& bytes) {
    if (bytes.empty() || end_ < 0) return;
    if (script_.kind == Kind::hex_serial) {
      (void)!::write(end_, bytes.data(), bytes.size());
    } else {
      send_datagram(bytes);
    }
  }
  void send_datagram(const Bytes& bytes) {
    ::sendto(end_, bytes.data(), bytes.size(), MSG_NOSIGNAL,
             reinterpret_cast<const sockaddr*>(&host_), sizeof host_);
  }
  /// Takes what it is told; a HEX at its serial box acknowledges.
  void hear() {
    std::array<std::uint8_t, 256> in;
    socklen_t size = sizeof host_;
    for (;;) {
      const ssize_t got = script_.kind == Kind::hex_serial
                              ? ::read(end_, in.data(), in.size())
                              : ::recvfrom(end_, in.data(), in.size(), 0,
                                           reinterpret_cast<sockaddr*>(&host_), &size);
      if (got < 8) return;
      // Who goes and who comes may both have asked a serial line since: a frame is 9 bytes.
      const ssize_t frame = script_.kind == Kind::hex_serial ? 9 : got;
      for (ssize_t at = 0; at + frame <= got; at += frame) obey({&in[at], &in[at] + frame});
    }
  }
  void obey(const Bytes& in) {
    const std::lock_guard lock(mutex_);
    told_.push_back(in);
    if (script_.kind == Kind::hex_serial) {
      streams_ = in[4] != 0;
      std::vector<Bytes> answers = {{0xAA, 0x00, 0x50, 0x01, 0x00}};
      put_sum(answers[0]);
      if (script_.answers) script_.answers(answers);
      for (const Bytes& answer : answers) send(answer);
    } else if (in[3] == 0x02) {
      streams_ = true;
      sample_.sequence = 0;
    } else if (in[3] == 0x00) {
      streams_ = false;
    }
  }
  void say() {
    ++sample_.sequence;
    sample_.counter += 1;
    sample_.counts = script_.counts;
    // The last counts move as those of a living sensor.
    if (!script_.quiet)
      for (std::size_t i = 0; i < 6; ++i)
        sample_.counts[i] += static_cast<int>((sample_.counter * (3 + i)) % 5) - 2;
    const int number = sent_++;
    const bool spoils = number >= (spoils_from_ >= 0 ? spoils_from_.load() : script_.from);
    Sample said = sample_;
    if (spoils && script_.unplugged) return unplug();
    if (spoils && script_.sample) script_.sample(said);
    Bytes bytes = written(said);
    if (spoils && script_.bytes) script_.bytes(bytes);
    if (spoils && script_.empty) return send_datagram({});
    send(bytes);
  }
  void live(const std::stop_token& stop) {
    using Clock = std::chrono::steady_clock;
    const auto period =
        std::chrono::nanoseconds(1'000'000'000LL * script_.at_once / script_.rate_hz);
    auto next = Clock::now();
    while (!stop.stop_requested()) {
      if (end_ >= 0) hear();
      for (int i = 0; i < script_.at_once && streams_ && end_ >= 0; ++i) say();
      next += period;
      std::this_thread::sleep_until(next);
    }
  }

  Script script_;
  std::string address_;
  sockaddr_in own_ = {}, host_ = {};
  std::optional<PseudoTerminal> line_;
  int end_ = -1;  ///< of the line, or its port
  bool streams_ = false;
  Sample sample_;
  std::atomic<int> sent_ = 0, spoils_from_ = -1;
  std::atomic<bool> gone_ = false;
  mutable std::mutex mutex_;
  std::vector<Bytes> told_;
  std::jthread thread_;
};

}  // namespace tuina::tests
