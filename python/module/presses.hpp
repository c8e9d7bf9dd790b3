// SPDX-License-Identifier: Apache-2.0
#pragma once

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

/// Refuses what is no standard deviation.
[[nodiscard]] tissue::KnownNoise known_noise(const std::optional<double>& force_n,
                                             const std::optional<double>& position_m);

}  // namespace tuina::python
