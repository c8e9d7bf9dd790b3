// SPDX-License-Identifier: Apache-2.0
#include "tuina/body/board_plane.hpp"

#include <algorithm>
#include <cmath>

#include "tuina/core/units.hpp"

namespace tuina::body {
namespace {

constexpr std::size_t min_board_points = 100;
constexpr double around_m = 25_mm;
// Baseline on which noise of 1 mm tilts the plane by less than half a degree.
constexpr double min_m = 0.15;
constexpr double flat_m = 6_mm;

template <typename Far>
Vector3 farthest(const std::vector<Vector3>& points, const Far& far) {
  return *std::max_element(points.begin(), points.end(),
                           [&](const Vector3& a, const Vector3& b) { return far(a) < far(b); });
}

}  // namespace

Result<std::array<Vector3, 3>> three_places_of(const PointCloud& board_in_couch) {
  const auto& points = board_in_couch.points;
  if (points.size() < min_board_points) {
    return fail(Fault::bad_input, "the scan of a board has {} points, {} needed", points.size(),
                min_board_points);
  }
  Vector3 middle = Vector3::Zero();
  for (const Vector3& p : points) middle += p / static_cast<double>(points.size());
  std::array<Vector3, 3> places;
  places[0] = farthest(points, [&](const Vector3& p) { return (p - middle).norm(); });
  places[1] = farthest(points, [&](const Vector3& p) { return (p - places[0]).norm(); });
  const Vector3 along = (places[1] - places[0]).normalized();
  const auto aside = [&](const Vector3& p) { return (p - places[0]).cross(along).norm(); };
  places[2] = farthest(points, aside);
  if (aside(places[2]) < min_m) {
    return fail(Fault::bad_input,
                "the scan of a board is {:.0f} mm wide, {:.0f} needed to tell its tilt",
                to_mm(aside(places[2])), to_mm(min_m));
  }
  for (Vector3& place : places) {
    Vector3 sum = Vector3::Zero();
    double count = 0.0;
    for (const Vector3& p : points) {
      if ((p - place).norm() > around_m) continue;
      sum += p;
      count += 1.0;
    }
    place = sum / count;
  }
  const Vector3 normal = plane_normal(places);
  double squares = 0.0;
  for (const Vector3& p : points) {
    squares += std::pow(normal.dot(p - places[0]), 2) / static_cast<double>(points.size());
  }
  if (std::sqrt(squares) > flat_m) {
    return fail(
        Fault::bad_input,
        "this is no flat board: its points are {:.0f} mm from one plane (RMS), {:.0f} allowed",
        to_mm(std::sqrt(squares)), to_mm(flat_m));
  }
  return places;
}

Vector3 plane_normal(const std::array<Vector3, 3>& places) {
  const Vector3 normal = (places[1] - places[0]).cross(places[2] - places[0]).normalized();
  return normal.y() + normal.z() < 0.0 ? Vector3(-normal) : normal;
}

}  // namespace tuina::body
