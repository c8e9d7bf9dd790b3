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
// Wider than any head, narrower than any pair of shoulders.
constexpr double shoulders_begin_m = 0.27;
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

/// The person's run in each row of a silhouette, as far as it is connected.
struct Trunk {
  Silhouette silhouette;
  int start = 0;  // a third up, where it is entered
  std::vector<std::optional<Run>> runs;

  [[nodiscard]] const std::optional<Run>& run(int row) const {
    return runs[static_cast<std::size_t>(row)];
  }
  [[nodiscard]] double width(int row) const { return run(row) ? run(row)->width() : 0.0; }
};

/// Follows the trunk from a third up towards the head, then towards the feet.
Trunk follow_trunk(const std::vector<Vector3>& in_back, double spacing_m) {
  Trunk trunk{.silhouette = Silhouette(in_back, spacing_m), .runs = {}};
  const int rows = trunk.silhouette.rows();
  trunk.start = rows / 3;
  trunk.runs.resize(static_cast<std::size_t>(rows));
  double middle = 0.0;
  for (const Vector3& p : in_back) middle += p.x() / static_cast<double>(in_back.size());
  const auto follow = [&](double x, int from, int end, int step) {
    for (int row = from; row != end; row += step) {
      const auto found = trunk.silhouette.run(row, x);
      if (!found) break;
      trunk.runs[static_cast<std::size_t>(row)] = found;
      if (found->width() < 0.5) x += 0.2 * (found->middle() - x);
    }
  };
  follow(middle, trunk.start, rows, 1);
  const auto& entered = trunk.run(trunk.start);
  follow(entered ? entered->middle() : middle, trunk.start - 1, -1, -1);
  return trunk;
}

struct Neck {
  int base = 0;  // the row where it ends
  double height = 0.0;
  double head = 0.0;  // height of the scan above the shoulders
  Run run;            // of its base
};

Result<Neck> find_neck(const Trunk& trunk) {
  const Silhouette& silhouette = trunk.silhouette;
  int top = silhouette.rows() - 1;
  while (top > 0 && !trunk.run(top)) --top;
  int wide = top;
  while (wide > trunk.start && trunk.width(wide) < shoulders_begin_m) --wide;
  if (wide <= trunk.start) {
    return fail(Fault::not_found,
                "no shoulders found: the outline is nowhere {:.0f} mm wide in its upper two thirds",
                to_mm(shoulders_begin_m));
  }
  Neck neck{.head = silhouette.height(top) - silhouette.height(wide), .run = {}};
  if (neck.head < 50_mm) {
    return fail(Fault::not_found,
                "no neck found: {:.0f} mm of the scan are above the shoulders, 50 needed",
                to_mm(neck.head));
  }
  // Where the scan lost the sides of head or neck, rows narrower than a neck are ignored.
  double narrowest = 1.0;
  for (int row = wide; row <= std::min(top, wide + 32); ++row)
    narrowest = std::min(narrowest, std::max(trunk.width(row), min_neck_m));
  int& base = neck.base = wide;
  while (base < top && trunk.width(base) > narrowest + neck_spread_m) ++base;
  neck.run = *trunk.run(base);
  // Linear interpolation between the rows.
  const double over = std::clamp((narrowest + neck_spread_m - trunk.width(base)) /
                                     std::max(1e-6, trunk.width(base - 1) - trunk.width(base)),
                                 0.0, 1.0);
  neck.height = silhouette.height(base) - over * cell_m;
  return neck;
}

/// Middle of the lower trunk, from narrow rows, where no arm touches it.
std::optional<Vector2> lower_trunk(const Trunk& trunk, double neck_height, double length, int loins,
                                   double slim) {
  const int lowest = std::min(loins, trunk.silhouette.row_of(neck_height - 0.95 * length));
  const int highest = trunk.silhouette.row_of(neck_height - 0.27);
  Vector2 sum = Vector2::Zero();
  double weight = 0.0;
  for (int row = lowest; row <= highest; ++row) {
    const auto& run = trunk.run(row);
    if (!run || run->width() <= 0.15) continue;
    const double w = std::max(0.0, 1.0 - (run->width() / slim - 1.0) / 0.25);
    sum += w * Vector2(run->middle(), trunk.silhouette.height(row));
    weight += w;
  }
  if (weight <= 0.0) return std::nullopt;
  return sum / weight;
}

