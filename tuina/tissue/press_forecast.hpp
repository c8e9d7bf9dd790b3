// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "tuina/core/result.hpp"
#include "tuina/tissue/creep_estimator.hpp"
#include "tuina/tissue/press_record.hpp"

namespace tuina::tissue {

/// The force that one row of a later press is going to meet.
struct ForetoldForce {
  double time_s = 0.0;
  CreepEstimator::ForceBand band;
};

/// Foretells the forces of a later press, for its rows whose force is NaN; the forces that are
/// given tell where the skin is. `estimator` has seen the record from `begin_s` to `end_s`. Rows
/// that begin after `end_s` follow on the record by its clock. Rows that begin at `begin_s` or
/// before have a clock of their own; the press then counts as a minute later than the record, when
/// the tissue has forgotten it. Fails with bad_input for a press that begins within the record,
/// without rows, and where every force is given.
[[nodiscard]] Result<std::vector<ForetoldForce>> foretell_press(CreepEstimator estimator,
                                                                double begin_s, double end_s,
                                                                std::span<const TimedPress> rows);

}  // namespace tuina::tissue
