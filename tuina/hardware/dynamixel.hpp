// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tuina/core/result.hpp"
#include "tuina/hardware/serial_port.hpp"

namespace tuina::hardware {

/// Packets of the Dynamixel protocol 1.0 [ax12]: FF FF id length kind parameters check sum. The
/// kind of a packet to a device is its instruction, of one from a device its error bits.
namespace dynamixel {

inline constexpr std::uint8_t ping = 1, read = 2, write = 3;
/// Longest packet that is taken for one.
inline constexpr std::size_t max_parameters = 32;

/// One packet of protocol 1.0.
struct Packet {
  std::uint8_t id = 0;
  std::uint8_t kind = 0;
  std::vector<std::uint8_t> parameters;
  [[nodiscard]] bool operator==(const Packet&) const = default;
};

/// The bytes of a packet, with head, length and check sum.
[[nodiscard]] std::vector<std::uint8_t> encode(const Packet& packet);

/// Finds packets in a stream of bytes; what belongs to none is counted and dropped.
class Reader {
 public:
  /// Takes bytes as they come.
  void add(std::span<const std::uint8_t> bytes);
  /// The next whole packet.
  [[nodiscard]] std::optional<Packet> next();
  [[nodiscard]] int rejected() const { return rejected_; }  ///< packets with a wrong check sum
  [[nodiscard]] int stray() const { return stray_; }        ///< bytes outside of packets
  /// Whether a packet has begun and not ended.
  [[nodiscard]] bool partial() const { return !bytes_.empty(); }

 private:
  std::vector<std::uint8_t> bytes_;
  int rejected_ = 0;
  int stray_ = 0;
};

/// The error bits of a device as words, such as "overload, overheated".
[[nodiscard]] std::string errors_of(std::uint8_t bits);

}  // namespace dynamixel

/// Devices that answer, one at a time, over one serial line.
class DynamixelBus {
 public:
  /// Takes the line, which is open.
  explicit DynamixelBus(SerialPort port) : port_(std::move(port)) {}

  /// Sends a packet and waits for the answer, which has `parameters` of them; an echo of what was
  /// sent is dropped. Fault::device, with what came instead, when there is none in time.
  [[nodiscard]] Result<dynamixel::Packet> ask(const dynamixel::Packet& question,
                                              std::size_t parameters,
                                              std::chrono::milliseconds patience);
  /// The line, for what is no packet.
  [[nodiscard]] SerialPort& port() { return port_; }

 private:
  SerialPort port_;
};

}  // namespace tuina::hardware