/// Sides of the trunk, averaged over some rows. An arm against the trunk is cut off at the largest
/// possible width.
std::optional<Run> trunk_sides(const Trunk& trunk, double height, double middle, double slim) {
  const Silhouette& silhouette = trunk.silhouette;
  Run sides;
  int count = 0;
  for (int row = silhouette.row_of(height - 25_mm); row <= silhouette.row_of(height + 25_mm);
       ++row) {
    const auto& run = trunk.run(row);
    if (!run) continue;
    sides.low += std::max(run->low, middle - 0.62 * slim);
    sides.high += std::min(run->high, middle + 0.62 * slim);
    ++count;
  }
  if (count == 0) return std::nullopt;
  return Run{sides.low / count, sides.high / count};
}

/// Shoulders: corners of the contour between the neck and 0.22 m below it.
void find_shoulders(const Trunk& trunk, const Neck& neck, double trunk_width,
                    SilhouetteFeatures& features) {
  const Silhouette& silhouette = trunk.silhouette;
  const double middle = neck.run.middle();
  features.arms = Arms::down;
  std::array<std::vector<Vector2>, 2> contour;
  for (int row = silhouette.row_of(neck.height - 0.22); row <= neck.base; ++row) {
    const auto& run = trunk.run(row);
    if (!run) continue;
    contour[left].emplace_back(run->high, silhouette.height(row));
    contour[right].emplace_back(run->low, silhouette.height(row));
  }
  for (const std::size_t side : {left, right}) {
    const double sign = side == left ? 1.0 : -1.0;
    features.shoulder[side] = shoulder_corner(contour[side], sign);
    if (sign * (features.shoulder[side].x() - middle) > max_half_shoulder_m) {
      features.arms = Arms::up;
    }
  }
  if (features.arms != Arms::up) return;
  // A raised arm hides the corner; the point straight above the side of the trunk replaces it.
  for (const std::size_t side : {left, right}) {
    const double sign = side == left ? 1.0 : -1.0;
    const double at = middle + sign * 0.5 * trunk_width;
    double highest = neck.height - 0.12;
    for (const Vector2& p : contour[side]) {
      if (sign * (p.x() - at) >= 0.0) highest = std::max(highest, p.y());
    }
    features.shoulder[side] = {at, std::min(highest, neck.height)};
  }
}

}  // namespace

Result<SilhouetteFeatures> find_features(const std::vector<Vector3>& in_back, double spacing_m,
                                         const Vector3& couch_up_in_back,
                                         double couch_height_of_origin, BodyPosture position) {
  const Trunk trunk = follow_trunk(in_back, spacing_m);
  const Silhouette& silhouette = trunk.silhouette;
  const auto neck = find_neck(trunk);
  if (!neck) return tl::unexpected(neck.error());
  SilhouetteFeatures features;
  features.head = neck->head;
  features.neck = {Vector2(neck->run.high, neck->height), Vector2(neck->run.low, neck->height)};

  // The narrowest trunk, which no arm can hide. The lowest rows are the ragged rim of the scan.
  const int loins = silhouette.row_of(std::max(silhouette.height(0) + 40_mm, neck->height - 0.50));
  double slim = 1.0;
  for (int row = loins; row <= silhouette.row_of(neck->height - 0.27); ++row) {
    if (trunk.width(row) > 0.15) slim = std::min(slim, trunk.width(row));
  }

  // The lower end of the midline.
  const auto& under = trunk.run(silhouette.row_of(neck->height - 0.38));
  const double lower_middle = under ? under->middle() : neck->run.middle();
  if (position == BodyPosture::sitting) {
    // Down the plane of the back to the reference height above the seat.
    features.bottom = (std::clamp(sacrum_per_width * slim, 0.09, 0.25) - couch_height_of_origin) /
                      couch_up_in_back.z();
  } else {
    features.bottom = buttocks(in_back, lower_middle, neck->height);
  }
  const double length = neck->height - features.bottom;
  if (length < 0.35 || silhouette.height(0) > neck->height - 0.36) {
    return fail(Fault::not_found, "less than a back: {:.0f} mm of trunk below the neck, 360 needed",
                to_mm(std::min(length, neck->height - silhouette.height(0))));
  }

  const double trunk_height = neck->height - 0.68 * length;
  const auto lower = lower_trunk(trunk, neck->height, length, loins, slim);
  const auto sides = lower ? trunk_sides(trunk, trunk_height, lower->x(), slim) : std::nullopt;
  if (!sides) {
    return fail(Fault::not_found, "less than a back: no trunk {:.0f} mm below the neck",
                680.0 * length);
  }
  features.lower_trunk = *lower;
  features.trunk = {Vector2(sides->high, trunk_height), Vector2(sides->low, trunk_height)};
  find_shoulders(trunk, *neck, sides->width(), features);
  return features;
}

}  // namespace tuina::body
