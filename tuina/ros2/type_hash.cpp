// SPDX-License-Identifier: Apache-2.0
#include "tuina/ros2/type_hash.hpp"

#include <fmt/format.h>
#include <openssl/evp.h>

#include <algorithm>
#include <array>
#include <map>
#include <sstream>
#include <utility>

namespace tuina::ros2 {
namespace {

// Numbers of type_description_interfaces/msg/FieldType for the types that `ros_schema.hpp` writes.
constexpr std::pair<std::string_view, int> plain_types[] = {
    {"uint8", 3},    {"int32", 6}, {"uint32", 7}, {"float32", 10},
    {"float64", 11}, {"bool", 15}, {"byte", 16},  {"string", 17}};
constexpr int nested_type = 1;
constexpr int unbounded_sequence = 144;  // added to the number of its items

/// `std_msgs/Header` with the word that ROS 2 has between.
std::string full_name(std::string name) {
  if (name.find("/msg/") == std::string::npos) name.insert(name.find('/'), "/msg");
  return name;
}

std::string json_of_field(std::string_view type, std::string_view name) {
  int kind = nested_type;
  if (type.ends_with("[]")) {
    type.remove_suffix(2);
    kind += unbounded_sequence;
  }
  const auto* plain =
      std::ranges::find(plain_types, type, &std::pair<std::string_view, int>::first);
  const bool is_plain = plain != std::end(plain_types);
  if (is_plain) kind += plain->second - nested_type;
  return fmt::format(
      R"({{"name": "{}", "type": {{"type_id": {}, "capacity": 0, "string_capacity": 0, )"
      R"("nested_type_name": "{}"}}}})",
      name, kind, is_plain ? "" : full_name(std::string(type)));
}

std::string json_of_type(std::string_view name, std::string_view fields) {
  return fmt::format(R"({{"type_name": "{}", "fields": [{}]}})", name, fields);
}

}  // namespace

std::string type_description(const telemetry::mcap::Schema& schema) {
  std::map<std::string, std::string> fields_of;
  std::string name = schema.name;
  std::istringstream lines(schema.data);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t space = line.find(' ');
    if (space == std::string::npos) continue;  // the line between two messages
    if (line.starts_with("MSG: ")) {
      name = full_name(line.substr(space + 1));
      continue;
    }
    std::string& fields = fields_of[name];
    if (!fields.empty()) fields += ", ";
    fields += json_of_field(std::string_view(line).substr(0, space), line.substr(space + 1));
  }
  const std::string whole = json_of_type(schema.name, fields_of[schema.name]);
  std::string referenced;
  for (const auto& [inner, fields] : fields_of) {
    if (inner == schema.name) continue;
    if (!referenced.empty()) referenced += ", ";
    referenced += json_of_type(inner, fields);
  }
  return fmt::format(R"({{"type_description": {}, "referenced_type_descriptions": [{}]}})", whole,
                     referenced);
}

std::string type_hash(const telemetry::mcap::Schema& schema) {
  const std::string text = type_description(schema);
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned int size = 0;
  EVP_Digest(text.data(), text.size(), digest.data(), &size, EVP_sha256(), nullptr);
  std::string hash = "RIHS01_";
  for (unsigned int i = 0; i < size; ++i) hash += fmt::format("{:02x}", digest[i]);
  return hash;
}

}  // namespace tuina::ros2
