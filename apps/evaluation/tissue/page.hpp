// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tuina/telemetry/table.hpp"

namespace tuina::app {

/// The worse error of alpha and beta over time, 95 % quantile of the runs; empty if the method
/// gives none.
struct TissueCurve {
  std::string scenario, method, tissue;
  std::vector<double> worse_q95;
};

struct TissuePage {
  telemetry::Table table, worlds;
  std::vector<TissueCurve> curves;
  int runs = 0, arm_runs = 0;
  std::uint64_t seed = 1;
};

/// What `evaluate tissue` found, as one page that needs nothing else.
[[nodiscard]] std::string to_html(const TissuePage& page);

}  // namespace tuina::app
