// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "tuina/core/result.hpp"
#include "tuina/ros2/services.hpp"

namespace tuina::ros2 {

/// `Node::offer` on Cyclone DDS; `participant` is a `dds_entity_t`.
[[nodiscard]] Result<std::unique_ptr<Services>> offer_services(std::int32_t participant,
                                                               std::span<const std::string> names);

}  // namespace tuina::ros2
