// SPDX-License-Identifier: Apache-2.0
#include "tuina/record/plan_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "tuina/core/io/file.hpp"
#include "tuina/core/io/json_fault.hpp"
#include "tuina/core/io/text_lines.hpp"
#include "tuina/core/units.hpp"

namespace tuina::record {
namespace {

using nlohmann::json;
using nlohmann::ordered_json;

/// Micrometres, tenths of a millinewton and the like: what is finer is noise and makes files large.
double rounded(double value, double step) {
  return std::round(value / step) * step;
}
double short_number(double value) {
  return rounded(value, 1e-6);
}

ordered_json distance_mm(double distance_m) {
  return std::isfinite(distance_m) ? ordered_json(rounded(to_mm(distance_m), 1e-3))
                                   : ordered_json();
}

ordered_json three(const Vector3& v) {
  return {short_number(v.x()), short_number(v.y()), short_number(v.z())};
}

ordered_json json_of(const massage::PlannedPath& planned) {
  double peak_n = 0.0;
  ordered_json points = ordered_json::array();
  for (const ContactPoint& point : planned.path.points) {
    peak_n = std::max(peak_n, point.force_n);
    points.push_back({{"time_s", short_number(point.time_s)},
                      {"position_m", three(point.at_in_couch)},
                      {"normal", three(point.normal_in_couch)},
                      {"force_n", short_number(point.force_n)}});
  }
  return {{"name", planned.path.name},
          {"technique", name_of(planned.path.technique)},
          {"acupoints", planned.path.acupoints},
          {"arm", name_of(planned.arm)},
          {"step", planned.step},
          {"start_s", short_number(planned.start_s)},
          {"duration_s", short_number(planned.path.duration_s())},
          {"zone", name_of(planned.zone)},
          {"cap_n", planned.cap_n},
          {"peak_n", short_number(peak_n)},
          {"points", std::move(points)}};
}

/// The value whose name is the text; names come from the same tables as when writing.
template <typename Enum, std::size_t count>
Enum named(const json& node, const char* what) {
  const std::string text = node.get<std::string>();
  for (std::size_t i = 0; i < count; ++i) {
    if (text == name_of(static_cast<Enum>(i))) return static_cast<Enum>(i);
  }
  throw std::invalid_argument(fmt::format("{} is no {}", in_quotes(text), what));
}

Vector3 vector_of(const json& node) {
  const auto v = node.get<std::array<double, 3>>();
  return {v[0], v[1], v[2]};
}

massage::PlannedPath planned_of(const json& node) {
  massage::PlannedPath planned;
  planned.path.name = node.at("name").get<std::string>();
  planned.path.technique =
      named<Technique, all_techniques.size()>(node.at("technique"), "technique");
  planned.path.acupoints = node.at("acupoints").get<std::vector<std::string>>();
  planned.arm = named<Arm, 2>(node.at("arm"), "arm");
  planned.step = node.at("step").get<int>();
  planned.start_s = node.at("start_s").get<double>();
  planned.zone = named<massage::Zone, massage::zone_rules.size()>(node.at("zone"), "zone");
  planned.cap_n = node.at("cap_n").get<double>();
  for (const json& point : node.at("points")) {
    planned.path.points.push_back({.time_s = point.at("time_s").get<double>(),
                                   .at_in_couch = vector_of(point.at("position_m")),
                                   .normal_in_couch = vector_of(point.at("normal")),
                                   .force_n = point.at("force_n").get<double>()});
  }
  return planned;
}

}  // namespace

std::string to_json(const PlanFile& file) {
  const massage::Plan& plan = file.plan;
  ordered_json paths = ordered_json::array();
  for (const massage::PlannedPath& planned : plan.paths) paths.push_back(json_of(planned));
  const ordered_json root = {
      {"programme", plan.programme},
      {"duration_s", short_number(plan.duration_s)},
      {"reachable", file.reachable},
      {"min_arm_distance_mm", rounded(to_mm(file.min_arm_distance_m), 1e-3)},
      {"min_couch_distance_mm", distance_mm(file.clear[robot::Surrounding::couch])},
      {"min_body_distance_mm", distance_mm(file.clear[robot::Surrounding::body])},
      {"min_tool_distance_mm", rounded(to_mm(plan.min_tool_distance_m), 1e-3)},
      {"rail_m", short_number(file.rail_m)},
      {"zones_touched", plan.zones_touched},
      {"notes", plan.notes},
      {"compute_ms", rounded(file.compute_ms, 1e-3)},
      {"paths", std::move(paths)}};
  return root.dump();
}

Result<PlanFile> parse_plan(std::string_view text, std::string_view name) {
  try {
    const json root = json::parse(text);
    PlanFile file;
    file.plan.programme = root.at("programme").get<std::string>();
    file.plan.duration_s = root.at("duration_s").get<double>();
    file.reachable = root.at("reachable").get<bool>();
    file.min_arm_distance_m = from_mm(root.at("min_arm_distance_mm").get<double>());
    for (const auto& [kind, key] : {std::pair(robot::Surrounding::couch, "min_couch_distance_mm"),
                                    std::pair(robot::Surrounding::body, "min_body_distance_mm")}) {
      if (root.contains(key) && !root.at(key).is_null())
        file.clear[kind] = from_mm(root.at(key).get<double>());
    }
    file.plan.min_tool_distance_m = from_mm(root.at("min_tool_distance_mm").get<double>());
    file.rail_m = root.at("rail_m").get<double>();
    file.plan.zones_touched = root.at("zones_touched").get<std::vector<std::string>>();
    file.plan.notes = root.at("notes").get<std::vector<std::string>>();
    file.compute_ms = root.at("compute_ms").get<double>();
    for (const json& path : root.at("paths")) file.plan.paths.push_back(planned_of(path));
    return file;
  } catch (const std::exception& fault) {
    return tl::unexpected(json_fault(fault, text, name, "a plan of `tuina plan`"));
  }
}

Result<PlanFile> read_plan(const std::filesystem::path& file) {
  constexpr std::size_t max_bytes = std::size_t{1} << 28;
  const auto text = read_file(file, max_bytes);
  if (!text) return tl::unexpected(text.error());
  return parse_plan(*text, file.string());
}

}  // namespace tuina::record
