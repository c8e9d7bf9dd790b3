// SPDX-License-Identifier: Apache-2.0
#include "tuina/ros2/node.hpp"

#include <dds/dds.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <optional>
#include <vector>

#include "tuina/ros2/cdr_topic.hpp"
#include "tuina/ros2/cyclone_services.hpp"
#include "tuina/ros2/names.hpp"
#include "tuina/ros2/type_hash.hpp"
#include "tuina/telemetry/mcap/cdr.hpp"
#include "tuina/telemetry/mcap/ros_messages.hpp"
#include "tuina/telemetry/mcap/ros_schema.hpp"

namespace tuina::ros2 {
namespace {

namespace ros = telemetry::ros;

// A stream keeps two megabytes for a reader that is late, two seconds of joints; Cyclone would
// begin with thirty kilobytes.
constexpr const char* any_config = R"(<CycloneDDS><Domain><Internal><Watermarks>
  <WhcAdaptive>false</WhcAdaptive><WhcHigh>2 MB</WhcHigh><WhcHighInit>2 MB</WhcHighInit>
</Watermarks></Internal></Domain></CycloneDDS>)";
// Everybody on this machine is asked, since loopback has no multicast; by their numbers 32
// participants are found, those that come later within a second.
constexpr const char* host_config = R"(<CycloneDDS><Domain>
  <General><Interfaces><NetworkInterface address="127.0.0.1" multicast="false"/></Interfaces>
    <AllowMulticast>false</AllowMulticast></General>
  <Discovery><ParticipantIndex>auto</ParticipantIndex>
    <MaxAutoParticipantIndex>32</MaxAutoParticipantIndex>
    <SPDPInterval>1 s</SPDPInterval><Peers><Peer address="127.0.0.1"/></Peers></Discovery>
</Domain></CycloneDDS>)";

/// Pieces of configuration as Cyclone takes them, the later ones on top.
std::string config_of(Reach reach) {
  const char* user = std::getenv("CYCLONEDDS_URI");
  const std::string on_lan = user == nullptr ? "" : user;
  return fmt::format("{},{}", any_config, reach == Reach::host ? host_config : on_lan);
}

struct QosDeleter {
  void operator()(dds_qos_t* qos) const { dds_delete_qos(qos); }
};
using Qos = std::unique_ptr<dds_qos_t, QosDeleter>;

