// SPDX-License-Identifier: Apache-2.0
#include "tuina/safety/zone_field.hpp"

#include <doctest/doctest.h>

using namespace tuina;
using namespace tuina::safety;

namespace {

/// Four columns along y, three rows up along z, seen from the front; each cell has a normal of its
/// own to be known by.
ZoneField four_by_three(Zone zone = Zone::bony) {
  ZoneField field{.corner_in_base = {1.0, 0.1, 0.2},
                  .along_in_base = Vector3::UnitY(),
                  .up_in_base = Vector3::UnitZ(),
                  .cell_m = 0.01,
                  .columns = 4,
                  .rows = 3};
  for (int i = 0; i < 12; ++i)
    field.cells.push_back({zone, Eigen::Vector3f(static_cast<float>(i), 0.0F, 0.0F)});
  return field;
}

int cell_at(const ZoneField& field, double y_m, double z_m, double x_m = 1.0) {
  const ZoneField::Cell* cell = field.at({x_m, y_m, z_m});
  return cell == nullptr ? -1 : static_cast<int>(cell->normal_in_base.x());
}

/// A map of one row or column of bone with one cell of muscle in its middle; how many cells to
/// either side are muscle once it reaches that far.
int reached(double reach_m, bool upward) {
  ZoneField field{.cell_m = 5e-3, .columns = upward ? 1 : 21, .rows = upward ? 21 : 1};
  field.cells.resize(21, {Zone::bony});
  field.cells[10].zone = Zone::muscle;
  const ZoneField wide = field.reaching(reach_m);
  int cells = 0;
  for (std::size_t i = 0; i < 21; ++i)
    if (wide.cells[i].zone == Zone::muscle) ++cells;
  return (cells - 1) / 2;
}

}  // namespace

TEST_CASE("a place lies over one cell, however far before or behind the skin") {
  const ZoneField field = four_by_three();
  CHECK(cell_at(field, 0.1001, 0.2001) == 0);
  CHECK(cell_at(field, 0.1099, 0.2099) == 0);
  CHECK(cell_at(field, 0.1101, 0.2001) == 1);
  CHECK(cell_at(field, 0.1399, 0.2001) == 3);
  CHECK(cell_at(field, 0.1001, 0.2101) == 4);
  CHECK(cell_at(field, 0.1399, 0.2299) == 11);
  CHECK(cell_at(field, 0.1250, 0.2150, 7.0) == 6);
  CHECK(cell_at(field, 0.1250, 0.2150, -7.0) == 6);
}

TEST_CASE("beside the grid, or nowhere, there is no cell") {
  const ZoneField field = four_by_three();
  const double nowhere = std::numeric_limits<double>::quiet_NaN();
  CHECK(cell_at(field, 0.0999, 0.2150) == -1);
  CHECK(cell_at(field, 0.1550, 0.2050) == -1);
  CHECK(cell_at(field, 0.1401, 0.2150) == -1);
  CHECK(cell_at(field, 0.1250, 0.1999) == -1);
  CHECK(cell_at(field, 0.1250, 0.2301) == -1);
  CHECK(cell_at(field, nowhere, 0.2150) == -1);
  CHECK(cell_at(field, 0.1250, nowhere) == -1);
  CHECK(cell_at(field, 1e300, 0.2150) == -1);
  CHECK(cell_at({}, 0.0, 0.0) == -1);
  CHECK(ZoneField{}.empty());
  CHECK_FALSE(field.empty());
}

TEST_CASE("a grid with fewer cells than it says has none where they lack") {
  ZoneField field = four_by_three();
  field.cells.resize(11);
  CHECK(cell_at(field, 0.1299, 0.2299) == 10);
  CHECK(cell_at(field, 0.1399, 0.2299) == -1);
}

TEST_CASE("a corner of the grid and the first cell's edge belong to it, the last one's not") {
  ZoneField field = four_by_three();
  field.corner_in_base.setZero();
  field.cell_m = 0.25;
  CHECK(cell_at(field, 0.0, 0.0) == 0);
  CHECK(cell_at(field, 0.25, 0.5) == 9);
  CHECK(cell_at(field, 1.0, 0.0) == -1);
  CHECK(cell_at(field, 0.0, 0.75) == -1);
}

TEST_CASE("a zone reaches as many whole cells into a stricter one as fit into its reach") {
  for (const bool upward : {false, true}) {
    CHECK(reached(0.0, upward) == 0);
    CHECK(reached(4.9e-3, upward) == 0);
    CHECK(reached(5.1e-3, upward) == 1);
    CHECK(reached(14.9e-3, upward) == 2);
    CHECK(reached(20.1e-3, upward) == 4);
    CHECK(reached(1.0, upward) == 10);
  }
}

TEST_CASE("a zone reaches in a circle, and never into a milder one") {
  ZoneField field{.cell_m = 5e-3, .columns = 7, .rows = 9};
  field.cells.resize(63, {Zone::spine, Eigen::Vector3f(0.6F, 0.0F, 0.8F)});
  field.cells[4 * 7 + 3].zone = Zone::kidney;
  field.cells[4 * 7 + 6].zone = Zone::muscle;
  const ZoneField wide = field.reaching(11e-3);
  for (int row = 0; row < 9; ++row) {
    for (int column = 0; column < 7; ++column) {
      const auto& cell = wide.cells[static_cast<std::size_t>(row * 7 + column)];
      const auto within = [&](int at) {
        return (row - 4) * (row - 4) + (column - at) * (column - at) <= 4;
      };
      CAPTURE(row);
      CAPTURE(column);
      CHECK(cell.zone == (within(6) ? Zone::muscle : within(3) ? Zone::kidney : Zone::spine));
      CHECK(cell.normal_in_base == Eigen::Vector3f(0.6F, 0.0F, 0.8F));
    }
  }
  CHECK(wide.columns == 7);
  CHECK(wide.rows == 9);
  CHECK(wide.cell_m == 5e-3);
}

TEST_CASE("zones that bear alike stay as they are beside each other") {
  ZoneField field{.cell_m = 5e-3, .columns = 3, .rows = 1};
  field.cells = {{Zone::spine}, {Zone::denied}, {Zone::spine}};
  const ZoneField wide = field.reaching(15e-3);
  for (std::size_t i = 0; i < 3; ++i) CHECK(wide.cells[i].zone == field.cells[i].zone);
}

TEST_CASE("a cell that nobody has filled in is denied, and its way out is up") {
  CHECK(ZoneField::Cell{}.zone == Zone::denied);
  CHECK(ZoneField::Cell{}.normal_in_base == Eigen::Vector3f::UnitZ());
  CHECK(ZoneField{}.columns == 0);
  CHECK(ZoneField{}.rows == 0);
  CHECK(ZoneField{}.cell_m == 5e-3);
}
