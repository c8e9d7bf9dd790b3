// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <string>

namespace tuina::web {

/// What a page is told of again and again. Of each, only the newest counts.
enum class Channel : std::uint8_t { state, live };

/// What waits to be sent to one page: the newest of each channel, and replies in their order. Who
/// puts something in never waits; a page that reads slowly misses what was not the newest.
class Outbox {
 public:
  void put(Channel channel, std::string text);
  /// False when more replies wait than an honest page ever leaves: it does not read any more.
  [[nodiscard]] bool reply(std::string text);
  /// Waits for the next text; nothing after `close`.
  [[nodiscard]] std::optional<std::string> take();
  void close();

 private:
  static constexpr std::size_t max_replies = 64;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::array<std::optional<std::string>, 2> newest_;
  std::deque<std::string> replies_;
  bool closed_ = false;
};

}  // namespace tuina::web
