// SPDX-License-Identifier: Apache-2.0
#include "tuina/body/outline.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "tuina/core/units.hpp"

namespace tuina::body {
namespace {

constexpr double cell_m = 5_mm;
constexpr double bridge_m = 16_mm;  // gaps of a sweep that are no gaps of the person
constexpr double shoulders_begin_m =
    0.27;  // wider than any head, narrower than any pair of shoulders
constexpr double neck_spread_m =
    60_mm;  // the neck ends where the outline is this much wider than it
constexpr double narrowest_neck_m = 85_mm;
// The sacrum's height above the seat is this share of the trunk's width: more flesh lies under a
// wide one.
constexpr double sacrum_per_width = 0.55;
constexpr double widest_half_shoulder_m = 0.30;  // beyond it the contour is a raised arm
constexpr double sure_head_m = 0.15;  // thighs end nearer to the hips than a head to the shoulders
constexpr int rounds = 14;
constexpr double hollow_m = 10_mm;  // sides of a back lie some 40 mm behind its middle
constexpr double most_search_turn_rad = 60_deg;

struct Run {
  double low = 0.0;
  double high = 0.0;
  [[nodiscard]] double width() const { return high - low; }
  [[nodiscard]] double middle() const { return 0.5 * (low + high); }
};

/// The silhouette in rows of cells; row 0 is the lowest.
class Silhouette {
 public:
  Silhouette(const std::vector<Vector3>& in_back, double spacing_m) {
    low_ = high_ = in_back.front();
    for (const Vector3& p : in_back) {
      low_ = low_.cwiseMin(p);
      high_ = high_.cwiseMax(p);
    }
    const double reach = 1.1 * std::max(spacing_m, 6_mm);
    low_ -= Vector3::Constant(reach + cell_m);
    high_ += Vector3::Constant(reach + cell_m);
    columns_ = static_cast<int>((high_.x() - low_.x()) / cell_m) + 1;
    rows_ = static_cast<int>((high_.z() - low_.z()) / cell_m) + 1;
    filled_.assign(static_cast<std::size_t>(columns_ * rows_), false);
    const int span = static_cast<int>(std::ceil(reach / cell_m));
    for (const Vector3& p : in_back) {
      const double u = (p.x() - low_.x()) / cell_m;
      const double h = (p.z() - low_.z()) / cell_m;
      for (int row = static_cast<int>(h) - span; row <= static_cast<int>(h) + span; ++row) {
        for (int column = static_cast<int>(u) - span; column <= static_cast<int>(u) + span;
             ++column) {
          const double far = std::hypot(column + 0.5 - u, row + 0.5 - h) * cell_m;
          if (far < reach && row >= 0 && row < rows_ && column >= 0 && column < columns_) {
            filled_[static_cast<std::size_t>(row * columns_ + column)] = true;
          }
        }
      }
    }
  }

  [[nodiscard]] int rows() const { return rows_; }
  [[nodiscard]] double height(int row) const { return low_.z() + (row + 0.5) * cell_m; }
  [[nodiscard]] int row_of(double height) const {
    return std::clamp(static_cast<int>((height - low_.z()) / cell_m), 0, rows_ - 1);
  }

  /// The stretch of a row that holds `x`, or the nearest one to it.
  [[nodiscard]] std::optional<Run> run(int row, double x) const {
    std::optional<Run> best;
    double nearest = 0.08;
    for (int column = 0; column < columns_;) {
      if (!at(row, column)) {
        ++column;
        continue;
      }
      int end = column + 1;
      int gap = 0;
      for (int next = end; next < columns_ && gap * cell_m < bridge_m; ++next) {
        gap = at(row, next) ? 0 : gap + 1;
        if (gap == 0) end = next + 1;
      }
      const Run found{low_.x() + column * cell_m, low_.x() + end * cell_m};
      const double distance = std::max({0.0, found.low - x, x - found.high});
      if (distance < nearest) {
        nearest = distance;
        best = found;
      }
      column = end;
    }
    return best;
  }

