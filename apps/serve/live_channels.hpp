// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "tuina/record/channel_sink.hpp"
#include "tuina/web/desk.hpp"
#include "tuina/web/foxglove.hpp"

namespace tuina::app {

/// The channels of a session's record for programs that watch while it runs
/// (`web::foxglove`). Of joints, poses and pictures a client that reads slowly gets the newest; of
/// what happens, the newest 64 messages of each channel. All of it may be called from any thread.
class LiveChannels final : public record::ChannelSink {
 public:
  /// Ways to a client; none of them waits (`web::Server`).
  struct Door {
    std::function<void(web::ClientId, web::Frame)> reply;
    std::function<void(web::ClientId, web::Outbox::Slot, web::Frame, std::size_t keep)> put;
    std::function<void(web::ClientId, web::Outbox::Slot)> drop;
  };
  /// `run` is another text for every run of a server.
  LiveChannels(Door door, std::string run) : door_(std::move(door)), run_(std::move(run)) {}

  /// Another session: what was kept of the one before is over, and time begins anew.
  void begin_session();
  [[nodiscard]] std::uint16_t add_channel(const record::ChannelDescription& description) override;
  void write(std::uint16_t channel, std::uint64_t time_ns, std::string_view message) override;

  void come(web::ClientId client);
  void go(web::ClientId client);
  /// Refused, with nothing done: a channel or subscription that is none, one that is there already.
  [[nodiscard]] Result<void> subscribe(web::ClientId client, const web::foxglove::Subscribe& all);
  [[nodiscard]] Result<void> unsubscribe(web::ClientId client,
                                         const web::foxglove::Unsubscribe& all);
  /// Nobody is told anything any more.
  void close();

 private:
  struct Stream {
    web::foxglove::Channel channel;
    /// Its last message is for those who subscribe later: what is latched, and what happens, since
    /// nobody can subscribe to a channel before its first message.
    bool kept = false;
    bool told = false;  ///< there is such a message of this session
    std::uint64_t time_ns = 0;
    std::string message;
  };
  using Subscriptions = std::map<std::uint32_t, std::uint32_t>;  ///< by the number of the channel

  void send(web::ClientId client, std::uint32_t subscription, const Stream& stream,
            std::uint64_t time_ns, std::string_view message);
  void tell_time(std::uint64_t time_ns);
  [[nodiscard]] Result<void> judge(const Subscriptions& has,
                                   const web::foxglove::Subscribe::One& one) const;

  std::mutex mutex_;
  Door door_;
  bool closed_ = false;
  std::string run_;
  std::vector<Stream> streams_;  ///< channel 1 is the first
  std::map<web::ClientId, Subscriptions> clients_;
  std::uint64_t time_ns_ = 0;
};

}  // namespace tuina::app
