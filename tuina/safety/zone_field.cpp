// SPDX-License-Identifier: Apache-2.0
#include "tuina/safety/zone_field.hpp"

#include <algorithm>
#include <cmath>

#include "tuina/core/grid.hpp"

namespace tuina::safety {

const ZoneField::Cell* ZoneField::at(const Vector3& in_base) const noexcept {
  const Vector3 from_corner = in_base - corner_in_base;
  const double column = std::floor(from_corner.dot(along_in_base) / cell_m);
  const double row = std::floor(from_corner.dot(up_in_base) / cell_m);
  const double index = row * columns + column;
  const bool within = column >= 0.0 && column < columns && row >= 0.0;
  if (!(within && index < static_cast<double>(cells.size()))) return nullptr;
  return &cells[static_cast<std::size_t>(index)];
}

ZoneField ZoneField::reaching(double reach_m) const {
  ZoneField wide = *this;
  const auto reach = static_cast<std::int32_t>(reach_m / cell_m);
  for (std::int32_t row = 0; row < rows; ++row) {
    for (std::int32_t column = 0; column < columns; ++column) {
      Zone& zone = wide.cells[grid_index(row, columns, column)].zone;
      for (std::int32_t i = std::max(row - reach, 0); i <= std::min(row + reach, rows - 1); ++i) {
        for (std::int32_t j = std::max(column - reach, 0);
             j <= std::min(column + reach, columns - 1); ++j) {
          const bool near = (i - row) * (i - row) + (j - column) * (j - column) <= reach * reach;
          const Zone other = cells[grid_index(i, columns, j)].zone;
          if (near && ceiling_of(other).trip_n > ceiling_of(zone).trip_n) zone = other;
        }
      }
    }
  }
  return wide;
}

}  // namespace tuina::safety
