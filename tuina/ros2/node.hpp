// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "tuina/core/result.hpp"
#include "tuina/record/channel_sink.hpp"
#include "tuina/ros2/services.hpp"

namespace tuina::ros2 {

/// Who may hear a node.
enum class Reach : std::uint8_t {
  host,  ///< programs on this machine, through its loopback
  lan,   ///< as Cyclone DDS is set up, by CYCLONEDDS_URI or by itself: the whole network
};

/// What became of the messages of a node.
struct Traffic {
  std::size_t topics = 0;
  std::size_t readers = 0;  ///< of these topics, now
  std::uint64_t messages = 0;
  std::uint64_t dropped = 0;  ///< of these; some reader had not taken those before in time
  std::string first_fault;    ///< why the first one was dropped; empty: none was
};

/// Publishes the messages of a session as a node of ROS 2 does (docs/ros2.md): JSON as
/// std_msgs/String, and the time of the session as `/clock`. `write` takes ten microseconds or so
/// and a system call, so it belongs behind a `Relay`; no reader, however slow, makes it wait.
class Node : public record::ChannelSink {
 public:
  [[nodiscard]] virtual Traffic traffic() const = 0;  ///< messages sent since the start
  /// Another session of the same program begins, at time zero: what was latched of the one before
  /// is given to nobody any more. Not beside `write`.
  virtual void begin_session() = 0;
  /// Services by these names, as `/tuina/stop`. They end before the node.
  [[nodiscard]] virtual Result<std::unique_ptr<Services>> offer(
      std::span<const std::string> names) = 0;
};

/// A node in that domain ([rtps] 9.6.1.1), as ROS_DOMAIN_ID says it. A process has one in each
/// domain. Before it ends it gives readers a second to take what it has written. Fails where this
/// build has no DDS, and with what DDS says.
[[nodiscard]] Result<std::unique_ptr<Node>> open_node(std::uint32_t domain, Reach reach);

}  // namespace tuina::ros2
