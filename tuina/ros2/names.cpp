// SPDX-License-Identifier: Apache-2.0
#include "tuina/ros2/names.hpp"

#include "tuina/core/io/text_lines.hpp"

namespace tuina::ros2 {

std::string dds_topic(std::string_view ros_topic) {
  return "rt" + std::string(ros_topic);
}

std::string request_topic(std::string_view ros_service) {
  return "rq" + std::string(ros_service) + "Request";
}

std::string answer_topic(std::string_view ros_service) {
  return "rr" + std::string(ros_service) + "Reply";
}

std::string dds_type(std::string_view ros_type) {
  std::string type;
  const std::size_t last = ros_type.rfind('/') + 1;
  for (const char letter : ros_type.substr(0, last)) {
    if (letter == '/')
      type += "::";
    else
      type += letter;
  }
  return type.append("dds_::").append(ros_type.substr(last)).append("_");
}

Result<std::uint32_t> parse_domain(const char* ros_domain_id) {
  // DDS computes its ports from the domain, and those of higher ones are no ports any more
  // ([rtps] 9.6.1.1).
  constexpr std::uint32_t max_domain = 232;
  if (ros_domain_id == nullptr || *ros_domain_id == '\0') return 0U;
  const auto domain = to_number<std::uint32_t>(ros_domain_id);
  if (!domain || *domain > max_domain) {
    return fail(Fault::usage, "ROS_DOMAIN_ID = {} is not a whole number from 0 to {}",
                in_quotes(ros_domain_id), max_domain);
  }
  return *domain;
}

}  // namespace tuina::ros2
