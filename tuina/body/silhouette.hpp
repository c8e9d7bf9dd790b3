// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "tuina/core/geometry.hpp"
#include "tuina/core/grid.hpp"

namespace tuina::body {

/// An interval of one row of the silhouette.
struct Run {
  double low = 0.0;
  double high = 0.0;
  [[nodiscard]] double width() const { return high - low; }           ///< width of the run, m
  [[nodiscard]] double middle() const { return 0.5 * (low + high); }  ///< middle of the run, m
};

/// Silhouette of a back on the plane (x, z) of the frame of its points, rasterised in cells of 5
/// mm; row 0 is the lowest.
class Silhouette {
 public:
  static constexpr double cell_m = 5e-3;

  /// The cells that points in the frame of the back cover; `spacing_m` is the distance of
  /// neighbouring points.
  Silhouette(const std::vector<Vector3>& in_back, double spacing_m);

  [[nodiscard]] int rows() const { return rows_; }  ///< rows of cells, from below
  /// Height of the middle of a row, m.
  [[nodiscard]] double height(int row) const { return low_.z() + (row + 0.5) * cell_m; }
  /// Row that a height in m lies in; beyond the ends the first or the last.
  [[nodiscard]] int row_of(double height) const;

  /// The interval of a row that holds `x`, else the nearest.
  [[nodiscard]] std::optional<Run> run(int row, double x) const;

 private:
  [[nodiscard]] bool at(int row, int column) const {
    return filled_[grid_index(row, columns_, column)];
  }
  Vector3 low_;
  Vector3 high_;
  int columns_ = 0;
  int rows_ = 0;
  std::vector<bool> filled_;
};

}  // namespace tuina::body
