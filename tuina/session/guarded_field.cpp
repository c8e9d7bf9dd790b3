// SPDX-License-Identifier: Apache-2.0
#include "tuina/session/guarded_field.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tuina/core/grid.hpp"
#include "tuina/massage/back_chart.hpp"
#include "tuina/massage/zones.hpp"
#include "tuina/session/guarded_zone.hpp"

namespace tuina::session {
namespace {

using Cell = safety::ZoneField::Cell;

constexpr double cell_m = 6e-3;  // wider than the points of a back stand apart
constexpr int mended_cells = 3;  // from each rim: closes gaps of six, and widens edges by three

/// Sum over the points of the skin that lie in one cell, and the strictest zone among them.
struct CellSum {
  int points = 0;
  Vector3 normal_in_base = Vector3::Zero();
  safety::Zone zone = safety::Zone::muscle;
};

safety::Zone stricter(safety::Zone a, safety::Zone b) {
  return safety::ceiling_of(a).trip_n <= safety::ceiling_of(b).trip_n ? a : b;
}

/// Gives each empty cell beside filled ones what these have together.
void close_gaps(std::vector<CellSum>& sums, int columns, int rows) {
  const std::vector<CellSum> before = sums;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      CellSum& sum = sums[grid_index(row, columns, column)];
      if (sum.points > 0) continue;
      for (int i = std::max(row - 1, 0); i <= std::min(row + 1, rows - 1); ++i) {
        for (int j = std::max(column - 1, 0); j <= std::min(column + 1, columns - 1); ++j) {
          const CellSum& beside = before[grid_index(i, columns, j)];
          if (beside.points == 0) continue;
          sum.zone = sum.points == 0 ? beside.zone : stricter(sum.zone, beside.zone);
          sum.normal_in_base += beside.normal_in_base;
          ++sum.points;
        }
      }
    }
  }
}

}  // namespace

Result<safety::ZoneField> zone_field(const body::BackSurface& back,
                                     std::span<const Acupoint> acupoints,
                                     std::span<const Landmark> landmarks,
                                     std::span<const massage::NoGo> no_go,
                                     const Transform& base_from_couch) {
  const auto chart = massage::BackChart::from(acupoints, landmarks);
  if (!chart) return tl::unexpected(chart.error());
  const massage::ZoneMap zones(*chart, acupoints, landmarks, no_go);
  const PointCloud& skin = back.points();
  Eigen::Array2d low = Eigen::Array2d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Array2d high = -low;
  const auto flat = [&](const Vector3& in_couch) {
    return Eigen::Array2d(in_couch.dot(chart->left()), in_couch.dot(chart->up()));
  };
  for (const Vector3& point : skin.points) {
    low = low.min(flat(point));
    high = high.max(flat(point));
  }
  low -= mended_cells * cell_m;  // there is skin beyond the rim, too
  high += mended_cells * cell_m;
  const Eigen::Array2i size = ((high - low) / cell_m).floor().cast<int>() + 1;
  const int columns = size.x(), rows = size.y();
  std::vector<CellSum> sums(grid_cells(rows, columns));
  for (std::size_t i = 0; i < skin.points.size(); ++i) {
    const Eigen::Array2i at = ((flat(skin.points[i]) - low) / cell_m).floor().cast<int>();
    CellSum& sum = sums[grid_index(at.y(), columns, at.x())];
    const safety::Zone zone = guarded_zone(zones.at(skin.points[i]));
    sum.zone = sum.points == 0 ? zone : stricter(sum.zone, zone);
    sum.normal_in_base += base_from_couch.linear() * skin.normals[i];
    ++sum.points;
  }
  for (int i = 0; i < mended_cells; ++i) close_gaps(sums, columns, rows);

  safety::ZoneField field{
      .corner_in_base = base_from_couch * Vector3(low.x() * chart->left() + low.y() * chart->up()),
      .along_in_base = base_from_couch.linear() * chart->left(),
      .up_in_base = base_from_couch.linear() * chart->up(),
      .cell_m = cell_m,
      .columns = columns,
      .rows = rows};
  const Vector3 out_in_base = base_from_couch.linear() * chart->out();
  field.cells.reserve(sums.size());
  for (const CellSum& sum : sums) {
    const bool known = sum.points > 0 && sum.normal_in_base.norm() > 0.5;
    const Vector3 normal = known ? sum.normal_in_base.normalized() : out_in_base;
    field.cells.push_back({known ? sum.zone : safety::Zone::denied, normal.cast<float>()});
  }
  return field;
}

}  // namespace tuina::session
