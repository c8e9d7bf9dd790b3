// SPDX-License-Identifier: Apache-2.0
#include "tuina/hardware/dynamixel.hpp"

#include <algorithm>
#include <array>
#include <numeric>

namespace tuina::hardware {
namespace dynamixel {
namespace {

constexpr std::uint8_t mark = 0xFF;
constexpr std::size_t overhead = 6;  // two marks, id, length, kind, check sum

// Over id, length, kind and parameters.
std::uint8_t check_sum(std::span<const std::uint8_t> bytes) {
  return static_cast<std::uint8_t>(~std::accumulate(bytes.begin(), bytes.end(), 0U));
}

}  // namespace

std::vector<std::uint8_t> encode(const Packet& packet) {
  std::vector<std::uint8_t> bytes;
  bytes.reserve(packet.parameters.size() + overhead);
  const auto length = static_cast<std::uint8_t>(packet.parameters.size() + 2);
  for (const std::uint8_t byte : {mark, mark, packet.id, length, packet.kind})
    bytes.push_back(byte);
  for (const std::uint8_t byte : packet.parameters) bytes.push_back(byte);
  bytes.push_back(check_sum(std::span(bytes).subspan(2)));
  return bytes;
}

void Reader::add(std::span<const std::uint8_t> bytes) {
  bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
}

std::optional<Packet> Reader::next() {
  const auto drop = [this](std::size_t count) {
    bytes_.erase(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(count));
  };
  while (bytes_.size() >= 2) {
    const bool begins = bytes_[0] == mark && bytes_[1] == mark;
    const bool third_mark = begins && bytes_.size() > 2 && bytes_[2] == mark;  // no id is 255
    const std::size_t length = bytes_.size() > 3 ? bytes_[3] : 2;
    if (!begins || third_mark || length < 2 || length > max_parameters + 2) {
      drop(1);
      ++stray_;
      continue;
    }
    const std::size_t size = overhead - 2 + length;
    if (bytes_.size() < size) return std::nullopt;
    const std::span<const std::uint8_t> whole(bytes_.data(), size);
    if (check_sum(whole.subspan(2, size - 3)) != whole.back()) {
      ++rejected_;
      drop(1);
      continue;
    }
    Packet packet{
        .id = whole[2], .kind = whole[4], .parameters = {whole.begin() + 5, whole.end() - 1}};
    drop(size);
    return packet;
  }
  return std::nullopt;
}

std::string errors_of(std::uint8_t bits) {
  constexpr std::array<const char*, 7> words = {"voltage out of range",
                                                "angle out of range",
                                                "overheated",
                                                "value out of range",
                                                "check sum of the question wrong",
                                                "overload",
                                                "instruction unknown"};
  std::string all;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if ((bits >> i & 1U) == 0U) continue;
    all += (all.empty() ? "" : ", ") + std::string(words[i]);
  }
  return all;
}

}  // namespace dynamixel

Result<dynamixel::Packet> DynamixelBus::ask(const dynamixel::Packet& question,
                                            std::size_t parameters,
                                            std::chrono::milliseconds patience) {
  // A late answer to an earlier question must not be taken for the answer to this one.
  port_.forget();
  const auto deadline = SerialPort::Clock::now() + patience;
  if (const auto sent = port_.write(dynamixel::encode(question), deadline); !sent)
    return tl::unexpected(sent.error());
  dynamixel::Reader reader;
  std::string strange;
  for (;;) {
    std::array<std::uint8_t, 256> bytes;
    const auto size = port_.read(bytes, deadline);
    if (!size) return tl::unexpected(size.error());
    reader.add({bytes.data(), *size});
    while (const auto packet = reader.next()) {
      if (*packet == question) continue;  // the echo of a line whose ends are joined
      if (packet->id != question.id)
        strange = fmt::format(", but device {} did", packet->id);
      else if (packet->parameters.size() != parameters && packet->kind == 0)
        strange = fmt::format(", but with {} bytes where {} belong", packet->parameters.size(),
                              parameters);
      else
        return *packet;
    }
    if (SerialPort::Clock::now() >= deadline) break;
  }
  if (strange.empty() && reader.rejected() > 0)
    strange = ", but bytes with a wrong check sum came: is the line too long or its speed wrong?";
  else if (strange.empty() && reader.stray() > 0)
    strange = ", but bytes came that are no packet: is it another device, or the speed wrong?";
  else if (strange.empty() && reader.partial())
    strange = ", but the beginning of a packet came";
  return fail(Fault::device, "{}: device {} did not answer within {} ms{}", port_.address(),
              question.id, patience.count(), strange);
}

}  // namespace tuina::hardware
