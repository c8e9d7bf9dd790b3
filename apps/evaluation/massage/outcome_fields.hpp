// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>

#include "apps/evaluation/massage/trials.hpp"

namespace tuina::app {

template <typename Press, typename Visit>
requires std::is_same_v<std::remove_const_t<Press>, GivenPress>
void visit_entry(Press& press, const Visit& visit) {
  visit("place", press.place);
  visit("technique", press.technique);
  visit("index", press.index);
  visit("probing", press.probing);
  visit("foretold", press.foretold);
  visit("foretold_wrong", press.foretold_wrong);
  visit("planned_n", press.planned_n);
  visit("asked_n", press.asked_n);
  visit("peak_n", press.peak_n);
  visit("held_n", press.held_n);
  visit("arm", press.arm);
  visit("contact_s", press.contact_s);
  visit("end_s", press.end_s);
}
template <typename Felt, typename Visit>
requires std::is_same_v<std::remove_const_t<Felt>, FeltTrial>
void visit_entry(Felt& felt, const Visit& visit) {
  visit("converged", felt.converged);
  visit("alpha_error", felt.alpha_error);
  visit("alpha_reach", felt.alpha_reach);
  visit("beta_error", felt.beta_error);
  visit("beta_reach", felt.beta_reach);
}

template <typename Entry>
concept OutcomeEntry = std::is_same_v<Entry, GivenPress> || std::is_same_v<Entry, FeltTrial>;

// The JSON library finds these two by their names.
template <OutcomeEntry Entry>
void to_json(nlohmann::ordered_json& json, const Entry& entry) {
  visit_entry(entry, [&](const char* key, const auto& value) { json[key] = value; });
}
template <OutcomeEntry Entry>
void from_json(const nlohmann::ordered_json& json, Entry& entry) {
  visit_entry(entry, [&](const char* key, auto& value) { json.at(key).get_to(value); });
}

/// Every value of an outcome with its key, for reading and for writing.
template <typename Outcome, typename Visit>
requires std::is_same_v<std::remove_const_t<Outcome>, SessionOutcome>
void visit_fields(Outcome& outcome, const Visit& visit) {
  visit("refused", outcome.refused);
  visit("stops", outcome.stops);
  visit("troubles", outcome.troubles);
  visit("left_out", outcome.left_out);
  visit("beyond", outcome.beyond);
  visit("duration_s", outcome.duration_s);
  visit("rmse_n", outcome.rmse_n);
  visit("overshoot_n", outcome.overshoot_n);
  visit("bony_peak_n", outcome.bony_peak_n);
  visit("over_cap_n", outcome.over_cap_n);
  visit("over_trip_n", outcome.over_trip_n);
  visit("unplanned_n", outcome.unplanned_n);
  visit("arm_distance_m", outcome.arm_distance_m);
  visit("tool_to_acupoint_m", outcome.tool_to_acupoint_m);
  visit("presses", outcome.presses);
  visit("felt", outcome.felt);
  visit("scan_to_touch_s", outcome.scan_to_touch_s);
  visit("plan_ms", outcome.plan_ms);
  visit("real_time_factor", outcome.real_time_factor);
}

}  // namespace tuina::app
