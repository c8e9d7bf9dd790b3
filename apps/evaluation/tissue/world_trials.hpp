// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "tuina/core/progress.hpp"
#include "tuina/sim/tissue_worlds.hpp"
#include "tuina/telemetry/table.hpp"

namespace tuina::app {

/// How well the force of a next press is foretold in one world: after the presses before, told
/// where the skin is by the measured force up to 1.5 N, at the true positions up to the peak.
/// Errors are shares of the force there.
struct WorldResult {
  int runs = 0;
  double median_error = 0.0, p90_error = 0.0;
  double tangent_p90_error = 0.0;  ///< of the tangent law as `PressEstimator` finds it
  double coverage = 0.0;           ///< share of the readings at the peak that the 95 % band holds
  double converged_share = 0.0;    ///< before the last press
  double wrong_share = 0.0;        ///< of these: the peak is more than 15 % off
};
inline constexpr double world_promise = 0.15;

/// `runs` records for every tissue and way of pressing. Same seed, same result, whatever the number
/// of threads.
[[nodiscard]] WorldResult run_world(const sim::TissueWorld& world, int runs, std::uint64_t seed,
                                    unsigned threads, const Progress& progress = {});

/// One row per world, for people and for JSON.
[[nodiscard]] telemetry::Table empty_world_table();
[[nodiscard]] telemetry::Row row_of(const sim::TissueWorld& world, const WorldResult& result);

}  // namespace tuina::app
