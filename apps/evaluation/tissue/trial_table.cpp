// SPDX-License-Identifier: Apache-2.0
#include "apps/evaluation/tissue/trial_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace tuina::app {
namespace {

/// JSON has no infinity: never is null.
nlohmann::json number(double value) {
  return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json();
}

bool has_interval(TrialMethod method) {
  return method == TrialMethod::tuina || method == TrialMethod::kalman ||
         method == TrialMethod::batch;
}

std::string cell(double value, double scale) {
  if (std::isnan(value)) return "-";
  if (std::isinf(value)) return "never";
  const double shown = scale * value;
  if (std::abs(shown) >= 999.5) return ">999";
  return fmt::format("{:.{}f}", shown, std::abs(shown) >= 99.95 ? 0 : scale == 1.0 ? 2 : 1);
}

/// Three tissues in one cell; "never/never/never" says no more than "never".
std::string three_of(const std::array<TrialResult, 3>& r, double TrialResult::*member,
                     double scale) {
  const std::array cells = {cell(r[0].*member, scale), cell(r[1].*member, scale),
                            cell(r[2].*member, scale)};
  if (cells[0] == cells[1] && cells[1] == cells[2]) return cells[0];
  return fmt::format("{}/{}/{}", cells[0], cells[1], cells[2]);
}

}  // namespace

nlohmann::json to_json(const TrialResult& r, TrialMethod method) {
  nlohmann::json json = {{"runs", r.runs},
                         {"t95_s", number(r.t95_s)},
                         {"q95_first_press", number(r.first_press_q95)},
                         {"q95_last", number(r.last_q95)},
                         {"alpha_bias", number(r.alpha_bias)},
                         {"beta_bias", number(r.beta_bias)},
                         {"kept_share", r.kept_share},
                         {"detectable_change", number(r.detectable_change)}};
  json["coverage"] =
      has_interval(method) ? number(std::min(r.coverage_alpha, r.coverage_beta)) : nlohmann::json();
  if (method == TrialMethod::tuina) {
    json["converged_share"] = r.converged_share;
    json["converged_median_s"] = number(r.converged_median_s);
    json["false_converged_share"] = r.false_converged_share;
  }
  return json;
}

TrialResult worst_of(const std::array<TrialResult, 3>& results) {
  TrialResult worst = results[0];
  const auto larger = [](double a, double b) {
    return std::isnan(a) ? b : std::isnan(b) ? a : std::max(a, b);
  };
  const auto wider = [](double a, double b) { return std::abs(b) > std::abs(a) ? b : a; };
  for (const TrialResult& r : results) {
    worst.t95_s = larger(worst.t95_s, r.t95_s);
    worst.first_press_q95 = larger(worst.first_press_q95, r.first_press_q95);
    worst.last_q95 = larger(worst.last_q95, r.last_q95);
    worst.alpha_bias = wider(worst.alpha_bias, r.alpha_bias);
    worst.beta_bias = wider(worst.beta_bias, r.beta_bias);
    worst.detectable_change = larger(worst.detectable_change, r.detectable_change);
    worst.coverage_alpha = std::min(worst.coverage_alpha, r.coverage_alpha);
    worst.coverage_beta = std::min(worst.coverage_beta, r.coverage_beta);
    worst.kept_share = std::min(worst.kept_share, r.kept_share);
    worst.converged_share = std::min(worst.converged_share, r.converged_share);
    worst.converged_median_s = larger(worst.converged_median_s, r.converged_median_s);
    worst.false_converged_share = larger(worst.false_converged_share, r.false_converged_share);
  }
  return worst;
}

telemetry::Table empty_table() {
  telemetry::Table table{
      .note =
          "Bone/hard/soft. t95: from then on 95 % of the runs stay within 5 %. Errors: 95 % "
          "quantile of the worse one of α and β. Bias and coverage of the 95 % intervals: α/β of "
          "the worst tissue. Detectable: smallest change of α between two such records that can "
          "be told from noise. False: called converged while beyond the promise, of all runs."};
  for (const char* head : {"method", "t95, s", "one press, %", "at the end, %", "bias, %",
                           "coverage", "detectable, %", "converged, %", "after, s", "false, %"})
    table.columns.push_back({.head = head});
  return table;
}

std::vector<telemetry::Cell> cells_of(TrialMethod method, const std::array<TrialResult, 3>& r) {
  const TrialResult worst = worst_of(r);
  const bool ours = method == TrialMethod::tuina;
  return {name_of(method),
          three_of(r, &TrialResult::t95_s, 1.0),
          three_of(r, &TrialResult::first_press_q95, 100.0),
          three_of(r, &TrialResult::last_q95, 100.0),
          fmt::format("{}/{}", cell(worst.alpha_bias, 100.0), cell(worst.beta_bias, 100.0)),
          has_interval(method)
              ? fmt::format("{:.2f}/{:.2f}", worst.coverage_alpha, worst.coverage_beta)
              : "-",
          three_of(r, &TrialResult::detectable_change, 100.0),
          ours ? three_of(r, &TrialResult::converged_share, 100.0) : "-",
          ours ? three_of(r, &TrialResult::converged_median_s, 1.0) : "-",
          ours ? cell(worst.false_converged_share, 100.0) : "-"};
}

}  // namespace tuina::app