 private:
  [[nodiscard]] bool at(int row, int column) const {
    return filled_[static_cast<std::size_t>(row * columns_ + column)];
  }
  Vector3 low_;
  Vector3 high_;
  int columns_ = 0;
  int rows_ = 0;
  std::vector<bool> filled_;
};

/// The person's axes of an upright sitting or a straight lying person; the head may be at either
/// end.
Matrix3 nominal(Position position, bool head_at_far_end) {
  Matrix3 back_from_couch = Matrix3::Identity();
  if (position == Position::prone) {
    back_from_couch = Eigen::AngleAxisd(-pi / 2.0, Vector3::UnitX()).toRotationMatrix();
    if (head_at_far_end) {
      back_from_couch =
          Eigen::AngleAxisd(pi, Vector3::UnitY()).toRotationMatrix() * back_from_couch;
    }
  }
  return back_from_couch;
}

/// What one look at the silhouette gives, in the coordinates of that look.
struct Look {
  Sides neck;
  Sides shoulder;
  Vector2 lower_trunk;
  Sides trunk;
  double bottom = 0.0;  ///< height of the lower end of the midline
  double head = 0.0;    ///< what lies above the shoulders
  Arms arms = Arms::unknown;
};

/// The corner of the shoulder: the cap of the contour that lies farthest up and out.
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
  // Where the laser lost the sides of head or neck, no row is taken for narrower than a neck.
  double narrowest = 1.0;
  for (int row = wide; row <= std::min(top, wide + 32); ++row)
    narrowest = std::min(narrowest, std::max(width(row), narrowest_neck_m));
  int base = wide;
  while (base < top && width(base) > narrowest + neck_spread_m) ++base;
  const auto& neck = *runs[static_cast<std::size_t>(base)];
  // Between the rows the crossing is linear.
  const double over = std::clamp(
      (narrowest + neck_spread_m - width(base)) / std::max(1e-6, width(base - 1) - width(base)),
      0.0, 1.0);
  const double neck_height = silhouette.height(base) - over * cell_m;
  seen.neck = {Vector2(neck.high, neck_height), Vector2(neck.low, neck_height)};

  // The trunk where it is narrowest, which no arm can hide. The lowest rows are the ragged rim of
  // the scan.
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
    // Down the plane of the back until the height above the seat is the reference.
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

  // The middle of the lower trunk, from the rows where no arm lies against it: those are narrow.
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

  // The sides of the trunk, mean over some rows so that single cells do not matter. An arm against
  // the trunk is cut off where the trunk cannot be any wider.
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

  // The shoulders: corners of the contour between the neck and a hand below it.
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
    if (sign * (seen.shoulder[side].x() - middle_of_neck) > widest_half_shoulder_m) {
      seen.arms = Arms::up;
    }
  }
  if (seen.arms == Arms::up) {
    // A raised arm hides the corner; straight above the side of the trunk is the place that is
    // left.
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

/// The plane of the back's middle, y = a + b x + c z, by robust least squares; a lying back is
/// given the bed's direction, b = c = 0.
Vector3 plane_of(const std::vector<Vector3>& in_back, const Look& seen, bool sitting) {
  const double half_width = 0.28 * (seen.shoulder[left].x() - seen.shoulder[right].x());
  const Vector2 upper = 0.5 * (seen.neck[left] + seen.neck[right]);
  Vector3 solution = Vector3::Zero();
  for (int round = 0; round < 4; ++round) {
    Matrix3 normal = 1e-9 * Matrix3::Identity();
    Vector3 right_side = Vector3::Zero();
    for (const Vector3& p : in_back) {
      const double share = (p.z() - seen.bottom) / (upper.y() - seen.bottom);
      if (share < 0.15 || share > 0.92) continue;
      const double middle = seen.lower_trunk.x() + (upper.x() - seen.lower_trunk.x()) *
                                                       (p.z() - seen.lower_trunk.y()) /
                                                       (upper.y() - seen.lower_trunk.y());
      const double aside = std::abs(p.x() - middle) / half_width;
      if (aside > 1.0) continue;
      const Vector3 row(1.0, sitting ? p.x() : 0.0, sitting ? p.z() : 0.0);
      const double residual = p.y() - row.dot(solution);
      const double w =
          (1.0 - aside * aside) * (round == 0 ? 1.0 : 1.0 / (1.0 + std::pow(residual / 20_mm, 2)));
      normal += w * row * row.transpose();
      right_side += w * p.y() * row;
    }
    solution = normal.ldlt().solve(right_side);
  }
  return solution;
}

/// A back bulges towards the one who looks at it. One that is mirrored along the line of sight is
/// hollow.
Result<void> check_bulge(const std::vector<Vector3>& points, const Outline& outline) {
  const double half_width = 0.5 * (outline.trunk[left].x() - outline.trunk[right].x());
  double middle = 0.0;
  double sides = 0.0;
  double middle_count = 0.0;
  double sides_count = 0.0;
  for (const Vector3& p : points) {
    const Vector3 q = outline.back_from_couch * p;
    const double share = (q.z() - outline.bottom.y()) / (outline.top.y() - outline.bottom.y());
    const double aside = std::abs(q.x() - outline.bottom.x()) / half_width;
    if (share < 0.2 || share > 0.8 || aside > 0.95) continue;
    (aside < 0.3 ? middle : sides) += aside < 0.3 || aside > 0.75 ? q.y() : 0.0;
    (aside < 0.3 ? middle_count : sides_count) += aside < 0.3 || aside > 0.75 ? 1.0 : 0.0;
  }
  if (middle_count < 20.0 || sides_count < 20.0) {
    return fail(
        Fault::not_found,
        "less than a back: {:.0f} points in the middle of it, {:.0f} at its sides, 20 needed",
        middle_count, sides_count);
  }
  const double hollow = sides / sides_count - middle / middle_count;
  if (hollow > hollow_m) {
    return fail(Fault::bad_input,
                "the back is hollow by {:.0f} mm: the cloud is mirrored along the line of sight",
                to_mm(hollow));
  }
  return {};
}

Result<Outline> find_outline_from(const BackSurface& back, const Matrix3& start) {
  const std::vector<Vector3>& points = back.points().points;
  Matrix3 rotation = start;
  Vector3 origin = Vector3::Zero();  // in couch
  for (const Vector3& p : points) origin += p / static_cast<double>(points.size());
  std::vector<Vector3> in_back(points.size());
  Outline outline;
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t i = 0; i < points.size(); ++i) in_back[i] = rotation * (points[i] - origin);
    const auto seen =
        look(in_back, back.spacing_m(), rotation * Vector3::UnitZ(), origin.z(), back.position());
    if (!seen) return tl::unexpected(seen.error());
    const Vector2 neck = 0.5 * (seen->neck[left] + seen->neck[right]);
    const Vector2 shoulders = 0.5 * (seen->shoulder[left] + seen->shoulder[right]);
    // The thesis drops a perpendicular from the middle of the shoulder line. One raised arm bends
    // that line, so the direction comes from the trunk, and the shoulders and the neck share in
    // placing its upper end.
    const Vector2 upper = 0.5 * (neck + Vector2(shoulders.x(), neck.y()));
    const Vector2 along = (upper - seen->lower_trunk).normalized();
    const Vector3 plane = plane_of(in_back, *seen, back.position() == Position::sitting);
    outline = {.back_from_couch = Transform::Identity(),
               .neck = seen->neck,
               .shoulder = seen->shoulder,
               .trunk = seen->trunk,
               .top = shoulders,
               .bottom = Vector2(seen->lower_trunk.x() +
                                     along.x() / along.y() * (seen->bottom - seen->lower_trunk.y()),
                                 seen->bottom),
               .arms = seen->arms,
               .head_m = seen->head};
    outline.back_from_couch.linear() = rotation;
    outline.back_from_couch.translation() = -rotation * origin;

    // The next look: midline upright, back square to the view, origin half-way between the
    // shoulders.
    const Vector3 up_now = Vector3(along.x(), 0.0, along.y());
    const Matrix3 upright =
        Eigen::Quaterniond::FromTwoVectors(up_now, Vector3::UnitZ()).toRotationMatrix();
    const Vector3 normal = Vector3(-plane.y(), 1.0, -plane.z()).normalized();
    const Matrix3 square =
        Eigen::Quaterniond::FromTwoVectors(normal, Vector3::UnitY()).toRotationMatrix();
    const Vector3 middle(upper.x(), plane.dot(Vector3(1.0, upper.x(), neck.y())), neck.y());
    origin += rotation.transpose() * middle;
    rotation = upright * square * rotation;
    rotation = Eigen::Quaterniond(rotation).normalized().toRotationMatrix();
    if (middle.norm() < 1e-5 && (upright * square - Matrix3::Identity()).norm() < 1e-5) break;
  }
  // Looked at from the feet, the outline of raised arms can pass for one and turn the search round.
  const double up =
      (rotation.transpose() * Vector3::UnitZ()).dot(start.transpose() * Vector3::UnitZ());
  if (up < std::cos(most_search_turn_rad)) {
    return fail(Fault::not_found,
                "no outline of a back: the search for it turned by {:.0f} degrees",
                to_deg(std::acos(std::clamp(up, -1.0, 1.0))));
  }
  if (const auto bulge = check_bulge(points, outline); !bulge) return tl::unexpected(bulge.error());
  return outline;
}

