// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <limits>
#include <type_traits>
#include <vector>

#include "apps/evaluation/scanner/trials.hpp"

/// What the cells of `evaluate scanner` are written as.
namespace tuina::app {

/// Every value of an outcome with its key, for reading and for writing.
template <typename Outcome, typename Visit>
requires std::is_same_v<std::remove_const_t<Outcome>, BackTrial>
void visit_fields(Outcome& back, const Visit& visit) {
  visit("rms_m", back.rms_m);
  visit("bias_m", back.bias_m);
  visit("expected_m", back.expected_m);
  visit("outlier_share", back.outlier_share);
  visit("seen_share", back.seen_share);
  visit("covered_points", back.covered_points);
  visit("refused", back.refused);
}

/// Largest error of the latency; NaN where no scanner was calibrated.
struct LatencyTrial {
  double worst_s = std::numeric_limits<double>::quiet_NaN();
};
template <typename Outcome, typename Visit>
requires std::is_same_v<std::remove_const_t<Outcome>, LatencyTrial>
void visit_fields(Outcome& latency, const Visit& visit) {
  visit("worst_s", latency.worst_s);
}

/// Walls one after the other, the values of each in the order of `visit_wall`.
struct WallNumbers {
  std::vector<double> values;
};
template <typename Outcome, typename Visit>
requires std::is_same_v<std::remove_const_t<Outcome>, WallNumbers>
void visit_fields(Outcome& walls, const Visit& visit) {
  visit("values", walls.values);
}

template <typename Wall, typename Visit>
void visit_wall(Wall& wall, const Visit& visit) {
  visit(wall.depth_m);
  for (auto* errors : {&wall.nominal, &wall.fitted, &wall.ours}) {
    visit(errors->rms_m);
    visit(errors->systematic_m);
    visit(errors->random_m);
  }
  visit(wall.bound_px);
  visit(wall.line_px);
  visit(wall.predicted_m);
}

[[nodiscard]] inline WallNumbers numbers_of(const std::vector<WallTrial>& walls) {
  WallNumbers numbers;
  for (const WallTrial& wall : walls)
    visit_wall(wall, [&](double value) { numbers.values.push_back(value); });
  return numbers;
}

/// A wall that was not written whole is left out.
[[nodiscard]] inline std::vector<WallTrial> walls_of(const WallNumbers& numbers) {
  constexpr std::size_t values_each = 13;
  std::vector<WallTrial> walls(numbers.values.size() / values_each);
  auto next = numbers.values.begin();
  for (WallTrial& wall : walls) visit_wall(wall, [&](double& value) { value = *next++; });
  return walls;
}

}  // namespace tuina::app
