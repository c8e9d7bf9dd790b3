// SPDX-License-Identifier: Apache-2.0
#include "tests/ros2/fast_dds_peer.hpp"

#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <atomic>
#include <cstring>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/TopicDataType.hpp>
#include <mutex>

namespace tuina::test {
namespace {

namespace dds = eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;

/// A type whose samples are strings, the bytes of a message as they are.
class Bytes final : public dds::TopicDataType {
 public:
  explicit Bytes(const std::string& name) {
    setName(name.c_str());
    m_typeSize = 1 << 21;
    auto_fill_type_object(false);
    auto_fill_type_information(false);
  }
  bool serialize(void* data, rtps::SerializedPayload_t* to) override {
    const auto& bytes = *static_cast<std::string*>(data);
    std::memcpy(to->data, bytes.data(), bytes.size());
    to->length = static_cast<std::uint32_t>(bytes.size());
    to->encapsulation = CDR_LE;
    return true;
  }
  bool deserialize(rtps::SerializedPayload_t* from, void* data) override {
    static_cast<std::string*>(data)->assign(reinterpret_cast<char*>(from->data), from->length);
    return true;
  }
  std::function<std::uint32_t()> getSerializedSizeProvider(void* data) override {
    return [data] { return static_cast<std::uint32_t>(static_cast<std::string*>(data)->size()); };
  }
  void* createData() override { return new std::string(); }
  void deleteData(void* data) override { delete static_cast<std::string*>(data); }
  bool getKey(void*, rtps::InstanceHandle_t*, bool) override { return false; }
};

/// Keeps what comes on one topic.
struct Subscription final : dds::DataReaderListener {
  void on_data_available(dds::DataReader* reader) override {
    std::this_thread::sleep_for(sleeps.exchange(std::chrono::milliseconds(0)));
    std::string bytes;
    dds::SampleInfo info;
    while (reader->take_next_sample(&bytes, &info) == ReturnCode_t::RETCODE_OK) {
      const std::lock_guard lock(mutex);
      if (info.valid_data) messages.push_back(bytes);
    }
  }
  void on_subscription_matched(dds::DataReader*,
                               const dds::SubscriptionMatchedStatus& status) override {
    const std::lock_guard lock(mutex);
    publishers = status.current_count;
  }
  std::mutex mutex;
  std::vector<std::string> messages;
  int publishers = 0;
  std::atomic<std::chrono::milliseconds> sleeps = std::chrono::milliseconds(0);
};

}  // namespace

struct FastDdsPeer::Inside final : dds::DomainParticipantListener {
  void on_publisher_discovery(dds::DomainParticipant*, rtps::WriterDiscoveryInfo&& info) override {
    const std::lock_guard lock(mutex);
    const auto& bytes = info.info.m_qos.m_userData.getValue();
    user_data[info.info.topicName().to_string()] = std::string(bytes.begin(), bytes.end());
  }
  dds::Topic* topic(const std::string& name, const std::string& type) {
    if (auto* known = dynamic_cast<dds::Topic*>(participant->lookup_topicdescription(name)))
      return known;
    dds::TypeSupport(new Bytes(type)).register_type(participant);
    return participant->create_topic(name, type, dds::TOPIC_QOS_DEFAULT);
  }

  dds::DomainParticipant* participant = nullptr;
  std::map<std::string, std::unique_ptr<Subscription>> subscriptions;
  std::map<std::string, dds::DataWriter*> writers;
  std::mutex mutex;
  std::map<std::string, std::string> user_data;
};

FastDdsPeer::FastDdsPeer(unsigned domain, unsigned receive_buffer_bytes)
    : inside_(std::make_unique<Inside>()) {
  dds::DomainParticipantQos qos;
  const auto loopback = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
  loopback->interfaceWhiteList = {"127.0.0.1"};
  loopback->receiveBufferSize = receive_buffer_bytes;
  qos.transport().use_builtin_transports = false;
  qos.transport().user_transports.push_back(loopback);
  inside_->participant = dds::DomainParticipantFactory::get_instance()->create_participant(
      domain, qos, inside_.get(), dds::StatusMask::none());
}

FastDdsPeer::~FastDdsPeer() {
  inside_->participant->set_listener(nullptr);
  inside_->participant->delete_contained_entities();
  dds::DomainParticipantFactory::get_instance()->delete_participant(inside_->participant);
}

void FastDdsPeer::subscribe(const std::string& dds_topic, const std::string& dds_type,
                            bool latched) {
  dds::DataReaderQos qos;
  qos.reliability().kind = dds::RELIABLE_RELIABILITY_QOS;
  qos.history().kind = dds::KEEP_ALL_HISTORY_QOS;
  qos.endpoint().history_memory_policy = rtps::DYNAMIC_RESERVE_MEMORY_MODE;
  if (latched) qos.durability().kind = dds::TRANSIENT_LOCAL_DURABILITY_QOS;
  auto& subscription = inside_->subscriptions[dds_topic] = std::make_unique<Subscription>();
  inside_->participant->create_subscriber(dds::SUBSCRIBER_QOS_DEFAULT)
      ->create_datareader(inside_->topic(dds_topic, dds_type), qos, subscription.get());
}

void FastDdsPeer::advertise(const std::string& dds_topic, const std::string& dds_type) {
  dds::DataWriterQos qos;
  qos.reliability().kind = dds::RELIABLE_RELIABILITY_QOS;
  qos.history().kind = dds::KEEP_ALL_HISTORY_QOS;
  qos.endpoint().history_memory_policy = rtps::DYNAMIC_RESERVE_MEMORY_MODE;
  // What a busy machine loses is told again soon, and not in three seconds.
  qos.reliable_writer_qos().times.heartbeatPeriod = {0, 100'000'000};
  inside_->writers[dds_topic] = inside_->participant->create_publisher(dds::PUBLISHER_QOS_DEFAULT)
                                    ->create_datawriter(inside_->topic(dds_topic, dds_type), qos);
}

void FastDdsPeer::say(const std::string& dds_topic, std::string bytes) {
  inside_->writers.at(dds_topic)->write(&bytes);
}

bool FastDdsPeer::has_come(const std::string& dds_topic) {
  return inside_->writers.at(dds_topic)->wait_for_acknowledgments({5, 0}) ==
         ReturnCode_t::RETCODE_OK;
}

void FastDdsPeer::sleep(const std::string& dds_topic, std::chrono::milliseconds time) {
  inside_->subscriptions.at(dds_topic)->sleeps = time;
}

std::vector<std::string> FastDdsPeer::messages(const std::string& dds_topic) const {
  Subscription& subscription = *inside_->subscriptions.at(dds_topic);
  const std::lock_guard lock(subscription.mutex);
  return subscription.messages;
}

int FastDdsPeer::publishers(const std::string& dds_topic) const {
  Subscription& subscription = *inside_->subscriptions.at(dds_topic);
  const std::lock_guard lock(subscription.mutex);
  return subscription.publishers;
}

std::string FastDdsPeer::user_data(const std::string& dds_topic) const {
  const std::lock_guard lock(inside_->mutex);
  const auto found = inside_->user_data.find(dds_topic);
  return found == inside_->user_data.end() ? "" : found->second;
}

}  // namespace tuina::test
