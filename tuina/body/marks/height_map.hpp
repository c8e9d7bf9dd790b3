// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "tuina/body/back_surface.hpp"
#include "tuina/core/units.hpp"

namespace tuina::body {

/// Heights of the skin over a plane across the mean normal of a back, in square cells, as a scanner
/// in front of it sees them: what lies behind something else is left out.
class HeightMap {
 public:
  static constexpr double cell_m = 2_mm;

  /// Points of the cloud that lie far from `back`, such as couch and arms, are left out.
  HeightMap(const PointCloud& scan_in_couch, const BackSurface& back);

  [[nodiscard]] int columns() const { return columns_; }
  [[nodiscard]] int rows() const { return rows_; }
  /// Height of a cell, m; NaN where nothing was seen, as beyond the borders.
  [[nodiscard]] double at(int column, int row) const;
  /// The place in couch at this height over a place on the plane.
  [[nodiscard]] Vector3 place(double column, double row, double height_m) const;
  /// Typical distance of neighbouring points.
  [[nodiscard]] double spacing_m() const { return spacing_m_; }

 private:
  [[nodiscard]] std::size_t cell_of(const Vector3& seen) const;
  [[nodiscard]] double spacing_of(const std::vector<Vector3>& seen) const;

  Vector3 out_ = Vector3::Zero(), across_ = Vector3::Zero(), along_ = Vector3::Zero();
  Vector3 corner_ = Vector3::Zero();
  int columns_ = 0, rows_ = 0;
  double spacing_m_ = 0.0;
  std::vector<double> heights_;
};

}  // namespace tuina::body