/// What ROS 2 offers for a topic. Who comes later is given the last message of a latched one, and
/// that one may take a tenth of a second: it comes while the arms rest. A stream waits for nobody,
/// and keeps what is on its way until Cyclone's own limit.
Qos qos_of(bool latched, const std::string& user_data) {
  Qos qos(dds_create_qos());
  dds_qset_reliability(qos.get(), DDS_RELIABILITY_RELIABLE, latched ? DDS_MSECS(100) : 0);
  dds_qset_durability(qos.get(),
                      latched ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
  dds_qset_history(qos.get(), latched ? DDS_HISTORY_KEEP_LAST : DDS_HISTORY_KEEP_ALL, 1);
  dds_qset_durability_service(qos.get(), 0, DDS_HISTORY_KEEP_LAST, 1, DDS_LENGTH_UNLIMITED,
                              DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED);
  if (!user_data.empty()) dds_qset_userdata(qos.get(), user_data.data(), user_data.size());
  return qos;
}

class CycloneNode final : public Node {
 public:
  CycloneNode() = default;
  CycloneNode(const CycloneNode&) = delete;
  CycloneNode& operator=(const CycloneNode&) = delete;
  ~CycloneNode() override;

  [[nodiscard]] Result<void> begin(std::uint32_t domain, Reach reach);
  [[nodiscard]] std::uint16_t add_channel(const record::ChannelDescription& description) override;
  void write(std::uint16_t channel, std::uint64_t time_ns, std::string_view message) override;
  [[nodiscard]] Traffic traffic() const override;
  void begin_session() override;
  [[nodiscard]] Result<std::unique_ptr<Services>> offer(
      std::span<const std::string> names) override {
    return offer_services(participant_, names);
  }

 private:
  struct Channel {
    std::string name;
    bool is_json = false, latched = false;
    dds_entity_t topic = 0;   ///< negative: Cyclone's error
    dds_entity_t writer = 0;  ///< likewise; 0: ended with the session before
  };
  void send(const Channel& channel, const std::string& message);
  void tell_clock(std::uint64_t time_ns);
  dds_entity_t domain_ = 0, participant_ = 0;
  std::vector<Channel> channels_;
  std::optional<std::size_t> clock_;  ///< index of its channel
  std::uint64_t next_clock_ns_ = 0;
  std::string bytes_;  ///< of the message that is being sent
  Traffic traffic_;
};

Result<void> CycloneNode::begin(std::uint32_t domain, Reach reach) {
  const auto failed = [&](dds_return_t code) {
    return fail(Fault::device, "ROS 2, domain {}: {}", domain, dds_strretcode(code));
  };
  domain_ = dds_create_domain(domain, config_of(reach).c_str());
  if (domain_ < 0) return failed(domain_);
  participant_ = dds_create_participant(domain, nullptr, nullptr);
  if (participant_ < 0) return failed(participant_);
  return {};
}

CycloneNode::~CycloneNode() {
  dds_time_t left = DDS_SECS(1);
  for (const Channel& channel : channels_) {
    const dds_time_t before = dds_time();
    if (channel.writer > 0) (void)dds_wait_for_acks(channel.writer, left);
    left = std::max<dds_time_t>(0, left - (dds_time() - before));
  }
  if (participant_ > 0) dds_delete(participant_);
  if (domain_ > 0) dds_delete(domain_);
}

Traffic CycloneNode::traffic() const {
  Traffic now = traffic_;
  now.topics = channels_.size();
  for (const Channel& channel : channels_) {
    const dds_return_t readers = dds_get_matched_subscriptions(channel.writer, nullptr, 0);
    now.readers += static_cast<std::size_t>(std::max(0, readers));
  }
  return now;
}

std::uint16_t CycloneNode::add_channel(const record::ChannelDescription& description) {
  const bool is_json = description.encoding == "json";
  const auto schema = is_json ? ros::schema_of<ros::String>() : description.schema;
  auto channel = std::find_if(channels_.begin(), channels_.end(), [&](const Channel& known) {
    return known.name == description.topic;
  });
  if (channel == channels_.end()) {
    const dds_entity_t topic =
        create_cdr_topic(participant_, dds_topic(description.topic), dds_type(schema.name));
    channel = channels_.insert(channel, {.name = description.topic,
                                         .is_json = is_json,
                                         .latched = description.latched,
                                         .topic = topic,
                                         .writer = std::min(topic, 0)});
  }
  if (channel->writer == 0) {
    const Qos qos = qos_of(channel->latched, "typehash=" + type_hash(schema) + ";");
    channel->writer = dds_create_writer(participant_, channel->topic, qos.get(), nullptr);
  }
  return static_cast<std::uint16_t>(channel - channels_.begin() + 1);
}

void CycloneNode::begin_session() {
  next_clock_ns_ = 0;
  for (Channel& channel : channels_) {
    if (!channel.latched || channel.writer <= 0) continue;
    dds_delete(channel.writer);
    channel.writer = 0;
  }
}

void CycloneNode::write(std::uint16_t channel, std::uint64_t time_ns, std::string_view message) {
  tell_clock(time_ns);
  const Channel& to = channels_.at(channel - std::size_t{1});
  if (to.is_json)
    ros::to_cdr(ros::String{.data = std::string(message)}, bytes_);
  else
    bytes_.assign(message);
  send(to, bytes_);
}

void CycloneNode::send(const Channel& channel, const std::string& message) {
  const dds_return_t code =
      channel.writer > 0 ? dds_write(channel.writer, &message) : channel.writer;
  ++traffic_.messages;
  if (code == DDS_RETCODE_OK) return;
  if (++traffic_.dropped == 1) traffic_.first_fault = dds_strretcode(code);
}

// Programs with `use_sim_time` live by the clock of the session.
void CycloneNode::tell_clock(std::uint64_t time_ns) {
  constexpr std::uint64_t clock_every_ns = 10'000'000;
  if (clock_ && time_ns < next_clock_ns_) return;
  if (!clock_) {
    const std::uint16_t id =
        add_channel({.topic = "/clock", .encoding = "cdr", .schema = ros::schema_of<ros::Clock>()});
    clock_ = id - std::size_t{1};
  }
  next_clock_ns_ = time_ns + clock_every_ns;
  constexpr std::uint64_t ns_per_s = 1'000'000'000;
  ros::to_cdr(ros::Clock{.clock = {.sec = static_cast<std::int32_t>(time_ns / ns_per_s),
                                   .nanosec = static_cast<std::uint32_t>(time_ns % ns_per_s)}},
              bytes_);
  send(channels_[*clock_], bytes_);
}

}  // namespace

Result<std::unique_ptr<Node>> open_node(std::uint32_t domain, Reach reach) {
  auto node = std::make_unique<CycloneNode>();
  if (const auto begun = node->begin(domain, reach); !begun) return tl::unexpected(begun.error());
  return node;
}

}  // namespace tuina::ros2
