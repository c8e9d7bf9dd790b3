// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace tuina::hardware {

/// One sample of a force sensor, as it stands on the wire.
struct WristSample {
  std::uint32_t sequence = 0;               ///< of what is sent; by serial line its low 16 bits
  std::uint32_t counter = 0;                ///< of what is measured; by serial line the same
  std::uint32_t status = 0;                 ///< 0: all is well
  std::array<std::int32_t, 6> counts = {};  ///< force x, y, z, torque x, y, z
  [[nodiscard]] bool operator==(const WristSample&) const = default;
};

/// The serial line of an OptoForce HEX [optoforce]: 1 Mbit/s, 8N1, big-endian, each frame with the
/// sum of all its bytes at its end.
namespace hex_serial {

inline constexpr std::size_t frame_size = 22, config_size = 9, answer_size = 7;
inline constexpr std::uint8_t speed_1000_hz = 1, keep_no_zero = 0;
inline constexpr std::uint8_t axes_3 = 10, axes_6 = 16, channels_4 = 28;  ///< bytes of a sample

/// `filter`: 0 none, 1 to 6 for 500, 150, 50, 15, 5 and 1.5 Hz.
[[nodiscard]] std::array<std::uint8_t, config_size> encode_config(std::uint8_t speed,
                                                                  std::uint8_t filter,
                                                                  std::uint8_t zero) noexcept;

/// Finds frames in a stream of bytes, whatever stands between them. Takes no heap.
class Reader {
 public:
  /// Where the next bytes belong; never empty once `next` has said nothing.
  [[nodiscard]] std::span<std::uint8_t> room() noexcept;
  /// So many bytes stand there now.
  void took(std::size_t bytes) noexcept;
  /// Nothing where more bytes are needed.
  [[nodiscard]] std::optional<WristSample> next() noexcept;
  /// Forgets bytes that have no whole frame yet.
  void clear() noexcept { *this = {}; }

  /// Bytes since the last frame that belong to none.
  [[nodiscard]] std::size_t spoilt_bytes() const noexcept { return spoilt_; }
  /// The error byte of the answer to a configuration, where one has come: 0 is obeyed.
  [[nodiscard]] std::optional<std::uint8_t> answer() const noexcept { return answer_; }
  /// The size of the last frame that is of another kind of sensor; 0 where none has come.
  [[nodiscard]] std::uint8_t other_axes() const noexcept { return other_; }

 private:
  void skip(std::size_t bytes) noexcept { begin_ += bytes; }
  std::array<std::uint8_t, 1024> bytes_ = {};
  std::size_t begin_ = 0, end_ = 0, spoilt_ = 0;
  std::optional<std::uint8_t> answer_;
  std::uint8_t other_ = 0;
};

}  // namespace hex_serial

/// Raw data transfer of ATI Net F/T and Axia [ati_axia], which OptoForce's and OnRobot's Ethernet
/// boxes speak too: datagrams to port 49152, big-endian.
namespace rdt {

inline constexpr std::size_t request_size = 8, record_size = 36;
/// What a request of RDT asks for; the number is the protocol's.
enum class Command : std::uint16_t {
  stop = 0,
  start = 2,      ///< data: how many samples, 0 without end
  bias = 0x42,    ///< OptoForce: 255 on, 0 off; ATI knows only on
  filter = 0x81,  ///< OptoForce only: as by serial line
  period = 0x82,  ///< OptoForce only: milliseconds from sample to sample
};
/// The bytes of a request.
[[nodiscard]] std::array<std::byte, request_size> encode(Command command,
                                                         std::uint32_t data) noexcept;
/// Nothing unless it has the size of one record.
[[nodiscard]] std::optional<WristSample> decode(std::span<const std::byte> datagram) noexcept;

}  // namespace rdt

}  // namespace tuina::hardware
