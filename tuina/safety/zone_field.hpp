// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "tuina/core/geometry.hpp"
#include "tuina/safety/limits.hpp"

namespace tuina::safety {

/// What a guard knows of one person's back by itself: zone and outward normal of the skin, on a
/// grid of equal cells in the plane of the back.
struct ZoneField {
  /// One cell of the grid.
  struct Cell {
    Zone zone = Zone::denied;
    Eigen::Vector3f normal_in_base = Eigen::Vector3f::UnitZ();  ///< unit, out of the body
  };

  Vector3 corner_in_base = Vector3::Zero();  ///< corner of the first cell
  Vector3 along_in_base = Vector3::UnitX();  ///< unit; the way from column to column
  Vector3 up_in_base = Vector3::UnitY();     ///< unit, across `along`; the way from row to row
  double cell_m = 5e-3;
  std::int32_t columns = 0, rows = 0;
  std::vector<Cell> cells;  ///< row after row; columns * rows of them, or none

  /// Whether nothing of the person is known.
  [[nodiscard]] bool empty() const noexcept { return cells.empty(); }
  /// The cell that a place lies over; null beside the grid.
  [[nodiscard]] const Cell* at(const Vector3& in_base) const noexcept;

  /// The same with every zone reaching `reach_m` further into stricter ones: a person may have
  /// shifted by that much since the scan, and the plan keeps its own distance from every border.
  [[nodiscard]] ZoneField reaching(double reach_m) const;
};

}  // namespace tuina::safety
