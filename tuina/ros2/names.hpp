// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "tuina/core/result.hpp"

/// A session as a node of ROS 2, without ROS: its messages on DDS under the names that ROS 2 uses
/// (docs/ros2.md).
namespace tuina::ros2 {

/// `/joint_states` of ROS 2 is `rt/joint_states` on DDS.
[[nodiscard]] std::string dds_topic(std::string_view ros_topic);
/// @{
/// Requests of the service `/tuina/stop` of ROS 2 are `rq/tuina/stopRequest` on DDS, and its
/// answers `rr/tuina/stopReply`.
[[nodiscard]] std::string request_topic(std::string_view ros_service);
[[nodiscard]] std::string answer_topic(std::string_view ros_service);
/// @}
/// `sensor_msgs/msg/JointState` of ROS 2 is `sensor_msgs::msg::dds_::JointState_` on DDS.
[[nodiscard]] std::string dds_type(std::string_view ros_type);

/// The domain that the text of ROS_DOMAIN_ID names; 0 where it is null or empty.
[[nodiscard]] Result<std::uint32_t> parse_domain(const char* ros_domain_id);

}  // namespace tuina::ros2
