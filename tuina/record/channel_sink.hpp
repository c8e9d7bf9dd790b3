// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "tuina/telemetry/mcap/records.hpp"

namespace tuina::record {

/// A stream of messages of one kind.
struct ChannelDescription {
  std::string topic;
  std::string encoding;  ///< of its messages: "cdr" or "json"
  telemetry::mcap::Schema schema;
  bool latched = false;  ///< its last message is also for those who come later
};

/// Takes the messages of a session: a record, or somebody who looks on from another program.
class ChannelSink {
 public:
  virtual ~ChannelSink() = default;
  /// Called once for each topic, before its first message. Returns the id of the channel, which is
  /// not 0.
  [[nodiscard]] virtual std::uint16_t add_channel(const ChannelDescription& description) = 0;
  /// `message` lives during the call. Times are those of the session and rise on each channel.
  virtual void write(std::uint16_t channel, std::uint64_t time_ns, std::string_view message) = 0;

 protected:
  ChannelSink() = default;
  ChannelSink(const ChannelSink&) = default;
  ChannelSink& operator=(const ChannelSink&) = default;
};

}  // namespace tuina::record
