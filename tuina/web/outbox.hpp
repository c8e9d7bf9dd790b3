// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <mutex>
#include <optional>
#include <string>

namespace tuina::web {

/// One message of a WebSocket, either way. A ping comes back as a pong with the same bytes.
struct Frame {
  /// Text, bytes or a sign of life.
  enum class Kind : std::uint8_t { text, binary, ping, pong };
  Kind kind = Kind::text;
  std::string bytes;
};

/// What waits to be sent to one client: replies in their order, and what is told again and again,
/// each kind of it in a slot of its own that keeps the newest. Who puts something in never waits; a
/// client that reads slowly misses what was not the newest.
class Outbox {
 public:
  /// Number of a stream of frames of which only the newest count.
  using Slot = std::uint32_t;
  /// `keep` newest frames of the slot wait at most.
  void put(Slot slot, Frame frame, std::size_t keep = 1);
  /// What waits in the slot is not sent any more.
  void drop(Slot slot);
  /// False when more replies wait than an honest client ever leaves: it does not read any more.
  [[nodiscard]] bool reply(Frame frame);
  /// Waits for the next frame: replies first, then slot after slot in turn; nothing after `close`.
  [[nodiscard]] std::optional<Frame> take();
  /// No frame goes out any more, and `take` returns.
  void close();

 private:
  static constexpr std::size_t max_replies = 64;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::map<Slot, std::deque<Frame>> slots_;  ///< those in which something waits
  Slot last_ = 0;                            ///< slot that was sent from last
  std::deque<Frame> replies_;
  bool closed_ = false;
};

}  // namespace tuina::web
