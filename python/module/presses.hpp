// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <cmath>

#include "python/module/parts.hpp"

namespace tuina::python {

/// A record that was judged as it came in: times grow, all is finite.
struct Presses {
  std::vector<tissue::TimedPress> rows;
};

/// What an estimator said after each sample.
struct History {
  std::vector<double> time_s;
  std::vector<TissueEstimate> after;

  void add(double time, const TissueEstimate& estimate) {
    time_s.push_back(time);
    after.push_back(estimate);
  }
};

/// Refuses what no tissue is.
[[nodiscard]] inline TangentTissue tissue_of(double alpha_n, double beta_per_m) {
  const std::pair<const char*, double> both[] = {{"alpha_n", alpha_n}, {"beta_per_m", beta_per_m}};
  for (const auto& [name, value] : both) {
    if (!(value > 0.0 && std::isfinite(value)))
      throw Refused{{Fault::usage, fmt::format("{} is {}; more than 0 is needed", name, value)}};
  }
  return {alpha_n, beta_per_m};
}

/// Refuses what is no standard deviation.
[[nodiscard]] tissue::KnownNoise known_noise(const std::optional<double>& force_n,
                                             const std::optional<double>& position_m);

}  // namespace tuina::python
