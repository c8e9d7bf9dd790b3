// SPDX-License-Identifier: Apache-2.0
#include "tuina/record/json_fields.hpp"

#include <algorithm>

namespace tuina::record {

std::string JsonReader::path_of(const char* key) const {
  return path_.empty() ? key : fmt::format("{}.{}", path_, key);
}

const nlohmann::json* JsonReader::find(const char* key) {
  if (!fault_.empty()) return nullptr;
  if (has(key)) return &object_[key];
  fault_ = path_of(key) + " is missing";
  return nullptr;
}

bool JsonReader::holds(bool right, const Json& node, const std::string& path,
                       std::string_view wanted) {
  constexpr std::size_t enough = 40;  // characters of a value that are shown
  if (right || !fault_.empty()) return right;
  std::string value = node.dump(-1, ' ', true, Json::error_handler_t::replace);
  if (value.size() > enough) value = value.substr(0, enough) + "...";
  fault_ = fmt::format("{} is {}, {} is needed", path, value, wanted);
  return false;
}

void JsonReader::take(const Json& node, const std::string& path, double& value, Unit unit) {
  if (holds(node.is_number(), node, path, "a number")) value = node.get<double>() * unit.in_si;
}

void JsonReader::take(const Json& node, const std::string& path, bool& value, Unit) {
  if (holds(node.is_boolean(), node, path, "true or false")) value = node.get<bool>();
}

void JsonReader::take(const Json& node, const std::string& path, std::string& value, Unit) {
  if (holds(node.is_string(), node, path, "a text")) value = node.get<std::string>();
}

void JsonReader::take(const Json& node, const std::string& path, Vector3& value, Unit unit) {
  const bool three = node.is_array() && node.size() == 3 && node[0].is_number() &&
                     node[1].is_number() && node[2].is_number();
  if (!holds(three, node, path, "a list of three numbers")) return;
  for (std::size_t i = 0; i < 3; ++i)
    value[static_cast<Eigen::Index>(i)] = node[i].get<double>() * unit.in_si;
}

void JsonReader::take(const Json& node, const std::string& path, Transform& value, Unit unit) {
  if (!holds(node.is_object(), node, path, "an object")) return;
  JsonReader inside(node, path, fault_);
  Vector3 translation = Vector3::Zero();
  std::vector<Vector3> rows;
  inside("rotation", rows);
  inside("translation_m", translation, unit);
  if (!fault_.empty() ||
      !holds(rows.size() == 3, node["rotation"], path + ".rotation", "a list of three rows"))
    return;
  for (std::size_t i = 0; i < 3; ++i)
    value.linear().row(static_cast<Eigen::Index>(i)) = rows[i].transpose();
  value.translation() = translation;
}

Result<nlohmann::json> parse_json(std::string_view text, std::string_view file,
                                  std::string_view what) {
  try {
    return nlohmann::json::parse(text);
  } catch (const nlohmann::json::parse_error& error) {
    const std::string_view before = text.substr(0, error.byte);
    const auto line = 1 + std::count(before.begin(), before.end(), '\n');
    return fail(Fault::bad_input, "{}:{}: is no {}: what stands there is not JSON", file, line,
                what);
  } catch (const nlohmann::json::exception&) {
    return fail(Fault::bad_input, "{}: is no {}: a number in it is too large", file, what);
  }
}

}  // namespace tuina::record
