// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "apps/evaluation/safety/trial.hpp"

namespace tuina::app {

/// Largest true force that a class may reach where so much was set.
[[nodiscard]] double allowed_n(const Promise& promise, double set_force_n);

/// What an outcome breaks of the promise of its class, a sentence each.
[[nodiscard]] std::vector<std::string> broken_promises(const FaultClass& fault, Stage stage,
                                                       const TrialOutcome& outcome);

/// Upper end of the exact one-sided interval for a share of which `violations` were seen in `runs`
/// [clopper1934]: the share with which so few are seen once in 1 / (1 - confidence).
[[nodiscard]] double clopper_pearson_upper(std::size_t violations, std::size_t runs,
                                           double confidence = 0.95);

}  // namespace tuina::app
