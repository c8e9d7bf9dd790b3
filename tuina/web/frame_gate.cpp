// SPDX-License-Identifier: Apache-2.0
#include "tuina/web/frame_gate.hpp"

#include <algorithm>

#include "tuina/web/ask.hpp"

namespace tuina::web {
namespace {

// A close frame with `message_too_big` (RFC 6455, 5.5.1).
constexpr std::string_view farewell = "\x88\x02\x03\xf1";

struct FrameHeader {
  std::size_t bytes = 2;  ///< of the header itself
  std::uint64_t content_bytes = 0;
};

// RFC 6455, 5.2; nothing: more of it is needed.
std::optional<FrameHeader> read_header(std::string_view given) {
  FrameHeader header;
  if (given.size() < header.bytes) return std::nullopt;
  const auto byte = [&](std::size_t i) { return static_cast<std::uint8_t>(given[i]); };
  constexpr std::uint8_t mask_bit = 0x80, two_bytes = 126, eight_bytes = 127;
  const std::uint8_t length = byte(1) & 0x7fU;
  const std::size_t length_bytes = length == two_bytes ? 2 : length == eight_bytes ? 8 : 0;
  header.bytes += length_bytes + ((byte(1) & mask_bit) != 0 ? 4 : 0);
  if (given.size() < header.bytes) return std::nullopt;
  if (length_bytes == 0) header.content_bytes = length;
  for (std::size_t i = 0; i < length_bytes; ++i)
    header.content_bytes = header.content_bytes << 8U | byte(2 + i);
  return header;
}

}  // namespace

HeadEnd find_head_end(std::string_view request) noexcept {
  for (std::size_t at = request.find('\n'); at != std::string_view::npos;
       at = request.find('\n', at + 1)) {
    const std::string_view before = request.substr(0, at);
    if (!before.ends_with('\r')) return {.broken = true};
    if (before.ends_with("\r\n\r")) return {.at = at + 1};
  }
  return {};
}

void FrameGate::pass(std::string_view bytes, std::string& onwards) {
  while (!bytes.empty() && !shut_) {
    if (left_ > 0) {
      const std::size_t some = std::min<std::uint64_t>(left_, bytes.size());
      onwards.append(bytes.substr(0, some));
      bytes.remove_prefix(some);
      left_ -= some;
      continue;
    }
    header_.push_back(bytes.front());
    bytes.remove_prefix(1);
    const auto header = read_header(header_);
    if (!header) continue;
    shut_ = header->content_bytes > max_message_bytes;
    onwards.append(shut_ ? farewell : std::string_view(header_));
    left_ = header->content_bytes;
    header_.clear();
  }
}

}  // namespace tuina::web
