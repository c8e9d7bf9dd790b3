// SPDX-License-Identifier: Apache-2.0
#include "tuina/body/silhouette.hpp"

#include <algorithm>
#include <cmath>

#include "tuina/core/units.hpp"

namespace tuina::body {
namespace {

constexpr double bridge_m = 16_mm;  // largest gap of a sweep that is not a gap of the person

}  // namespace

Silhouette::Silhouette(const std::vector<Vector3>& in_back, double spacing_m) {
  low_ = high_ = in_back.front();
  for (const Vector3& p : in_back) {
    low_ = low_.cwiseMin(p);
    high_ = high_.cwiseMax(p);
  }
  const double reach = 1.1 * std::max(spacing_m, 6_mm);
  low_ -= Vector3::Constant(reach + cell_m);
  high_ += Vector3::Constant(reach + cell_m);
  columns_ = static_cast<int>((high_.x() - low_.x()) / cell_m) + 1;
  rows_ = static_cast<int>((high_.z() - low_.z()) / cell_m) + 1;
  filled_.assign(grid_cells(rows_, columns_), false);
  const int span = static_cast<int>(std::ceil(reach / cell_m));
  for (const Vector3& p : in_back) {
    const double u = (p.x() - low_.x()) / cell_m;
    const double h = (p.z() - low_.z()) / cell_m;
    for (int row = static_cast<int>(h) - span; row <= static_cast<int>(h) + span; ++row) {
      for (int column = static_cast<int>(u) - span; column <= static_cast<int>(u) + span;
           ++column) {
        const double far = std::hypot(column + 0.5 - u, row + 0.5 - h) * cell_m;
        if (far < reach && row >= 0 && row < rows_ && column >= 0 && column < columns_) {
          filled_[grid_index(row, columns_, column)] = true;
        }
      }
    }
  }
}

int Silhouette::row_of(double height) const {
  return std::clamp(static_cast<int>((height - low_.z()) / cell_m), 0, rows_ - 1);
}

std::optional<Run> Silhouette::run(int row, double x) const {
  std::optional<Run> best;
  double nearest = 0.08;
  for (int column = 0; column < columns_;) {
    if (!at(row, column)) {
      ++column;
      continue;
    }
    int end = column + 1;
    int gap = 0;
    for (int next = end; next < columns_ && gap * cell_m < bridge_m; ++next) {
      gap = at(row, next) ? 0 : gap + 1;
      if (gap == 0) end = next + 1;
    }
    const Run found{low_.x() + column * cell_m, low_.x() + end * cell_m};
    const double distance = std::max({0.0, found.low - x, x - found.high});
    if (distance < nearest) {
      nearest = distance;
      best = found;
    }
    column = end;
  }
  return best;
}

}  // namespace tuina::body
