// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <type_traits>
#include <vector>

#include "tuina/telemetry/mcap/records.hpp"

namespace tuina::telemetry::ros {

/// Makes the `.msg` text of a message, and of the messages in it, from its list of fields.
class DefinitionWriter {
 public:
  /// Writes the line of one field, and notes the type that it needs.
  template <typename T>
  void operator()(const char* name, const T& value) {
    text_.append(type_of(value)).append(" ").append(name).append("\n");
  }
  /// The message, then each one in it after a line of 80 `=`, [mcap] "ros1msg".
  template <typename Message>
  [[nodiscard]] static std::string text_of(const Message& message) {
    DefinitionWriter writer;
    Message::fields(writer, message);
    std::string text = writer.text_;
    // Inner messages bring further ones, which come to the end of the list.
    for (std::size_t i = 0; i < writer.inner_.size(); ++i) {
      text.append(80, '=').append("\nMSG: ").append(writer.inner_[i].first).append("\n");
      writer.text_.clear();
      writer.inner_[i].second(writer);
      text += writer.text_;
    }
    return text;
  }

 private:
  template <typename T>
  std::string type_of(const T&) {
    add(T::type, [](DefinitionWriter& writer) {
      const T empty;
      T::fields(writer, empty);
    });
    return T::type;
  }
  template <typename T>
  std::string type_of(const std::vector<T>&) {
    return type_of(T()).append("[]");
  }
  static std::string type_of(double) { return "float64"; }
  static std::string type_of(float) { return "float32"; }
  static std::string type_of(std::int32_t) { return "int32"; }
  static std::string type_of(std::uint32_t) { return "uint32"; }
  static std::string type_of(std::uint8_t) { return "uint8"; }
  static std::string type_of(std::byte) { return "byte"; }
  static std::string type_of(bool) { return "bool"; }
  static std::string type_of(const std::string&) { return "string"; }

  using Describe = void (*)(DefinitionWriter&);
  void add(const char* type, Describe describe) {
    for (const auto& known : inner_) {
      if (known.first == type) return;
    }
    inner_.emplace_back(type, describe);
  }

  std::string text_;
  std::vector<std::pair<std::string, Describe>> inner_;
};

/// The schema of a message: `sensor_msgs/JointState` is `sensor_msgs/msg/JointState` there.
template <typename Message>
[[nodiscard]] mcap::Schema schema_of() {
  std::string name = Message::type;
  name.insert(name.find('/'), "/msg");
  return {
      .name = std::move(name), .encoding = "ros2msg", .data = DefinitionWriter::text_of(Message())};
}

}  // namespace tuina::telemetry::ros
