// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "apps/serve/live_channels.hpp"
#include "tuina/ros2/node.hpp"

namespace tuina::app {

/// Whatever a session tells while it runs: to programs at the server, and to ROS 2 where a node is
/// there.
class ChannelFork final : public record::ChannelSink {
 public:
  /// Both must outlive the fork; `node` may be null.
  ChannelFork(LiveChannels& channels, ros2::Node* node) : channels_(channels), node_(node) {}

  /// Another session: what was kept of the one before is over, and time begins anew.
  void begin_session() {
    channels_.begin_session();
    if (node_ != nullptr) node_->begin_session();
  }
  [[nodiscard]] std::uint16_t add_channel(const record::ChannelDescription& description) override {
    const std::uint16_t id = channels_.add_channel(description);
    if (node_ == nullptr) return id;
    if (of_node_.size() <= id) of_node_.resize(id + std::size_t{1});
    of_node_[id] = node_->add_channel(description);
    return id;
  }
  void write(std::uint16_t channel, std::uint64_t time_ns, std::string_view message) override {
    channels_.write(channel, time_ns, message);
    if (node_ != nullptr) node_->write(of_node_[channel], time_ns, message);
  }

 private:
  LiveChannels& channels_;
  ros2::Node* node_;
  std::vector<std::uint16_t> of_node_;  ///< its number of each channel
};

}  // namespace tuina::app
