// SPDX-License-Identifier: Apache-2.0
#include "tuina/record/plan_file.hpp"

#include <algorithm>

#include "tuina/core/io/file.hpp"
#include "tuina/record/json_fields.hpp"
#include "tuina/record/shared_fields.hpp"

namespace tuina::record {
namespace {

// What is finer than a micrometre or a microsecond is noise and makes files large.
constexpr Unit micro{1.0, 1.0, 1e-6}, micro_mm{1e3, 1e-3, 1e-3}, micro_ms{1.0, 1.0, 1e-3};

constexpr auto point_fields = [](auto& visit, auto& point) {
  visit("time_s", point.time_s, micro);
  visit("position_m", point.at_in_couch, micro);
  visit("normal", point.normal_in_couch, micro);
  visit("force_n", point.force_n, micro);
};

constexpr auto path_fields = [](auto& visit, auto& planned) {
  visit("name", planned.path.name);
  visit("technique", planned.path.technique);
  visit("acupoints", planned.path.acupoints);
  visit("arm", planned.arm);
  visit("step", planned.step);
  visit("start_s", planned.start_s, micro);
  visit.told("duration_s", planned.path.duration_s(), micro);
  visit("zone", planned.zone);
  visit("cap_n", planned.cap_n);
  visit.maybe("programme_n", planned.programme_n, micro);
  visit.maybe("lowered_by", planned.lowered_by.words);
  visit.told("peak_n", planned.ordered_n(), micro);
  visit.list("points", planned.path.points, point_fields);
};

constexpr auto plan_fields = [](auto& visit, auto& file) {
  auto& plan = file.plan;
  visit("programme", plan.programme);
  visit("duration_s", plan.duration_s, micro);
  visit("reachable", file.reachable);
  visit("min_arm_distance_mm", file.min_arm_distance_m, micro_mm);
  visit.maybe("min_couch_distance_mm", file.clear[robot::Surrounding::couch], micro_mm);
  visit.maybe("min_body_distance_mm", file.clear[robot::Surrounding::body], micro_mm);
  visit("min_tool_distance_mm", plan.min_tool_distance_m, micro_mm);
  visit("rail_m", file.rail_m, micro);
  visit("zones_touched", plan.zones_touched);
  english_fields(visit, "notes", plan.notes);
  visit("compute_ms", file.compute_ms, micro_ms);
  visit.list("paths", plan.paths, path_fields);
};

}  // namespace

PlanFile plan_file_of(const motion::ReadyPlan& ready, double compute_ms) {
  return {.plan = ready.plan,
          .reachable = ready.reachable,
          .min_arm_distance_m = ready.min_arm_distance_m,
          .clear = ready.clear,
          .rail_m = ready.rail_m,
          .compute_ms = compute_ms};
}

std::string to_json(const PlanFile& file) {
  return to_json(file, plan_fields).dump();
}

Result<PlanFile> parse_plan(std::string_view text, std::string_view name) {
  return parse_json<PlanFile>(text, name, "plan of `tuina plan`", plan_fields);
}

Result<PlanFile> read_plan(const std::filesystem::path& file) {
  constexpr std::size_t max_bytes = std::size_t{1} << 28;
  const auto text = read_file(file, max_bytes);
  if (!text) return tl::unexpected(text.error());
  return parse_plan(*text, file.string());
}

}  // namespace tuina::record
