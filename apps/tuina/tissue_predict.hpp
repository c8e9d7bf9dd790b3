// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "tuina/core/result.hpp"
#include "tuina/tissue/creep_estimator.hpp"

namespace tuina::app {

/// CSV with time_s, force_n, force_low_n, force_high_n for the rows of a later press whose force is
/// left empty. `estimator` has seen the record that ends at `end_s`; the forces that are given tell
/// it where the skin is.
[[nodiscard]] Result<std::string> predict_forces(tissue::CreepEstimator estimator, double begin_s,
                                                 double end_s, const std::string& next_file);

}  // namespace tuina::app
