// SPDX-License-Identifier: Apache-2.0
#include "tuina/body/back_surface.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <nanoflann.hpp>
#include <vector>

#include "tuina/core/units.hpp"

namespace tuina::body {
namespace {

/// nanoflann reads the cloud in place.
struct Adaptor {
  const std::vector<Vector3>* points = nullptr;
  [[nodiscard]] std::size_t kdtree_get_point_count() const { return points->size(); }
  [[nodiscard]] double kdtree_get_pt(std::size_t i, std::size_t axis) const {
    return (*points)[i][static_cast<Eigen::Index>(axis)];
  }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

using KdTree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Adaptor>,
                                                   Adaptor, 3, std::uint32_t>;

constexpr double smoothing_m = 24_mm;  // radius of a neighbourhood; weights halve at 11 mm
constexpr double reach_m = 3.0;

}  // namespace

struct BackSurface::Tree {
  PointCloud cloud;
  BodyPosture position;
  double spacing_m;
  Adaptor adaptor;
  KdTree index;

  Tree(PointCloud cloud_in_couch, BodyPosture how, double spacing)
      : cloud(std::move(cloud_in_couch)),
        position(how),
        spacing_m(spacing),
        adaptor{&cloud.points},
        index(3, adaptor, nanoflann::KDTreeSingleIndexAdaptorParams(16)) {}

  [[nodiscard]] std::pair<std::size_t, double> closest(const Vector3& place) const {
    std::uint32_t found = 0;
    double squared = 0.0;
    index.knnSearch(place.data(), 1, &found, &squared);
    return {found, std::sqrt(squared)};
  }

  /// Moving least squares: the weighted plane through the neighbours of `centre`, oriented by their
  /// mean normal.
  [[nodiscard]] SurfacePoint plane_at(const Vector3& centre) const {
    const double radius = std::max(smoothing_m, 2.5 * spacing_m);
    std::vector<std::pair<std::uint32_t, double>> near;
    index.radiusSearch(centre.data(), radius * radius, near,
                       nanoflann::SearchParams(32, 0.f, false));
    double total = 0.0;
    Vector3 mean = Vector3::Zero();
    Vector3 side = Vector3::Zero();
    for (const auto& [i, squared] : near) {
      const double w = std::exp(-3.0 * squared / (radius * radius));
      total += w;
      mean += w * cloud.points[i];
      side += w * cloud.normals[i];
    }
    if (near.empty() || side.norm() < 1e-9) {
      const std::size_t i = closest(centre).first;
      return {cloud.points[i], cloud.normals[i], 0.0};
    }
    mean /= total;
    if (near.size() < 6) return {mean, side.normalized(), 0.0};
    Matrix3 scatter = Matrix3::Zero();
    for (const auto& [i, squared] : near) {
      const Vector3 offset = cloud.points[i] - mean;
      scatter += std::exp(-3.0 * squared / (radius * radius)) * offset * offset.transpose();
    }
    Eigen::SelfAdjointEigenSolver<Matrix3> eigen;
    eigen.computeDirect(scatter);
    Vector3 normal = eigen.eigenvectors().col(0);
    if (normal.dot(side) < 0.0) normal = -normal;
    // On a rim or a fold the fitted plane is no tangent, so the mean normal is used.
    if (normal.dot(side.normalized()) < 0.8) normal = side.normalized();
    return {mean, normal, 0.0};
  }
};

BackSurface::BackSurface(PointCloud cloud_in_couch, BodyPosture position, double spacing_m)
    : tree_(std::make_unique<Tree>(std::move(cloud_in_couch), position, spacing_m)) {
  tree_->index.buildIndex();
}
BackSurface::BackSurface(BackSurface&&) noexcept = default;
BackSurface& BackSurface::operator=(BackSurface&&) noexcept = default;
BackSurface::~BackSurface() = default;

std::size_t BackSurface::closest(const Vector3& place_in_couch) const {
  return tree_->closest(place_in_couch).first;
}
BodyPosture BackSurface::position() const {
  return tree_->position;
}
const PointCloud& BackSurface::points() const {
  return tree_->cloud;
}
double BackSurface::spacing_m() const {
  return tree_->spacing_m;
}

SurfacePoint BackSurface::nearest(const Vector3& place_in_couch) const {
  Vector3 at = tree_->cloud.points[tree_->closest(place_in_couch).first];
  SurfacePoint plane;
  // Two steps: project onto the plane at the nearest point, then onto the plane at that foot.
  for (int step = 0; step < 2; ++step) {
    plane = tree_->plane_at(at);
    const Vector3 from = step == 0 ? place_in_couch : at;
    const Vector3 foot =
        from - plane.normal_in_couch.dot(from - plane.at_in_couch) * plane.normal_in_couch;
    // Far off the rim the foot is in the air; then the nearest point of the cloud is the answer.
    if ((foot - at).norm() < smoothing_m) at = foot;
  }
  const double off = plane.normal_in_couch.dot(at - plane.at_in_couch);
  return {at - off * plane.normal_in_couch, plane.normal_in_couch, (at - place_in_couch).norm()};
}

std::optional<SurfacePoint> BackSurface::along(const Vector3& origin_in_couch,
                                               const Vector3& direction_in_couch) const {
  const Vector3 direction = direction_in_couch.normalized();
  // A ray between the points of the cloud passes each of them by at most this distance.
  const double touching = std::max(8_mm, 1.2 * tree_->spacing_m);
  double t = 0.0;
  while (t < reach_m) {
    const double distance = tree_->closest(origin_in_couch + t * direction).second;
    if (distance < touching) {
      double s = t;
      SurfacePoint plane;
      bool meets = true;
      for (int step = 0; step < 8 && meets; ++step) {
        plane = tree_->plane_at(
            tree_->cloud.points[tree_->closest(origin_in_couch + s * direction).first]);
        const double slope = plane.normal_in_couch.dot(direction);
        const double next = plane.normal_in_couch.dot(plane.at_in_couch - origin_in_couch) / slope;
        meets = std::abs(slope) > 0.05 && std::abs(next - s) < 60_mm;
        if (meets && std::abs(next - s) < 0.01_mm) {
          s = next;
          break;
        }
        if (meets) s = next;
      }
      const Vector3 at = origin_in_couch + s * direction;
      if (meets && s >= 0.0 && tree_->closest(at).second < 1.5 * touching) {
        return SurfacePoint{at, plane.normal_in_couch, s};
      }
      // A grazing ray never crosses the local planes; its closest approach is the answer.
      const SurfacePoint grazed = nearest(origin_in_couch + t * direction);
      if (grazed.distance_m < 0.7 * touching) {
        return SurfacePoint{grazed.at_in_couch, grazed.normal_in_couch, t};
      }
      t += touching;
    } else {
      t += std::max(distance - 0.8 * touching, 1_mm);
    }
  }
  return std::nullopt;
}

}  // namespace tuina::body
