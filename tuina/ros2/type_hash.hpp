// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "tuina/telemetry/mcap/records.hpp"

namespace tuina::ros2 {

/// What ROS 2 takes the hash of: the fields of a message and of those in it as JSON, [rep2011]
/// "Type Version Hash". The schema is one of encoding "ros2msg", as `ros::schema_of` makes it.
[[nodiscard]] std::string type_description(const telemetry::mcap::Schema& schema);
/// By this ROS 2 knows whether two sides mean the same message: "RIHS01_" and 64 digits.
[[nodiscard]] std::string type_hash(const telemetry::mcap::Schema& schema);

}  // namespace tuina::ros2
