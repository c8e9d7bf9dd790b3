// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace tuina {

/// Cells of a grid.
[[nodiscard]] constexpr std::size_t grid_cells(int rows, int columns) {
  return static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns);
}

/// The place of a cell in a grid that is laid row after row. Rows and columns begin at zero.
[[nodiscard]] constexpr std::size_t grid_index(int row, int columns, int column) {
  return grid_cells(row, columns) + static_cast<std::size_t>(column);
}

}  // namespace tuina
