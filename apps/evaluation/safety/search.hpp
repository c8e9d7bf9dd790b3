// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

#include "apps/evaluation/safety/trial.hpp"
#include "tuina/core/progress.hpp"

namespace tuina::app {

/// All that may be chosen about a trial of one class, as numbers from 0 to 1: place, stage, time in
/// it, severity, direction, tissue (two), friction, elbow, joint, and what the controller believes.
using Choices = std::array<double, 11>;
[[nodiscard]] Choices any_choices(Random& random);

/// The trial for these choices. Severity is 0.3 to 1 of what the table says, so that its promises
/// hold; tissue is twice as hard and twice as soft as anybody of Table 6-2; directions are within
/// 30 degrees of the normal, friction is 0.5 to 1.5 of the table.
[[nodiscard]] TrialPlan trial_of(const FaultClass& fault, const std::vector<Site>& sites,
                                 const Choices& choices);

/// The worst trial of a class that was found, and what the class allows there.
struct WorstTrial {
  const FaultClass* fault = nullptr;
  TrialPlan plan;
  double worst_force_n = 0.0;
  double allowed_n = 0.0;
  [[nodiscard]] bool holds() const { return worst_force_n <= allowed_n; }
};

/// Seeks the largest true force of each class, or of the class `only`, with an evolution strategy
/// of four parents and so many trials [beyer2002]. The result depends on the seed alone.
[[nodiscard]] Result<std::vector<WorstTrial>> search_worst(const std::vector<Site>& sites,
                                                           const std::string& only,
                                                           std::size_t trials, std::uint64_t seed,
                                                           const Progress& progress);

/// The trials as JSON, a row each, and back; `sites` must outlive what is read. Fails with
/// Fault::bad_input, naming the row, where a class or a place does not exist.
[[nodiscard]] std::string to_json(const std::vector<WorstTrial>& worst);
[[nodiscard]] Result<std::vector<WorstTrial>> parse_worst(const std::string& json,
                                                          const std::vector<Site>& sites);

}  // namespace tuina::app
