// SPDX-License-Identifier: Apache-2.0
#include "tuina/record/acupoint_file.hpp"

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "tuina/core/io/file.hpp"
#include "tuina/core/io/json_fault.hpp"
#include "tuina/core/io/text_lines.hpp"
#include "tuina/core/units.hpp"

namespace tuina::record {
namespace {

using nlohmann::json;

constexpr double furthest_m = 10.0;  // from the couch; beyond it the numbers are not metres

Result<Vector3> three_numbers(const json& node, std::string_view where) {
  const bool three = node.is_array() && node.size() == 3 && node[0].is_number() &&
                     node[1].is_number() && node[2].is_number();
  if (!three) return fail(Fault::bad_input, "{} is not three numbers", where);
  return Vector3(node[0].get<double>(), node[1].get<double>(), node[2].get<double>());
}

Result<Vector3> place(const json& node, std::string_view where) {
  auto at = three_numbers(node, where);
  if (at && !(at->cwiseAbs().maxCoeff() <= furthest_m)) {
    return fail(Fault::bad_input, "{} lies {:.0f} m from the couch; metres are needed", where,
                at->cwiseAbs().maxCoeff());
  }
  return at;
}

Result<Acupoint> acupoint(const std::string& name, const json& node, std::string_view file) {
  const std::string where = fmt::format("{}: acupoints.{}", file, name);
  for (const char* key : {"position_m", "normal", "uncertainty_mm"}) {
    if (!node.is_object() || !node.contains(key)) {
      return fail(Fault::bad_input, "{} has no {}", where, key);
    }
  }
  const auto at = place(node["position_m"], where + ".position_m");
  if (!at) return tl::unexpected(at.error());
  const auto normal = three_numbers(node["normal"], where + ".normal");
  if (!normal) return tl::unexpected(normal.error());
  constexpr double rounding = 0.01;  // a file may carry two or three digits
  if (!(std::abs(normal->norm() - 1.0) <= rounding)) {
    return fail(Fault::bad_input, "{}.normal has length {:.3f}, 1 is needed", where,
                normal->norm());
  }
  const json& uncertainty = node["uncertainty_mm"];
  const double uncertainty_mm = uncertainty.is_number() ? uncertainty.get<double>() : -1.0;
  if (!(uncertainty_mm >= 0.0 && uncertainty_mm <= 1000.0)) {
    return fail(Fault::bad_input, "{}.uncertainty_mm is not a number from 0 to 1000", where);
  }
  return Acupoint{name, *at, normal->normalized(), from_mm(uncertainty_mm)};
}

Result<MappedBack> mapped_back(const json& root, std::string_view file) {
  if (!root.is_object() || !root.contains("acupoints") || !root["acupoints"].is_object()) {
    return fail(Fault::bad_input, "{}: no object `acupoints`, as `tuina map` writes it", file);
  }
  MappedBack back;
  if (root.contains("position")) {
    const json& position = root["position"];
    if (position == "sitting") back.position = BodyPosture::sitting;
    if (position == "prone") back.position = BodyPosture::prone;
    if (!back.position) {
      return fail(Fault::bad_input, "{}: position is not \"sitting\" or \"prone\"", file);
    }
  }
  for (const auto& [name, node] : root["acupoints"].items()) {
    auto point = acupoint(name, node, file);
    if (!point) return tl::unexpected(point.error());
    back.acupoints.push_back(std::move(*point));
  }
  std::vector<std::string> missing;
  for (const char* name : seven_acupoints) {
    if (!root["acupoints"].contains(name)) missing.emplace_back(name);
  }
  if (!missing.empty()) {
    return fail(Fault::bad_input, "{}: acupoints lacks {}; all seven of the thesis are needed",
                file, listed(missing));
  }
  if (!root.contains("landmarks")) return back;
  if (!root["landmarks"].is_object()) {
    return fail(Fault::bad_input, "{}: landmarks is not an object of names", file);
  }
  for (const auto& [name, node] : root["landmarks"].items()) {
    const auto at = place(node, fmt::format("{}: landmarks.{}", file, name));
    if (!at) return tl::unexpected(at.error());
    back.landmarks.push_back({name, *at});
  }
  return back;
}

}  // namespace

Result<MappedBack> parse_acupoints(std::string_view text, std::string_view name) {
  json root;
  try {
    root = json::parse(text);
  } catch (const json::exception& fault) {
    return tl::unexpected(json_fault(fault, text, name, "a map of acupoints"));
  }
  return mapped_back(root, name);
}

Result<MappedBack> read_acupoints(const std::filesystem::path& file) {
  constexpr std::size_t max_bytes = 1 << 24;
  const auto text = read_file(file, max_bytes);
  if (!text) return tl::unexpected(text.error());
  return parse_acupoints(*text, file.string());
}

std::string to_json(const MapFile& map) {
  const auto three = [](const Vector3& v) { return nlohmann::ordered_json{v.x(), v.y(), v.z()}; };
  const body::Mapping& mapping = map.mapping;
  nlohmann::ordered_json json = {{"method", name_of(mapping.method)},
                                 {"position", name_of(mapping.position)},
                                 {"arms", name_of(mapping.arms)},
                                 {"compute_ms", map.compute_ms},
                                 {"points", map.points},
                                 {"dropped_points", map.dropped_points},
                                 {"seen_percent", 100.0 * mapping.coverage},
                                 {"misfit_mm", to_mm(mapping.rms_residual_m)},
                                 {"strangeness", mapping.mahalanobis2_per_mode}};
  for (const Acupoint& point : mapping.acupoints) {
    json["acupoints"][point.name] = {{"position_m", three(point.at_in_couch)},
                                     {"normal", three(point.normal_in_couch)},
                                     {"uncertainty_mm", to_mm(point.uncertainty_m)}};
  }
  json["landmarks"] = nlohmann::ordered_json::object();
  for (const Landmark& landmark : mapping.landmarks) {
    json["landmarks"][landmark.name] = three(landmark.at_in_couch);
  }
  for (const body::PalpatedPoint& point : mapping.fixed) {
    json["fixed"][point.name] = {{"position_m", three(point.at_in_couch)},
                                 {"error_mm", to_mm(point.error_m)}};
  }
  return json.dump(2);
}

}  // namespace tuina::record