/// How narrow the uppermost hand of the outline is against the widest part: the head end is narrow.
double head_width(const BackSurface& back, const Matrix3& rotation) {
  double highest = -1e9;
  double centre = 0.0;
  const auto& points = back.points().points;
  for (const Vector3& p : points) {
    highest = std::max(highest, (rotation * p).z());
    centre += (rotation * p).x() / static_cast<double>(points.size());
  }
  double width = 0.0;
  for (const Vector3& p : points) {
    const Vector3 q = rotation * p;
    if (q.z() > highest - 0.12)
      width += std::min(std::abs(q.x() - centre), 0.3) * back.spacing_m() * back.spacing_m();
  }
  return width;
}

}  // namespace

Result<Outline> find_outline(const BackSurface& back) {
  // The search begins in a frame that turns with the person, so that where on the couch the person
  // is carries no information.
  const double turned_rad = heading(back.points(), back.position());
  const Matrix3 ahead = Eigen::AngleAxisd(-turned_rad, Vector3::UnitZ()).toRotationMatrix();
  const Matrix3 usual = nominal(back.position(), false) * ahead;
  if (back.position() == Position::sitting) return find_outline_from(back, usual);
  const Matrix3 other = nominal(back.position(), true) * ahead;
  const bool usual_first = head_width(back, usual) <= head_width(back, other);
  auto first = find_outline_from(back, usual_first ? usual : other);
  if (first && first->head_m > sure_head_m) return first;
  auto second = find_outline_from(back, usual_first ? other : usual);
  if (!first || !second) return second ? second : first;
  return second->head_m > first->head_m ? second : first;
}

}  // namespace tuina::body
