// SPDX-License-Identifier: Apache-2.0
#include "apps/serve/live_channels.hpp"

#include <algorithm>

namespace tuina::app {
namespace {

namespace foxglove = web::foxglove;

// Slots of channels have their numbers; channels begin with 1.
constexpr web::Outbox::Slot time_slot = 0;
constexpr std::uint64_t time_every_ns = 50'000'000;
// A state is replaced by the next. An event is not, and they are few.
constexpr std::size_t kept_states = 1, kept_events = 64;

bool is_event(const auto& channel) {
  return channel.encoding == "json";
}

}  // namespace

void LiveChannels::begin_session() {
  const std::lock_guard lock(mutex_);
  for (Stream& stream : streams_) {
    stream.told = false;
    stream.message.clear();
  }
  tell_time(0);
}

// The mutex is held, as for all that is private here.
void LiveChannels::tell_time(std::uint64_t time_ns) {
  time_ns_ = time_ns;
  for (const auto& [client, subscriptions] : clients_)
    door_.put(client, time_slot, foxglove::time(time_ns), kept_states);
}

std::uint16_t LiveChannels::add_channel(const record::ChannelDescription& description) {
  const std::lock_guard lock(mutex_);
  const auto known = std::find_if(streams_.begin(), streams_.end(), [&](const Stream& stream) {
    return stream.channel.topic == description.topic;
  });
  if (known != streams_.end()) return static_cast<std::uint16_t>(known->channel.id);
  const Stream& added = streams_.emplace_back(
      Stream{.channel = {.id = static_cast<std::uint32_t>(streams_.size() + 1),
                         .topic = description.topic,
                         .encoding = description.encoding,
                         .schema_name = description.schema.name,
                         .schema_encoding = description.schema.encoding,
                         .schema = description.schema.data},
             .kept = description.latched || is_event(description)});
  for (const auto& [client, subscriptions] : clients_)
    door_.reply(client, foxglove::advertise({&added.channel, 1}));
  return static_cast<std::uint16_t>(added.channel.id);
}

void LiveChannels::send(web::ClientId client, std::uint32_t subscription, const Stream& stream,
                        std::uint64_t time_ns, std::string_view message) {
  door_.put(client, stream.channel.id, foxglove::message_data(subscription, time_ns, message),
            is_event(stream.channel) ? kept_events : kept_states);
}

void LiveChannels::write(std::uint16_t channel, std::uint64_t time_ns, std::string_view message) {
  const std::lock_guard lock(mutex_);
  Stream& stream = streams_[channel - 1U];
  if (stream.kept) {
    stream.told = true;
    stream.time_ns = time_ns;
    stream.message = message;
  }
  for (const auto& [client, subscriptions] : clients_) {
    const auto found = subscriptions.find(stream.channel.id);
    if (found != subscriptions.end()) send(client, found->second, stream, time_ns, message);
  }
  if (time_ns >= time_ns_ + time_every_ns) tell_time(time_ns);
}

void LiveChannels::come(web::ClientId client) {
  const std::lock_guard lock(mutex_);
  if (closed_) return;
  clients_[client];
  door_.reply(client, foxglove::server_info(run_));
  std::vector<foxglove::Channel> channels;
  channels.reserve(streams_.size());
  for (const Stream& stream : streams_) channels.push_back(stream.channel);
  if (!channels.empty()) door_.reply(client, foxglove::advertise(channels));
  door_.reply(client, foxglove::advertise_services());
  door_.put(client, time_slot, foxglove::time(time_ns_), kept_states);
}

void LiveChannels::go(web::ClientId client) {
  const std::lock_guard lock(mutex_);
  clients_.erase(client);
}

Result<void> LiveChannels::judge(const Subscriptions& has,
                                 const foxglove::Subscribe::One& one) const {
  if (one.channel == 0 || one.channel > streams_.size())
    return fail(Fault::bad_input, "there is no channel {}", one.channel);
  if (has.contains(one.channel))
    return fail(Fault::bad_input, "channel {} has a subscription already", one.channel);
  for (const auto& [channel, subscription] : has) {
    if (subscription == one.subscription)
      return fail(Fault::bad_input, "subscription {} is there already", one.subscription);
  }
  return {};
}

Result<void> LiveChannels::subscribe(web::ClientId client, const foxglove::Subscribe& all) {
  const std::lock_guard lock(mutex_);
  const auto found = clients_.find(client);
  if (found == clients_.end()) return {};
  Subscriptions has = found->second;
  for (const auto& one : all.all) {
    if (auto judged = judge(has, one); !judged) return judged;
    has[one.channel] = one.subscription;
  }
  found->second = std::move(has);
  for (const auto& one : all.all) {
    const Stream& stream = streams_[one.channel - 1U];
    if (stream.told) send(client, one.subscription, stream, stream.time_ns, stream.message);
  }
  return {};
}

Result<void> LiveChannels::unsubscribe(web::ClientId client, const foxglove::Unsubscribe& all) {
  const std::lock_guard lock(mutex_);
  const auto found = clients_.find(client);
  if (found == clients_.end()) return {};
  Subscriptions has = found->second;
  std::vector<std::uint32_t> dropped;
  for (const std::uint32_t subscription : all.subscriptions) {
    const auto one = std::find_if(has.begin(), has.end(),
                                  [&](const auto& pair) { return pair.second == subscription; });
    if (one == has.end())
      return fail(Fault::bad_input, "there is no subscription {}", subscription);
    dropped.push_back(one->first);
    has.erase(one);
  }
  found->second = std::move(has);
  for (const std::uint32_t channel : dropped) door_.drop(client, channel);
  return {};
}

void LiveChannels::close() {
  const std::lock_guard lock(mutex_);
  closed_ = true;
  clients_.clear();
}

}  // namespace tuina::app
