// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace tuina::web {

/// The status with which a WebSocket is closed whose client has said too much at once (RFC 6455,
/// 7.4.1).
inline constexpr std::uint16_t message_too_big = 1009;
/// A request's head is judged by the server where it has so many bytes and is not at its end.
inline constexpr std::size_t max_head_bytes = 8192;

/// Where the head of an HTTP request ends; nothing: it goes on, or says it with a line end that is
/// not CR LF and so means another end to another reader (`broken`).
struct HeadEnd {
  std::optional<std::size_t> at = {};
  bool broken = false;
};
[[nodiscard]] HeadEnd find_head_end(std::string_view request) noexcept;

/// What the client of a WebSocket says, on its way to a server that takes memory for a whole frame
/// before it looks at it. A frame that announces more than `max_message_bytes` is not handed on: in
/// its place the client takes its leave, with `message_too_big`, and says nothing more.
class FrameGate {
 public:
  /// Adds to `onwards` what may go on of `bytes`, the next ones of the client.
  void pass(std::string_view bytes, std::string& onwards);
  /// Nothing more goes on.
  void shut() noexcept { shut_ = true; }
  [[nodiscard]] bool is_shut() const noexcept { return shut_; }

 private:
  std::string header_;      ///< of a frame, as far as it has come
  std::uint64_t left_ = 0;  ///< of a frame's content
  bool shut_ = false;
};

}  // namespace tuina::web
