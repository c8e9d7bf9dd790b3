// SPDX-License-Identifier: Apache-2.0
#include "tuina/body/marks/bumps.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "tuina/body/marks/height_map.hpp"
#include "tuina/core/decompositions.hpp"
#include "tuina/core/units.hpp"

namespace tuina::body {
namespace {

constexpr double cell_m = HeightMap::cell_m;
constexpr double max_spacing_m = 2.5_mm;  // a marker of 6 mm then has five points
constexpr int reach = 14;                 // cells to each side of a bump that are looked at
constexpr double inner_m = 4.2_mm, ring_from_m = 11_mm, ring_to_m = 26_mm;
constexpr double min_response_m = 0.3_mm;  // of a bump against its ring, before any skin is fitted
constexpr double min_height_m = 1.2_mm, min_above_noise = 3.5;
constexpr double max_side_share = 0.25;  // of its height that may be left beside it
constexpr double min_width_m = 4_mm, max_width_m = 16_mm, max_lengthwise = 2.3;
constexpr double min_facing = 0.65;  // cosine between the skin there and the line of sight

struct Offset {
  int column, row;
  double radius_m;
};

std::vector<Offset> offsets(double from_m, double to_m) {
  std::vector<Offset> all;
  for (int row = -reach; row <= reach; ++row) {
    for (int column = -reach; column <= reach; ++column) {
      const double radius_m = std::hypot(column, row) * cell_m;
      if (radius_m >= from_m && radius_m <= to_m) all.push_back({column, row, radius_m});
    }
  }
  return all;
}

const std::vector<Offset>& inner() {
  static const std::vector<Offset> all = offsets(0.0, inner_m);
  return all;
}
const std::vector<Offset>& ring() {
  static const std::vector<Offset> all = offsets(ring_from_m, ring_to_m);
  return all;
}

/// The skin around a place: a quadric through its ring, without what does not belong to it.
struct Skin {
  Eigen::VectorXd terms = Eigen::VectorXd::Zero(6);
  double rms_m = 0.0;

  [[nodiscard]] static Eigen::VectorXd shape(double columns, double rows) {
    const double x = columns * cell_m, y = rows * cell_m;
    return (Eigen::VectorXd(6) << 1.0, x, y, x * x, y * y, x * y).finished();
  }
  [[nodiscard]] double height(double columns, double rows) const {
    return shape(columns, rows).dot(terms);
  }
  [[nodiscard]] double facing() const { return 1.0 / std::hypot(1.0, terms[1], terms[2]); }
};

/// Mean height over the skin; nothing where less than half was seen.
std::optional<double> mean_of(const HeightMap& map, int column, int row,
                              const std::vector<Offset>& cells, const Skin& skin) {
  double sum = 0.0;
  std::size_t count = 0;
  for (const Offset& by : cells) {
    const double height = map.at(column + by.column, row + by.row);
    if (std::isnan(height)) continue;
    sum += height - skin.height(by.column, by.row);
    ++count;
  }
  if (2 * count < cells.size()) return std::nullopt;
  return sum / static_cast<double>(count);
}

/// Mean height of cells of which the opposite one was seen as well, so that a slope has no part in
/// it; nothing where they are too few.
std::optional<double> level_of(const HeightMap& map, int column, int row,
                               const std::vector<Offset>& cells, double min_share) {
  double sum = 0.0;
  std::size_t count = 0;
  for (const Offset& by : cells) {
    const double pair =
        map.at(column + by.column, row + by.row) + map.at(column - by.column, row - by.row);
    if (std::isnan(pair)) continue;
    sum += 0.5 * pair;
    ++count;
  }
  if (static_cast<double>(count) < min_share * static_cast<double>(cells.size()))
    return std::nullopt;
  return sum / static_cast<double>(count);
}

/// How much the middle of each cell's surroundings stands out of its ring; the lowest where too
/// little was seen.
std::vector<double> responses(const HeightMap& map) {
  constexpr double min_inner = 0.4, min_ring = 0.25;
  std::vector<double> found;
  found.reserve(static_cast<std::size_t>(map.columns()) * static_cast<std::size_t>(map.rows()));
  for (int row = 0; row < map.rows(); ++row) {
    for (int column = 0; column < map.columns(); ++column) {
      const auto middle = level_of(map, column, row, inner(), min_inner);
      const auto around =
          middle ? level_of(map, column, row, ring(), min_ring) : std::optional<double>();
      found.push_back(around ? *middle - *around : std::numeric_limits<double>::lowest());
    }
  }
  return found;
}

Skin skin_around(const HeightMap& map, int column, int row) {
  Skin skin;
  double within_m = std::numeric_limits<double>::max();
  for (int round = 0; round < 2; ++round) {
    Eigen::MatrixXd sums = 1e-15 * Eigen::MatrixXd::Identity(6, 6);
    Eigen::VectorXd moments = Eigen::VectorXd::Zero(6);
    std::vector<const Offset*> used;
    for (const Offset& by : ring()) {
      const double height = map.at(column + by.column, row + by.row);
      if (std::isnan(height)) continue;
      if (round > 0 && std::abs(height - skin.height(by.column, by.row)) > within_m) continue;
      const auto shape = Skin::shape(by.column, by.row);
      sums += shape * shape.transpose();
      moments += height * shape;
      used.push_back(&by);
    }
    skin.terms = solve_symmetric(sums, moments);
    double squares = 0.0;
    for (const Offset* by : used)
      squares += std::pow(
          map.at(column + by->column, row + by->row) - skin.height(by->column, by->row), 2);
    skin.rms_m = std::sqrt(squares / static_cast<double>(std::max<std::size_t>(1, used.size())));
    within_m = 2.5 * skin.rms_m;
  }
  return skin;
}

/// The cells that are connected with the middle and higher than half of the highest there.
struct Top {
  double width_m = 0.0, lengthwise = 1.0;
  double column = 0.0, row = 0.0;  ///< its middle, in cells from the place
};

std::optional<Top> top_of(const HeightMap& map, int column, int row, const Skin& skin) {
  constexpr int side = 2 * reach + 1;
  std::array<double, side * side> above{};
  const auto number = [](int x, int y) {
    return static_cast<std::size_t>(y + reach) * side + static_cast<std::size_t>(x + reach);
  };
  double most = 0.0;
  std::array<int, 2> start{};
  for (const Offset& by : offsets(0.0, 18_mm)) {
    const double height = map.at(column + by.column, row + by.row);
    if (std::isnan(height)) continue;
    const double rise = height - skin.height(by.column, by.row);
    above[number(by.column, by.row)] = rise;
    if (by.radius_m > inner_m || rise <= most) continue;
    most = rise;
    start = {by.column, by.row};
  }
  if (most <= 0.0) return std::nullopt;
  std::vector<std::array<int, 2>> cells = {start};
  above[number(start[0], start[1])] = 0.0;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    for (const auto& [dx, dy] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
      const int x = cells[i][0] + dx, y = cells[i][1] + dy;
      if (std::abs(x) > reach || std::abs(y) > reach || above[number(x, y)] <= 0.5 * most) continue;
      above[number(x, y)] = 0.0;
      cells.push_back({x, y});
    }
  }
  const auto count = static_cast<double>(cells.size());
  Vector2 middle = Vector2::Zero();
  for (const auto& cell : cells) middle += Vector2(cell[0], cell[1]) / count;
  Eigen::Matrix2d spread = Eigen::Matrix2d::Identity() / 12.0;  // that of one cell
  for (const auto& cell : cells) {
    const Vector2 off = Vector2(cell[0], cell[1]) - middle;
    spread += off * off.transpose() / count;
  }
  const double half = 0.5 * spread.trace();
  const double apart = std::sqrt(std::max(0.0, half * half - spread.determinant()));
  return Top{.width_m = 2.0 * cell_m * std::sqrt(count / skin.facing() / pi),
             .lengthwise = std::sqrt((half + apart) / std::max(1e-9, half - apart)),
             .column = middle.x(),
             .row = middle.y()};
}

std::optional<Bump> bump_at(const HeightMap& map, int column, int row) {
  const Skin skin = skin_around(map, column, row);
  const auto mean_above = [&](const std::vector<Offset>& cells) {
    return mean_of(map, column, row, cells, skin).value_or(0.0);
  };
  static const std::vector<Offset> beside = offsets(10_mm, 14_mm);
  const double above = mean_above(inner());
  const double height_m = above * skin.facing();
  if (height_m < min_height_m || above < min_above_noise * skin.rms_m ||
      std::abs(mean_above(beside)) > max_side_share * above || skin.facing() < min_facing)
    return std::nullopt;
  const auto top = top_of(map, column, row, skin);
  if (!top || top->width_m < min_width_m || top->width_m > max_width_m ||
      top->lengthwise > max_lengthwise)
    return std::nullopt;
  const double skin_m = skin.height(top->column, top->row);
  return Bump{.at_in_couch = map.place(column + top->column, row + top->row, skin_m),
              .height_m = height_m,
              .width_m = top->width_m};
}

}  // namespace

