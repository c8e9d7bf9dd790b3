// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "tuina/telemetry/mcap/records.hpp"

namespace tuina::ros2 {

/// Which call a request makes and an answer is for. [rmw_cyclonedds] writes it before the message,
/// since an answer goes to everybody who calls the service.
struct CallId {
  std::uint64_t client = 0;   ///< the number that a client goes by, of its own choice
  std::int64_t sequence = 0;  ///< of its calls
};

/// The request of std_srvs/Trigger behind its number. It has no field, for which DDS needs one.
struct TriggerRequest {
  CallId call;
  std::uint8_t structure_needs_at_least_one_member = 0;
  static constexpr auto fields = [](auto& visit, auto& it) {
    visit("client", it.call.client);
    visit("sequence", it.call.sequence);
    visit("structure_needs_at_least_one_member", it.structure_needs_at_least_one_member);
  };
};

/// The answer of std_srvs/Trigger behind the number of the call.
struct TriggerAnswer {
  CallId call;
  bool success = false;
  std::string message;
  static constexpr auto fields = [](auto& visit, auto& it) {
    visit("client", it.call.client);
    visit("sequence", it.call.sequence);
    visit("success", it.success);
    visit("message", it.message);
  };
};

/// @{
/// What ROS 2 takes the hashes of: the messages without the number.
[[nodiscard]] inline telemetry::mcap::Schema trigger_request_schema() {
  return {.name = "std_srvs/srv/Trigger_Request",
          .encoding = "ros2msg",
          .data = "uint8 structure_needs_at_least_one_member\n"};
}
[[nodiscard]] inline telemetry::mcap::Schema trigger_answer_schema() {
  return {.name = "std_srvs/srv/Trigger_Response",
          .encoding = "ros2msg",
          .data = "bool success\nstring message\n"};
}
/// @}

}  // namespace tuina::ros2
