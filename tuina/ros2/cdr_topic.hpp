// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace tuina::ros2 {

/// Of what comes from others so many bytes are kept: requests are shorter.
inline constexpr std::size_t max_received_bytes = 64;

/// A topic of Cyclone DDS without keys whose samples are `std::string`s: the bytes of a message as
/// `ros::to_cdr` writes them, sent as they are with zeros up to a multiple of four, and received as
/// they come, whatever they are. `participant` and the topic that is returned are `dds_entity_t`; a
/// negative one is Cyclone's error.
[[nodiscard]] std::int32_t create_cdr_topic(std::int32_t participant, const std::string& topic,
                                            const std::string& type);

}  // namespace tuina::ros2
