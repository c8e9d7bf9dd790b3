// SPDX-License-Identifier: Apache-2.0
#include "tuina/ros2/cyclone_services.hpp"

#include <dds/dds.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <deque>
#include <vector>

#include "tuina/ros2/cdr_topic.hpp"
#include "tuina/ros2/names.hpp"
#include "tuina/ros2/type_hash.hpp"
#include "tuina/telemetry/mcap/cdr.hpp"

namespace tuina::ros2 {
namespace {

namespace ros = telemetry::ros;

constexpr int max_waiting_requests = 32;
// Answers that wait for their readers to be found.
constexpr std::size_t max_waiting_answers = 64;
// Fast DDS tells again of a lost reader three seconds later.
constexpr dds_time_t answer_within = DDS_SECS(5);
constexpr double look_again_s = 0.005;

struct EndpointDeleter {
  void operator()(dds_builtintopic_endpoint_t* it) const { dds_builtintopic_free_endpoint(it); }
};
using Endpoint = std::unique_ptr<dds_builtintopic_endpoint_t, EndpointDeleter>;

/// The program that has a writer or reader.
std::string program_of(const Endpoint& endpoint) {
  std::string digits;
  if (!endpoint) return digits;
  for (const std::uint8_t byte : endpoint->participant_key.v) digits += fmt::format("{:02x}", byte);
  return digits;
}

class CycloneServices final : public Services {
 public:
  CycloneServices() = default;
  CycloneServices(const CycloneServices&) = delete;
  CycloneServices& operator=(const CycloneServices&) = delete;
  ~CycloneServices() override;

  [[nodiscard]] Result<void> begin(dds_entity_t participant, std::span<const std::string> names);
  [[nodiscard]] std::optional<Request> next(double timeout_s) override;
  void answer(const Request& request, bool success, const std::string& message) override;

 private:
  struct Service {
    dds_entity_t requests = 0;  ///< reader
    dds_entity_t answers = 0;   ///< writer
  };
  struct Answer {
    dds_entity_t writer = 0;
    std::string to;
    std::string bytes;
    dds_time_t until = 0;
  };
  [[nodiscard]] std::optional<Request> take();
  [[nodiscard]] std::optional<Request> take_of(std::size_t service);
  [[nodiscard]] static bool hears(dds_entity_t writer, const std::string& program);
  void send_answers();

  std::vector<Service> services_;
  std::deque<Answer> answers_;
  dds_entity_t waits_ = 0;
};

/// As ROS 2 has it for services: reliable, for those who are there.
dds_qos_t* make_qos(const telemetry::mcap::Schema& schema) {
  dds_qos_t* qos = dds_create_qos();
  dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, 0);
  dds_qset_durability(qos, DDS_DURABILITY_VOLATILE);
  dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, max_waiting_requests);
  const std::string user_data = "typehash=" + type_hash(schema) + ";";
  dds_qset_userdata(qos, user_data.data(), user_data.size());
  return qos;
}

/// A reader or writer of that topic; negative: Cyclone's error.
template <typename Create>
dds_entity_t create(const Create& create_end, dds_entity_t participant, const std::string& topic,
                    const telemetry::mcap::Schema& schema) {
  const dds_entity_t made = create_cdr_topic(participant, topic, dds_type(schema.name));
  if (made < 0) return made;
  dds_qos_t* qos = make_qos(schema);
  const dds_entity_t end = create_end(participant, made, qos, nullptr);
  dds_delete_qos(qos);
  return end;
}

Result<void> CycloneServices::begin(dds_entity_t participant, std::span<const std::string> names) {
  waits_ = dds_create_waitset(participant);
  for (const std::string& name : names) {
    const Service made{.requests = create(dds_create_reader, participant, request_topic(name),
                                          trigger_request_schema()),
                       .answers = create(dds_create_writer, participant, answer_topic(name),
                                         trigger_answer_schema())};
    services_.push_back(made);
    const dds_entity_t comes =
        made.requests < 0 ? made.requests : dds_create_readcondition(made.requests, DDS_ANY_STATE);
    const dds_return_t attached = comes < 0 ? comes : dds_waitset_attach(waits_, comes, 0);
    if (attached < 0 || made.answers < 0) {
      return fail(Fault::device, "ROS 2, service {}: {}", name,
                  dds_strretcode(attached < 0 ? attached : made.answers));
    }
  }
  return {};
}

