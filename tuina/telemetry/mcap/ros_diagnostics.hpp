// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "tuina/telemetry/mcap/ros_messages.hpp"

/// How parts of a robot are, as monitors of ROS 2 show it.
namespace tuina::telemetry::ros {

/// A value with its name, both as text.
struct KeyValue {
  static constexpr const char* type = "diagnostic_msgs/KeyValue";
  std::string key = {};
  std::string value = {};
  static constexpr auto fields = [](auto& visit, auto& it) {
    visit("key", it.key);
    visit("value", it.value);
  };
};

/// How one part is.
struct DiagnosticStatus {
  static constexpr const char* type = "diagnostic_msgs/DiagnosticStatus";
  /// @{
  /// Levels.
  static constexpr std::byte ok{0}, warn{1}, error{2};
  /// @}
  std::byte level = ok;
  std::string name = {};
  std::string message = {};
  std::string hardware_id = {};
  std::vector<KeyValue> values = {};
  static constexpr auto fields = [](auto& visit, auto& it) {
    visit("level", it.level);
    visit("name", it.name);
    visit("message", it.message);
    visit("hardware_id", it.hardware_id);
    visit("values", it.values);
  };
};

/// How all parts are that somebody knows of.
struct DiagnosticArray {
  static constexpr const char* type = "diagnostic_msgs/DiagnosticArray";
  Header header = {};
  std::vector<DiagnosticStatus> status = {};
  static constexpr auto fields = [](auto& visit, auto& it) {
    visit("header", it.header);
    visit("status", it.status);
  };
};

}  // namespace tuina::telemetry::ros
