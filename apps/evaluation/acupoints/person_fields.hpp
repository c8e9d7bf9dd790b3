// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>

#include "apps/evaluation/acupoints/trials.hpp"

namespace tuina::app {

template <typename Json>
void to_json(Json& json, const Finding& one) {
  const Vector3 &found = one.found_in_couch, &truth = one.true_in_couch;
  json = {{"person", one.person},
          {"type", one.type},
          {"position", one.position},
          {"arms", one.arms},
          {"point", one.point},
          {"found", {found.x(), found.y(), found.z()}},
          {"true", {truth.x(), truth.y(), truth.z()}},
          {"error_mm", one.error_mm},
          {"uncertainty_mm", one.uncertainty_mm},
          {"of_the_seven", one.of_the_seven}};
}
template <typename Json>
void from_json(const Json& json, Finding& one) {
  json.at("person").get_to(one.person);
  json.at("type").get_to(one.type);
  json.at("position").get_to(one.position);
  json.at("arms").get_to(one.arms);
  json.at("point").get_to(one.point);
  for (int i = 0; i < 3; ++i) {
    one.found_in_couch[i] = json.at("found").at(static_cast<std::size_t>(i)).template get<double>();
    one.true_in_couch[i] = json.at("true").at(static_cast<std::size_t>(i)).template get<double>();
  }
  json.at("error_mm").get_to(one.error_mm);
  json.at("uncertainty_mm").get_to(one.uncertainty_mm);
  json.at("of_the_seven").get_to(one.of_the_seven);
}

/// What every method did on one person.
struct PersonJudged {
  std::map<std::string, std::vector<Finding>> findings;
  std::map<std::string, std::vector<double>> compute_ms;
  std::map<std::string, std::vector<std::string>> failures;
  Times times;
};
template <typename Judged, typename Visit>
requires std::is_same_v<std::remove_const_t<Judged>, PersonJudged>
void visit_fields(Judged& judged, const Visit& visit) {
  visit("findings", judged.findings);
  visit("compute_ms", judged.compute_ms);
  visit("failures", judged.failures);
  visit("scan_s", judged.times.scan_s);
  visit("map_s", judged.times.map_s);
  visit("plan_s", judged.times.plan_s);
}

}  // namespace tuina::app