CycloneServices::~CycloneServices() {
  if (waits_ > 0) dds_delete(waits_);
  for (const Service& service : services_) {
    if (service.requests > 0) dds_delete(service.requests);
    if (service.answers > 0) dds_delete(service.answers);
  }
}

std::optional<Request> CycloneServices::next(double timeout_s) {
  send_answers();
  if (auto request = take()) return request;
  const double wait_s = answers_.empty() ? timeout_s : std::min(timeout_s, look_again_s);
  (void)dds_waitset_wait(waits_, nullptr, 0, static_cast<dds_duration_t>(wait_s * 1e9));
  return take();
}

std::optional<Request> CycloneServices::take() {
  for (std::size_t i = 0; i < services_.size(); ++i) {
    if (auto request = take_of(i)) return request;
  }
  return std::nullopt;
}

std::optional<Request> CycloneServices::take_of(std::size_t service) {
  const dds_entity_t reader = services_[service].requests;
  std::string bytes;
  void* into = &bytes;
  dds_sample_info_t info = {};
  while (dds_take(reader, &into, &info, 1, 1) == 1) {
    if (!info.valid_data) continue;  // somebody has gone
    const Endpoint writer(dds_get_matched_publication_data(reader, info.publication_handle));
    // As doubles: a time of others may be any number.
    const double age_ns =
        static_cast<double>(dds_time()) - static_cast<double>(info.source_timestamp);
    Request request{.service = service, .from = program_of(writer), .age_s = 1e-9 * age_ns};
    // The options of the encoding, which Cyclone fills with the number of its padding.
    if (bytes.size() >= ros::cdr_head.size()) bytes[2] = bytes[3] = '\0';
    if (const auto read = ros::from_cdr<TriggerRequest>(bytes)) request.call = read->call;
    return request;
  }
  return std::nullopt;
}

void CycloneServices::answer(const Request& request, bool success, const std::string& message) {
  if (!request.call) return;
  Answer answer{.writer = services_.at(request.service).answers,
                .to = request.from,
                .until = dds_time() + answer_within};
  ros::to_cdr(TriggerAnswer{.call = *request.call, .success = success, .message = message},
              answer.bytes);
  answers_.push_back(std::move(answer));
  send_answers();
  if (answers_.size() > max_waiting_answers) answers_.pop_front();
}

// A program may be found by its request before the reader of its answer is.
bool CycloneServices::hears(dds_entity_t writer, const std::string& program) {
  std::array<dds_instance_handle_t, 256> readers{};
  const dds_return_t found = dds_get_matched_subscriptions(writer, readers.data(), readers.size());
  const auto known = std::min(readers.size(), static_cast<std::size_t>(std::max(found, 0)));
  return std::any_of(
      readers.begin(), readers.begin() + static_cast<std::ptrdiff_t>(known),
      [&](dds_instance_handle_t reader) {
        return program_of(Endpoint(dds_get_matched_subscription_data(writer, reader))) == program;
      });
}

void CycloneServices::send_answers() {
  std::erase_if(answers_, [](const Answer& answer) {
    if (hears(answer.writer, answer.to)) {
      // Who does not take the answers before gets none.
      (void)dds_write(answer.writer, &answer.bytes);
      return true;
    }
    return dds_time() > answer.until;
  });
}

}  // namespace

Result<std::unique_ptr<Services>> offer_services(std::int32_t participant,
                                                 std::span<const std::string> names) {
  auto services = std::make_unique<CycloneServices>();
  if (const auto begun = services->begin(participant, names); !begun)
    return tl::unexpected(begun.error());
  return services;
}

}  // namespace tuina::ros2
