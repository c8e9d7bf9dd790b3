// SPDX-License-Identifier: Apache-2.0
#include "tuina/body/outline.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "tuina/body/outline_look.hpp"
#include "tuina/core/decompositions.hpp"
#include "tuina/core/units.hpp"

namespace tuina::body {
namespace {

constexpr double sure_head_m = 0.15;  // thighs end nearer to the hips than a head to the shoulders
constexpr int rounds = 14;
constexpr double hollow_m = 10_mm;  // sides of a back lie some 40 mm behind its middle
constexpr double max_search_turn_rad = 60_deg;

/// Axes of an upright sitting or a straight lying person; the head may be at either end.
Matrix3 nominal(BodyPosture position, bool head_at_far_end) {
  Matrix3 back_from_couch = Matrix3::Identity();
  if (position == BodyPosture::prone) {
    back_from_couch = Eigen::AngleAxisd(-pi / 2.0, Vector3::UnitX()).toRotationMatrix();
    if (head_at_far_end) {
      back_from_couch =
          Eigen::AngleAxisd(pi, Vector3::UnitY()).toRotationMatrix() * back_from_couch;
    }
  }
  return back_from_couch;
}

/// Plane of the middle of the back, y = a + b x + c z, by robust least squares; lying, b = c = 0
/// (parallel to the bed).
Vector3 plane_of(const std::vector<Vector3>& in_back, const SilhouetteFeatures& seen,
                 bool sitting) {
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
    solution = solve_symmetric(normal, right_side);
  }
  return solution;
}

/// Refuses hollow backs: a back bulges towards the viewer unless mirrored along the line of sight.
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
    return fail(
        Fault::bad_input,
        "the back is hollow by {:.0f} mm: the cloud is mirrored along the line of sight, or "
        "turned half round",
        to_mm(hollow));
  }
  return {};
}

Result<Outline> find_outline_from(const BackSurface& back, const Matrix3& start,
                                  const std::optional<Vector3>& board_normal) {
  const std::vector<Vector3>& points = back.points().points;
  Matrix3 rotation = start;
  if (board_normal) {
    rotation = turn_between(start * *board_normal, Vector3::UnitY()) * start;
  }
  Vector3 origin = Vector3::Zero();  // in couch
  for (const Vector3& p : points) origin += p / static_cast<double>(points.size());
  std::vector<Vector3> in_back(points.size());
  Outline outline;
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t i = 0; i < points.size(); ++i) in_back[i] = rotation * (points[i] - origin);
    const auto seen = find_features(in_back, back.spacing_m(), rotation * Vector3::UnitZ(),
                                    origin.z(), back.position());
    if (!seen) return tl::unexpected(seen.error());
    const Vector2 neck = 0.5 * (seen->neck[left] + seen->neck[right]);
    const Vector2 shoulders = 0.5 * (seen->shoulder[left] + seen->shoulder[right]);
    // The thesis drops a perpendicular from the middle of the shoulder line. A raised arm bends
    // that line, so the direction comes from the trunk, and shoulders and neck together place its
    // upper end.
    const Vector2 upper = 0.5 * (neck + Vector2(shoulders.x(), neck.y()));
    const Vector2 along = (upper - seen->lower_trunk).normalized();
    const Vector3 plane = plane_of(in_back, *seen, back.position() == BodyPosture::sitting);
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

    // Next iteration: midline upright, back facing the view, origin half-way between the shoulders.
    const Vector3 up_now = Vector3(along.x(), 0.0, along.y());
    const Matrix3 upright = turn_between(up_now, Vector3::UnitZ()).toRotationMatrix();
    const Vector3 normal = Vector3(-plane.y(), 1.0, -plane.z()).normalized();
    const Matrix3 square = board_normal ? Matrix3(Matrix3::Identity())
                                        : turn_between(normal, Vector3::UnitY()).toRotationMatrix();
    const Vector3 middle(upper.x(), plane.dot(Vector3(1.0, upper.x(), neck.y())), neck.y());
    origin += rotation.transpose() * middle;
    rotation = upright * square * rotation;
    rotation = Eigen::Quaterniond(rotation).normalized().toRotationMatrix();
    if (middle.norm() < 1e-5 && (upright * square - Matrix3::Identity()).norm() < 1e-5) break;
  }
  // Seen from the feet, raised arms can look like an outline and turn the search upside down.
  const double up =
      (rotation.transpose() * Vector3::UnitZ()).dot(start.transpose() * Vector3::UnitZ());
  if (up < std::cos(max_search_turn_rad)) {
    return fail(Fault::not_found,
                "no outline of a back: the search for it turned by {:.0f} degrees",
                to_deg(std::acos(std::clamp(up, -1.0, 1.0))));
  }
  if (const auto bulge = check_bulge(points, outline); !bulge) return tl::unexpected(bulge.error());
  return outline;
}

/// Width of the top of the outline relative to its widest part: the head end is narrow.
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

Result<Outline> find_outline(const BackSurface& back, const std::optional<Vector3>& board_normal) {
  // The search starts in a frame that turns with the person, so that the heading on the couch does
  // not matter.
  const double turned_rad = heading(back.points(), back.position());
  const Matrix3 ahead = Eigen::AngleAxisd(-turned_rad, Vector3::UnitZ()).toRotationMatrix();
  const Matrix3 usual = nominal(back.position(), false) * ahead;
  if (back.position() == BodyPosture::sitting) return find_outline_from(back, usual, board_normal);
  const Matrix3 other = nominal(back.position(), true) * ahead;
  const bool usual_first = head_width(back, usual) <= head_width(back, other);
  auto first = find_outline_from(back, usual_first ? usual : other, board_normal);
  if (first && first->head_m > sure_head_m) return first;
  auto second = find_outline_from(back, usual_first ? other : usual, board_normal);
  if (!first || !second) return second ? second : first;
  return second->head_m > first->head_m ? second : first;
}

}  // namespace tuina::body
