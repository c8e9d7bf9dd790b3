// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include "apps/evaluation/tissue/trials.hpp"
#include "apps/evaluation/tissue/world_trials.hpp"

namespace tuina::app {

/// Every value of what a method did, with its key: "tuina t95_s".
template <typename Results, typename Visit>
requires std::is_same_v<std::remove_const_t<Results>, TrialResults>
void visit_fields(Results& results, const Visit& visit) {
  for (const TrialMethod method : trial_methods) {
    auto& result = results[static_cast<std::size_t>(method)];
    const auto field = [&](const char* key, auto& value) {
      visit(fmt::format("{} {}", name_of(method), key).c_str(), value);
    };
    field("runs", result.runs);
    field("t95_s", result.t95_s);
    field("first_press_q95", result.first_press_q95);
    field("last_q95", result.last_q95);
    field("alpha_bias", result.alpha_bias);
    field("beta_bias", result.beta_bias);
    field("coverage_alpha", result.coverage_alpha);
    field("coverage_beta", result.coverage_beta);
    field("converged_share", result.converged_share);
    field("converged_median_s", result.converged_median_s);
    field("false_converged_share", result.false_converged_share);
    field("kept_share", result.kept_share);
    field("detectable_change", result.detectable_change);
    field("worse_q95", result.worse_q95);
  }
}

template <typename Result, typename Visit>
requires std::is_same_v<std::remove_const_t<Result>, WorldResult>
void visit_fields(Result& result, const Visit& visit) {
  visit("runs", result.runs);
  visit("median_error", result.median_error);
  visit("p90_error", result.p90_error);
  visit("tangent_p90_error", result.tangent_p90_error);
  visit("coverage", result.coverage);
  visit("converged_share", result.converged_share);
  visit("wrong_share", result.wrong_share);
}

}  // namespace tuina::app
