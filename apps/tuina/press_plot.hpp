// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tuina/core/contact.hpp"
#include "tuina/tissue/curve_fit.hpp"

namespace tuina::app {

/// Force over depth: the samples, the fitted curve and where it could lie with 95 %.
[[nodiscard]] std::string plot_fit(const std::vector<tissue::TimedPress>& record,
                                   const tissue::CurveFit& fit);

struct TimedEstimate {
  double time_s;
  TissueEstimate estimate;
};

/// Alpha and beta over time with their intervals, one drawing above the other; dashed beside them
/// the truth, if it is known.
[[nodiscard]] std::string plot_estimates(const std::vector<TimedEstimate>& estimates,
                                         const std::optional<TangentTissue>& truth);

}  // namespace tuina::app
