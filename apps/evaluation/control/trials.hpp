// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/evaluation/cells.hpp"
#include "apps/evaluation/contact/contact_experiment.hpp"

namespace tuina::app {

/// The worst of many contact experiments, each number by itself, all of the TRUE contact force.
struct ControlResult {
  int runs = 0;
  int stopped = 0;
  double rmse_n = 0.0;
  double overshoot_n = 0.0;
  double ripple_n = 0.0;
  double highest_n = 0.0;
  double max_speed_m_per_s = 0.0;
  double second_impact_n = 0.0;

  void add(const ContactOutcome& outcome);
  void add(const ControlResult& other);
};

/// What a row should not exceed; what is not limited is not judged.
struct ControlTarget {
  std::optional<double> rmse_n, overshoot_n, highest_n, max_speed_m_per_s, second_impact_n;

  [[nodiscard]] bool reached(const ControlResult& result) const;
};

struct ControlRow {
  std::vector<std::pair<std::string, std::string>> labels;  ///< what is tried: name and value
  std::vector<ContactExperiment> runs;
  std::optional<ControlTarget> target = {};
  ControlResult result = {};

  [[nodiscard]] const std::string& label(const std::string& name) const;
};

struct ControlTable {
  std::string name;   ///< its key
  std::string about;  ///< a sentence
  std::vector<ControlRow> rows;
};

/// All tables of `evaluate control`, not yet run. The full form tries every combination and four
/// seeds, the other enough of both to see the same.
[[nodiscard]] std::vector<ControlTable> control_tables(bool full, std::uint64_t seed);

/// Runs them side by side, a cell for each experiment; the results do not depend on how many
/// threads there are.
[[nodiscard]] Result<void> run_tables(std::vector<ControlTable>& tables, Cells& cells,
                                      unsigned threads, const Progress& progress);

/// Every value of a result with its key, for reading and for writing.
template <typename Outcome, typename Visit>
requires std::is_same_v<std::remove_const_t<Outcome>, ControlResult>
void visit_fields(Outcome& result, const Visit& visit) {
  visit("runs", result.runs);
  visit("stopped", result.stopped);
  visit("rmse_n", result.rmse_n);
  visit("overshoot_n", result.overshoot_n);
  visit("ripple_n", result.ripple_n);
  visit("highest_n", result.highest_n);
  visit("max_speed_m_per_s", result.max_speed_m_per_s);
  visit("second_impact_n", result.second_impact_n);
}

/// Rows that agree in these labels, put together.
[[nodiscard]] ControlTable grouped(const ControlTable& table,
                                   const std::vector<std::string>& labels);

/// The controllers that are compared: name and what makes them.
struct ControllerChoice {
  std::string name;
  control::ControlLaw law;
  double mass_kg;  ///< M_e of [thesis] (3.5); others do not use it
};
[[nodiscard]] const std::vector<ControllerChoice>& controller_choices();
void choose(ContactExperiment& experiment, const ControllerChoice& choice);

inline constexpr TangentTissue bone = {4.559, 263.2}, hard_muscle = {9.786, 185.4},
                               soft_muscle = {4.275, 143.6};  ///< [thesis] chapter 6

}  // namespace tuina::app
