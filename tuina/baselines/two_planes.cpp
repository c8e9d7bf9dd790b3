// SPDX-License-Identifier: Apache-2.0
#include "tuina/baselines/two_planes.hpp"

#include <array>
#include <cassert>
#include <cmath>
#include <limits>

#include "tuina/core/decompositions.hpp"

namespace tuina::baselines {

using namespace body;
namespace {

struct Plane {
  Vector3 at = Vector3::Zero();
  Vector3 normal = Vector3::UnitY();

  [[nodiscard]] Vector3 onto(const Vector3& place) const {
    return place - normal.dot(place - at) * normal;
  }
};

Plane plane_of(const std::vector<Vector3>& points) {
  Plane plane;
  for (const Vector3& p : points) plane.at += p / static_cast<double>(points.size());
  Matrix3 scatter = Matrix3::Zero();
  for (const Vector3& p : points) scatter += (p - plane.at) * (p - plane.at).transpose();
  plane.normal = principal_axes(scatter).axes.col(0);
  return plane;
}

/// Even steps along a polyline.
std::vector<Vector3> laid_out(std::span<const Vector3> path, double step_m) {
  std::vector<Vector3> even = {path.front()};
  double left_m = step_m;
  for (std::size_t i = 1; i < path.size(); ++i) {
    Vector3 from = path[i - 1];
    double length = (path[i] - from).norm();
    while (length >= left_m && length > 0.0) {
      from += left_m / length * (path[i] - from);
      length = (path[i] - from).norm();
      even.push_back(from);
      left_m = step_m;
    }
    left_m -= length;
  }
  return even;
}

}  // namespace

std::vector<Vector3> two_plane_path(const PointCloud& scan_in_couch, const BackSurface& back,
                                    std::span<const Vector3> places_in_couch, double step_m) {
  assert(places_in_couch.size() > 1);
  const int along = back.position() == BodyPosture::sitting ? 2 : 1;
  double middle = 0.0;
  for (const Vector3& p : back.points().points) {
    middle += p[along] / static_cast<double>(back.points().size());
  }
  std::array<std::vector<Vector3>, 2> halves;
  for (const Vector3& p : back.points().points) halves[p[along] > middle ? 1U : 0U].push_back(p);
  const std::array<Plane, 2> planes = {plane_of(halves[0]), plane_of(halves[1])};
  std::vector<Vector3> path;
  for (const Vector3& on_line : laid_out(places_in_couch, step_m)) {
    const Vector3 on_plane = planes[on_line[along] > middle ? 1U : 0U].onto(on_line);
    double nearest = std::numeric_limits<double>::max();
    Vector3 found = on_plane;
    for (const Vector3& p : scan_in_couch.points) {
      const double far = (p - on_plane).squaredNorm();
      if (far < nearest) {
        nearest = far;
        found = p;
      }
    }
    path.push_back(found);
  }
  return path;
}

double mean_square_jerk(std::span<const Vector3> path, double speed_m_per_s, double every_s) {
  assert(path.size() > 1);
  const auto even = laid_out(path, speed_m_per_s * every_s);
  double sum = 0.0;
  double count = 0.0;
  for (std::size_t i = 3; i < even.size(); ++i) {
    const Vector3 third = even[i] - 3.0 * even[i - 1] + 3.0 * even[i - 2] - even[i - 3];
    sum += (third / (every_s * every_s * every_s)).squaredNorm();
    count += 1.0;
  }
  return count > 0.0 ? sum / count : 0.0;
}

}  // namespace tuina::baselines