Result<std::vector<Bump>> find_bumps(const PointCloud& scan_in_couch, const BackSurface& back) {
  const HeightMap map(scan_in_couch, back);
  if (map.spacing_m() > max_spacing_m)
    return fail(Fault::bad_input,
                "the points of the scan lie {:.1f} mm apart, {:.1f} at most to see a marker's "
                "shape",
                to_mm(map.spacing_m()), to_mm(max_spacing_m));
  const std::vector<double> response = responses(map);
  const auto of = [&](int column, int row) {
    if (column < 0 || row < 0 || column >= map.columns() || row >= map.rows())
      return std::numeric_limits<double>::lowest();
    return response[static_cast<std::size_t>(row) * static_cast<std::size_t>(map.columns()) +
                    static_cast<std::size_t>(column)];
  };
  constexpr int apart = 4;  // cells in which a bump is the highest
  std::vector<Bump> bumps;
  for (int row = 0; row < map.rows(); ++row) {
    for (int column = 0; column < map.columns(); ++column) {
      const double here = of(column, row);
      if (here < min_response_m) continue;
      bool highest = true;
      for (int y = -apart; y <= apart && highest; ++y) {
        for (int x = -apart; x <= apart && highest; ++x) highest = of(column + x, row + y) <= here;
      }
      if (!highest) continue;
      if (const auto bump = bump_at(map, column, row)) bumps.push_back(*bump);
    }
  }
  return bumps;
}

PointCloud without_bumps(const PointCloud& scan_in_couch, const std::vector<Bump>& bumps,
                         const BackSurface& back) {
  constexpr double foot_m = 3_mm, max_off_m = 30_mm;
  PointCloud bare;
  for (const Vector3& point : scan_in_couch.points) {
    const bool on_one = std::any_of(bumps.begin(), bumps.end(), [&](const Bump& bump) {
      const Vector3 off = point - bump.at_in_couch;
      if (off.norm() > max_off_m) return false;
      const Vector3 out = back.nearest(bump.at_in_couch).normal_in_couch;
      return (off - off.dot(out) * out).norm() < 0.5 * bump.width_m + foot_m;
    });
    if (!on_one) bare.points.push_back(point);
  }
  return bare;
}

}  // namespace tuina::body
