// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

namespace tuina::calibration {

/// Robust standard deviation of Gaussian errors with outliers, from absolute values.
[[nodiscard]] double robust_deviation(const std::vector<double>& sizes);

/// RMS of the values up to `left_out`.
[[nodiscard]] double deviation_without(const std::vector<double>& sizes, double left_out);

/// Number of neighbouring rows of a line per independent error (edges of squares and speckle
/// correlate them): 1 + 2 times the sum of the autocorrelation up to its zero. `errors`: row by row
/// per line; those above `left_out` are skipped.
[[nodiscard]] double rows_alike(const std::vector<std::vector<double>>& errors, double left_out);

}  // namespace tuina::calibration
