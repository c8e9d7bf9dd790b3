// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

namespace tuina::calibration {

/// The standard deviation of Gaussian errors some of which are not, from their absolute values.
[[nodiscard]] double robust_deviation(const std::vector<double>& sizes);

/// RMS of those that are not above `left_out`.
[[nodiscard]] double deviation_without(const std::vector<double>& sizes, double left_out);

/// How many neighbouring rows of a line err alike, as over the border of a black square or in a
/// grain of speckle: so many of them are worth one. 1 + 2 times the sum of the correlations, up to
/// where they vanish; `errors` are those of the lines, row by row, of which larger ones than
/// `left_out` are passed over.
[[nodiscard]] double rows_alike(const std::vector<std::vector<double>>& errors, double left_out);

}  // namespace tuina::calibration
