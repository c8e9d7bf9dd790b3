// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "tuina/core/sentence.hpp"
#include "tuina/record/json_fields.hpp"

/// Fields of what stands in the JSON of more than one file or command.
namespace tuina::record {

/// An acupoint without its name, which stands before it in some files and is its key in others.
inline constexpr auto acupoint_fields = [](auto& visit, auto& point) {
  visit("position_m", point.at_in_couch);
  visit("normal", point.normal_in_couch);
  visit("uncertainty_mm", point.uncertainty_m, mm);
};

inline constexpr auto tangent_fields = [](auto& visit, auto& tissue) {
  visit("alpha_n", tissue.alpha_n);
  visit("beta_per_mm", tissue.beta_per_m, per_mm);
};

inline constexpr auto noise_fields = [](auto& visit, auto& noise) {
  visit("force_n", noise.force_n);
  visit("position_mm", noise.position_m, mm);
};

inline constexpr auto force_fields = [](auto& visit, auto& errors) {
  visit.maybe("rmse_n", errors.rmse_n);
  visit("peak_n", errors.peak_n);
  visit("overshoot_n", errors.overshoot_n);
};

inline constexpr auto order_fields = [](auto& visit, auto& order) {
  visit("person", order.person);
  visit("position", order.position);
  visit("programme", order.programme);
  visit.maybe("robot", order.robot);  // a version that knew one robot may have written it
  visit("method", order.method);
  visit("atlas", order.atlas);
  visit("no_go", order.no_go);
  visit("robot_pose", order.robot_pose);
  visit("body_mass_index", order.facts.mass_index);
  visit("body_fat_percent", order.facts.fat_percent);
  visit("adaptive", order.adaptive);
  visit.maybe("intensity", order.intensity);
};

inline constexpr auto decision_fields = [](auto& visit, auto& made) {
  visit("time_s", made.time_s);
  visit("arm", made.arm);
  visit("path", made.path);
  visit("rule", made.rule);
  visit("reason", made.reason);
  visit.maybe("key", made.key);  // versions that spoke English alone wrote none
  visit("from_n", made.from_n);
  visit("to_n", made.to_n);
};

/// Of a sentence whose English stands elsewhere: what says it in another language.
inline constexpr auto spoken_fields = [](auto& visit, auto& sentence) {
  visit("key", sentence.key);
  visit("values", sentence.values);
};

/// Likewise, as an object beside the English. Versions that spoke English alone wrote none.
inline constexpr auto key_fields = [](auto& visit, const char* key, auto& sentence) {
  constexpr bool writes = std::is_const_v<std::remove_reference_t<decltype(sentence)>>;
  if (writes ? sentence.key.empty() : !visit.has(key)) return;
  visit.object(key, [&](auto& inside) { spoken_fields(inside, sentence); });
};

/// Sentences as a list of their English.
inline constexpr auto english_fields = [](auto& visit, const char* key, auto& sentences) {
  std::vector<std::string> words = words_of(sentences);
  visit(key, words);
  if constexpr (requires { sentences.clear(); }) {
    sentences.clear();
    for (std::string& one : words) sentences.push_back({.words = std::move(one)});
  }
};

inline constexpr auto stop_fields = [](auto& visit, auto& stop) {
  visit("time_s", stop.time_s);
  visit("cause", stop.cause.words);
};

}  // namespace tuina::record
