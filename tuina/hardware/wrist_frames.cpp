// SPDX-License-Identifier: Apache-2.0
#include "tuina/hardware/wrist_frames.hpp"

#include <algorithm>
#include <numeric>

namespace tuina::hardware {
namespace {

std::uint32_t big_endian(std::span<const std::uint8_t> bytes) noexcept {
  std::uint32_t value = 0;
  for (const std::uint8_t byte : bytes) value = value << 8 | byte;
  return value;
}

/// Whether the last two bytes are the sum of those before them.
bool sums_up(std::span<const std::uint8_t> frame) noexcept {
  const auto body = frame.first(frame.size() - 2);
  return (std::accumulate(body.begin(), body.end(), 0U) & 0xFFFFU) == big_endian(frame.last(2));
}

}  // namespace

namespace hex_serial {
namespace {

constexpr std::array<std::uint8_t, 3> data_mark = {0xAA, 0x07, 0x08};
constexpr std::array<std::uint8_t, 4> answer_mark = {0xAA, 0x00, 0x50, 0x01};

/// Whether `bytes` begin with `mark`, as far as they go.
bool may_begin(std::span<const std::uint8_t> bytes, std::span<const std::uint8_t> mark) noexcept {
  const std::size_t shared = std::min(bytes.size(), mark.size());
  return std::equal(mark.begin(), mark.begin() + static_cast<std::ptrdiff_t>(shared),
                    bytes.begin());
}

WristSample sample_of(std::span<const std::uint8_t> frame) noexcept {
  WristSample sample;
  sample.sequence = sample.counter = big_endian(frame.subspan(4, 2));
  sample.status = big_endian(frame.subspan(6, 2));
  for (std::size_t i = 0; i < sample.counts.size(); ++i)
    sample.counts[i] = static_cast<std::int16_t>(big_endian(frame.subspan(8 + 2 * i, 2)));
  return sample;
}

}  // namespace

std::array<std::uint8_t, config_size> encode_config(std::uint8_t speed, std::uint8_t filter,
                                                    std::uint8_t zero) noexcept {
  std::array<std::uint8_t, config_size> frame = {0xAA, 0x00, 0x32, 0x03, speed, filter, zero};
  const unsigned sum = std::accumulate(frame.begin(), frame.end() - 2, 0U);
  frame[7] = static_cast<std::uint8_t>(sum >> 8);
  frame[8] = static_cast<std::uint8_t>(sum & 0xFFU);
  return frame;
}

std::span<std::uint8_t> Reader::room() noexcept {
  std::copy(bytes_.begin() + static_cast<std::ptrdiff_t>(begin_),
            bytes_.begin() + static_cast<std::ptrdiff_t>(end_), bytes_.begin());
  end_ -= begin_;
  begin_ = 0;
  return std::span(bytes_).subspan(end_);
}

void Reader::took(std::size_t bytes) noexcept {
  end_ = std::min(end_ + bytes, bytes_.size());
}

std::optional<WristSample> Reader::next() noexcept {
  for (; begin_ < end_; skip(1), ++spoilt_) {
    const auto left = std::span<const std::uint8_t>(bytes_).subspan(begin_, end_ - begin_);
    if (may_begin(left, answer_mark)) {
      if (left.size() < answer_size) return std::nullopt;
      if (!sums_up(left.first(answer_size))) continue;
      answer_ = left[answer_mark.size()];
      skip(answer_size - 1);
      --spoilt_;
      continue;
    }
    if (!may_begin(left, data_mark)) continue;
    if (left.size() <= data_mark.size()) return std::nullopt;
    const std::uint8_t size = left[data_mark.size()];
    if (size == axes_3 || size == channels_4) other_ = size;
    if (size != axes_6) continue;
    if (left.size() < frame_size) return std::nullopt;
    if (!sums_up(left.first(frame_size))) continue;
    skip(frame_size);
    spoilt_ = 0;
    return sample_of(left);
  }
  return std::nullopt;
}

}  // namespace hex_serial

namespace rdt {

std::array<std::byte, request_size> encode(Command command, std::uint32_t data) noexcept {
  const std::uint64_t all =
      std::uint64_t{0x1234} << 48 | std::uint64_t{static_cast<std::uint16_t>(command)} << 32 | data;
  std::array<std::byte, request_size> bytes;
  for (std::size_t i = 0; i < bytes.size(); ++i)
    bytes[i] = static_cast<std::byte>(all >> (56 - 8 * i) & 0xFFU);
  return bytes;
}

std::optional<WristSample> decode(std::span<const std::byte> datagram) noexcept {
  if (datagram.size() != record_size) return std::nullopt;
  const auto word = [&](std::size_t index) {
    std::uint32_t value = 0;
    for (const std::byte byte : datagram.subspan(4 * index, 4))
      value = value << 8 | std::to_integer<std::uint32_t>(byte);
    return value;
  };
  WristSample sample{.sequence = word(0), .counter = word(1), .status = word(2)};
  for (std::size_t i = 0; i < sample.counts.size(); ++i)
    sample.counts[i] = static_cast<std::int32_t>(word(3 + i));
  return sample;
}

}  // namespace rdt
}  // namespace tuina::hardware
