// SPDX-License-Identifier: Apache-2.0
#include "tuina/body/outline_look.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "tuina/body/silhouette.hpp"
#include "tuina/core/units.hpp"

namespace tuina::body {
namespace {

constexpr double cell_m = Silhouette::cell_m;
constexpr double shoulders_begin_m =
    0.27;                                // wider than any head, narrower than any pair of shoulders
constexpr double neck_spread_m = 60_mm;  // the neck ends where the outline is this much wider
constexpr double min_neck_m = 85_mm;
// Height of the sacrum above the seat as a share of the trunk's width: wide people sit on more
// flesh.
constexpr double sacrum_per_width = 0.55;
constexpr double max_half_shoulder_m = 0.30;  // farther out the contour is a raised arm

/// Corner of the shoulder: the contour point farthest up and out.
Vector2 shoulder_corner(const std::vector<Vector2>& contour, double side) {
  double farthest = -1e9;
  const auto out = [&](const Vector2& p) { return side * p.x() + p.y(); };
  for (const Vector2& p : contour) farthest = std::max(farthest, out(p));
  Vector2 sum = Vector2::Zero();
  double weight = 0.0;
  for (const Vector2& p : contour) {
    const double w = std::max(0.0, 1.0 - (farthest - out(p)) / 12_mm);
    sum += w * p;
    weight += w;
  }
  return sum / weight;
}

/// The highest part of the back between waist and thighs, as height on the midline.
double buttocks(const std::vector<Vector3>& in_back, double middle, double neck_height) {
  constexpr double bin = 10_mm;
  std::vector<double> sum(100, 0.0);
  std::vector<double> count(100, 0.0);
  for (const Vector3& p : in_back) {
    const double down = neck_height - p.z();
    if (std::abs(p.x() - middle) > 90_mm || down < 0.0 || down >= 1.0) continue;
    const double at = down / bin - 0.5;
    const int i = static_cast<int>(std::floor(at));
    for (int k = 0; k < 2; ++k) {
      const int j = i + k;
      if (j < 0 || j > 99) continue;
      const double w = 1.0 - std::abs(at - j);
      sum[static_cast<std::size_t>(j)] += w * p.y();
      count[static_cast<std::size_t>(j)] += w;
    }
  }
  double best = -1e9;
  for (std::size_t i = 38; i < 75; ++i) {
    if (count[i] > 3.0) best = std::max(best, sum[i] / count[i]);
  }
  double mean = 0.0;
  double weight = 0.0;
  for (std::size_t i = 38; i < 75; ++i) {
    if (count[i] <= 3.0) continue;
    const double w = std::max(0.0, 1.0 - (best - sum[i] / count[i]) / 8_mm);
    mean += w * (static_cast<double>(i) + 0.5) * bin;
    weight += w;
  }
  return weight > 0.0 ? neck_height - mean / weight : neck_height - 0.55;
}

}  // namespace

Result<Look> look(const std::vector<Vector3>& in_back, double spacing_m,
                  const Vector3& couch_up_in_back, double couch_height_of_origin,
                  Position position) {
  const Silhouette silhouette(in_back, spacing_m);
  // The trunk is entered a third up and followed towards the head.
  const int start = silhouette.rows() / 3;
  double middle = 0.0;
  for (const Vector3& p : in_back) middle += p.x() / static_cast<double>(in_back.size());
  std::vector<std::optional<Run>> runs(static_cast<std::size_t>(silhouette.rows()));
  double x = middle;
  for (int row = start; row < silhouette.rows(); ++row) {
    auto found = silhouette.run(row, x);
    if (!found) break;
    runs[static_cast<std::size_t>(row)] = found;
    if (found->width() < 0.5) x += 0.2 * (found->middle() - x);
  }
  x = runs[static_cast<std::size_t>(start)] ? runs[static_cast<std::size_t>(start)]->middle()
                                            : middle;
  for (int row = start - 1; row >= 0; --row) {
    auto found = silhouette.run(row, x);
    if (!found) break;
    runs[static_cast<std::size_t>(row)] = found;
    if (found->width() < 0.5) x += 0.2 * (found->middle() - x);
  }

  int top = silhouette.rows() - 1;
  while (top > 0 && !runs[static_cast<std::size_t>(top)]) --top;
  int wide = top;
  const auto width = [&](int row) {
    const auto& run = runs[static_cast<std::size_t>(row)];
    return run ? run->width() : 0.0;
  };
  while (wide > start && width(wide) < shoulders_begin_m) --wide;
  if (wide <= start) {
    return fail(Fault::not_found,
                "no shoulders found: the outline is nowhere {:.0f} mm wide in its upper two thirds",
                to_mm(shoulders_begin_m));
  }
  if (silhouette.height(top) - silhouette.height(wide) < 50_mm) {
    return fail(Fault::not_found,
                "no neck found: {:.0f} mm of the scan are above the shoulders, 50 needed",
                to_mm(silhouette.height(top) - silhouette.height(wide)));
  }
  Look seen;
  seen.head = silhouette.height(top) - silhouette.height(wide);
  // Where the scan lost the sides of head or neck, rows narrower than a neck are ignored.
  double narrowest = 1.0;
  for (int row = wide; row <= std::min(top, wide + 32); ++row)
    narrowest = std::min(narrowest, std::max(width(row), min_neck_m));
  int base = wide;
  while (base < top && width(base) > narrowest + neck_spread_m) ++base;
  const auto& neck = *runs[static_cast<std::size_t>(base)];
  // Linear interpolation between the rows.
  const double over = std::clamp(
      (narrowest + neck_spread_m - width(base)) / std::max(1e-6, width(base - 1) - width(base)),
      0.0, 1.0);
  const double neck_height = silhouette.height(base) - over * cell_m;
  seen.neck = {Vector2(neck.high, neck_height), Vector2(neck.low, neck_height)};

  // The narrowest trunk, which no arm can hide. The lowest rows are the ragged rim of the scan.
  const int loins = silhouette.row_of(std::max(silhouette.height(0) + 40_mm, neck_height - 0.50));
  double slim = 1.0;
  for (int row = loins; row <= silhouette.row_of(neck_height - 0.27); ++row) {
    if (width(row) > 0.15) slim = std::min(slim, width(row));
  }

  // The lower end of the midline.
  double middle_of_neck = neck.middle();
  const int under = silhouette.row_of(neck_height - 0.38);
  const double lower_middle = runs[static_cast<std::size_t>(under)]
                                  ? runs[static_cast<std::size_t>(under)]->middle()
                                  : middle_of_neck;
  if (position == Position::sitting) {
    // Down the plane of the back to the reference height above the seat.
    seen.bottom = (std::clamp(sacrum_per_width * slim, 0.09, 0.25) - couch_height_of_origin) /
                  couch_up_in_back.z();
  } else {
    seen.bottom = buttocks(in_back, lower_middle, neck_height);
  }
  const double length = neck_height - seen.bottom;
  if (length < 0.35 || silhouette.height(0) > neck_height - 0.36) {
    return fail(Fault::not_found, "less than a back: {:.0f} mm of trunk below the neck, 360 needed",
                to_mm(std::min(length, neck_height - silhouette.height(0))));
  }

  // Middle of the lower trunk, from narrow rows, where no arm touches it.
  const int lowest = std::min(loins, silhouette.row_of(neck_height - 0.95 * length));
  const int highest_row = silhouette.row_of(neck_height - 0.27);
  Vector2 sum = Vector2::Zero();
  double weight = 0.0;
  for (int row = lowest; row <= highest_row; ++row) {
    const auto& run = runs[static_cast<std::size_t>(row)];
    if (!run || run->width() <= 0.15) continue;
    const double w = std::max(0.0, 1.0 - (run->width() / slim - 1.0) / 0.25);
    sum += w * Vector2(run->middle(), silhouette.height(row));
    weight += w;
  }
  if (weight <= 0.0)
    return fail(Fault::not_found, "less than a back: no trunk {:.0f} mm below the neck",
                680.0 * length);
  seen.lower_trunk = sum / weight;

  // Sides of the trunk, averaged over some rows. An arm against the trunk is cut off at the largest
  // possible width.
  const double trunk_height = neck_height - 0.68 * length;
  Run trunk;
  int count = 0;
  for (int row = silhouette.row_of(trunk_height - 25_mm);
       row <= silhouette.row_of(trunk_height + 25_mm); ++row) {
    const auto& run = runs[static_cast<std::size_t>(row)];
    if (!run) continue;
    trunk.low += std::max(run->low, seen.lower_trunk.x() - 0.62 * slim);
    trunk.high += std::min(run->high, seen.lower_trunk.x() + 0.62 * slim);
    ++count;
  }
  if (count == 0)
    return fail(Fault::not_found, "less than a back: no trunk {:.0f} mm below the neck",
                680.0 * length);
  trunk = {trunk.low / count, trunk.high / count};
  seen.trunk = {Vector2(trunk.high, trunk_height), Vector2(trunk.low, trunk_height)};

  // Shoulders: corners of the contour between the neck and 0.22 m below it.
  seen.arms = Arms::down;
  std::array<std::vector<Vector2>, 2> contour;
  for (int row = silhouette.row_of(neck_height - 0.22); row <= base; ++row) {
    const auto& run = runs[static_cast<std::size_t>(row)];
    if (!run) continue;
    contour[left].emplace_back(run->high, silhouette.height(row));
    contour[right].emplace_back(run->low, silhouette.height(row));
  }
  for (const std::size_t side : {left, right}) {
    const double sign = side == left ? 1.0 : -1.0;
    seen.shoulder[side] = shoulder_corner(contour[side], sign);
    if (sign * (seen.shoulder[side].x() - middle_of_neck) > max_half_shoulder_m) {
      seen.arms = Arms::up;
    }
  }
  if (seen.arms == Arms::up) {
    // A raised arm hides the corner; the point straight above the side of the trunk replaces it.
    for (const std::size_t side : {left, right}) {
      const double sign = side == left ? 1.0 : -1.0;
      const double at = middle_of_neck + sign * 0.5 * trunk.width();
      double highest = neck_height - 0.12;
      for (const Vector2& p : contour[side]) {
        if (sign * (p.x() - at) >= 0.0) highest = std::max(highest, p.y());
      }
      seen.shoulder[side] = {at, std::min(highest, neck_height)};
    }
  }
  return seen;
}

}  // namespace tuina::body
