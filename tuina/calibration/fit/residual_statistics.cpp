// SPDX-License-Identifier: Apache-2.0
#include "tuina/calibration/fit/residual_statistics.hpp"

#include <algorithm>
#include <cmath>

namespace tuina::calibration {
namespace {

double median_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

double robust_deviation(const std::vector<double>& sizes) {
  return sizes.empty() ? 1.0 : 1.4826 * median_of(sizes);
}

double deviation_without(const std::vector<double>& sizes, double left_out) {
  double sum2 = 0.0;
  double count = 0.0;
  for (const double size : sizes) {
    if (size > left_out) continue;
    sum2 += size * size;
    count += 1.0;
  }
  return count > 0.0 ? std::sqrt(sum2 / count) : 1.0;
}

double rows_alike(const std::vector<std::vector<double>>& errors, double left_out) {
  constexpr std::size_t farthest = 30;
  constexpr double vanished = 0.03;
  double alike = 1.0;
  for (std::size_t lag = 1; lag <= farthest; ++lag) {
    double product = 0.0;
    double square = 1e-12;
    for (const auto& line : errors) {
      for (std::size_t k = lag; k < line.size(); ++k) {
        if (std::abs(line[k]) > left_out || std::abs(line[k - lag]) > left_out) continue;
        product += line[k] * line[k - lag];
        square += 0.5 * (line[k] * line[k] + line[k - lag] * line[k - lag]);
      }
    }
    if (product < vanished * square) break;
    alike += 2.0 * product / square;
  }
  return alike;
}

}  // namespace tuina::calibration
