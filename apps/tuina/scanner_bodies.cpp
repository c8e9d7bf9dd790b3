// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>

#include "apps/tuina/scanner_trials.hpp"
#include "tuina/core/units.hpp"

namespace tuina::app {
namespace {

const Vector3 box_size_m(150.0_mm, 150.0_mm, 200.0_mm);
constexpr double radius_m = 75.0_mm;
// 1 m before the scanner that looks at one who sits (sim::usual_mount).
const Vector3 place_in_couch(0.0, 0.13, 0.41);

// An edge upright to the sight, then tipped towards the scanner so that the lid shows too.
Matrix3 couch_from_box() {
  return (Eigen::AngleAxisd(-35.0_deg, Vector3::UnitX()) *
          Eigen::AngleAxisd(45.0_deg, Vector3::UnitZ()))
      .toRotationMatrix();
}

Mesh box_mesh() {
  Mesh mesh;
  for (int corner = 0; corner < 8; ++corner) {
    const Vector3 sign((corner & 1) != 0 ? 0.5 : -0.5, (corner & 2) != 0 ? 0.5 : -0.5,
                       (corner & 4) != 0 ? 0.5 : -0.5);
    mesh.vertices.push_back(place_in_couch + couch_from_box() * sign.cwiseProduct(box_size_m));
  }
  const int faces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                           {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  for (const auto& f : faces) {
    mesh.triangles.push_back({f[0], f[1], f[2]});
    mesh.triangles.push_back({f[0], f[2], f[3]});
  }
  return mesh;
}

Mesh sphere_mesh() {
  constexpr int around = 240;
  constexpr int up = 120;
  Mesh mesh;
  for (int i = 0; i <= up; ++i) {
    for (int k = 0; k < around; ++k) {
      const double polar = pi * i / up;
      const double turn = 2.0 * pi * k / around;
      mesh.vertices.push_back(place_in_couch + radius_m * Vector3(std::sin(polar) * std::cos(turn),
                                                                  std::sin(polar) * std::sin(turn),
                                                                  std::cos(polar)));
    }
  }
  for (int i = 0; i < up; ++i) {
    for (int k = 0; k < around; ++k) {
      const int a = i * around + k;
      const int b = i * around + (k + 1) % around;
      mesh.triangles.push_back({a, a + around, b});
      mesh.triangles.push_back({b, a + around, b + around});
    }
  }
  return mesh;
}

struct Plane {
  Vector3 normal = Vector3::Zero();  // out of the box
  double offset_m = 0.0;
  [[nodiscard]] double distance_m(const Vector3& point) const {
    return normal.dot(point) - offset_m;
  }
};

Plane fit_plane(const std::vector<Vector3>& points, const Vector3& outward) {
  Vector3 middle = Vector3::Zero();
  for (const Vector3& point : points) middle += point;
  middle /= static_cast<double>(points.size());
  Matrix3 spread = Matrix3::Zero();
  for (const Vector3& point : points) {
    spread += (point - middle) * (point - middle).transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Matrix3> solver(spread);
  Vector3 normal = solver.eigenvectors().col(0);
  if (normal.dot(outward) < 0.0) normal = -normal;
  return {normal, normal.dot(middle)};
}

}  // namespace

Result<BoxTrial> box_trial(const sim::LaserScannerOptions& options, std::uint64_t seed) {
  auto cloud = scan_of_body(box_mesh(), options, seed);
  if (!cloud) return tl::unexpected(cloud.error());
  BoxTrial trial;
  trial.cloud = std::move(*cloud);
  // The three faces that look at the scanner, out along +y of the couch. Points within a fifth of
  // the size of an edge may belong to the next face.
  std::array<std::vector<Vector3>, 3> points;
  std::array<Vector3, 3> outward;
  const Matrix3 axes = couch_from_box();
  for (int k = 0; k < 3; ++k) {
    const auto face = static_cast<std::size_t>(k);
    outward[face] = axes.col(k).y() > 0.0 ? Vector3(axes.col(k)) : Vector3(-axes.col(k));
    const double out_m = 0.5 * box_size_m[k];
    for (std::size_t i = 0; i < trial.cloud.size(); ++i) {
      const Vector3 from_middle = trial.cloud.points[i] - place_in_couch;
      const bool on_face = std::abs(outward[face].dot(from_middle) - out_m) < 8.0_mm;
      if (on_face && trial.cloud.normals[i].dot(outward[face]) > std::cos(20.0_deg)) {
        points[face].push_back(trial.cloud.points[i]);
      }
    }
    if (points[face].size() < 100) {
      return fail(Fault::not_found, "face {} of the box has {} points", k, points[face].size());
    }
  }
  std::array<Plane, 3> planes;
  double squares = 0.0, count = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    planes[k] = fit_plane(points[k], outward[k]);
    for (const Vector3& point : points[k]) squares += std::pow(planes[k].distance_m(point), 2);
    count += static_cast<double>(points[k].size());
  }
  trial.flatness_m = std::sqrt(squares / count);
  for (std::size_t k = 0; k < 3; ++k) {
    const Plane& face = planes[k];
    const std::size_t next = (k + 1) % 3;
    trial.angles_rad.push_back(
        std::acos(std::clamp(face.normal.dot(planes[next].normal), -1., 1.)));
    // The edge upright to this face runs along the two others, to where their points end.
    double longest_m = 0.0;
    for (const std::size_t other : {next, (k + 2) % 3}) {
      for (const Vector3& point : points[other]) {
        longest_m = std::max(longest_m, -face.distance_m(point));
      }
    }
    trial.edges_m.push_back(longest_m);
  }
  return trial;
}

Result<SphereTrial> sphere_trial(const sim::LaserScannerOptions& options, std::uint64_t seed) {
  auto cloud = scan_of_body(sphere_mesh(), options, seed);
  if (!cloud) return tl::unexpected(cloud.error());
  SphereTrial trial;
  trial.cloud = std::move(*cloud);
  // |p - c|^2 = r^2 is linear in c and r^2 - c^2.
  Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
  Eigen::Vector4d rhs = Eigen::Vector4d::Zero();
  for (const Vector3& point : trial.cloud.points) {
    const Vector3 p = point - place_in_couch;
    const Eigen::Vector4d row(2.0 * p.x(), 2.0 * p.y(), 2.0 * p.z(), 1.0);
    normal += row * row.transpose();
    rhs += row * p.squaredNorm();
  }
  const Eigen::Vector4d found = normal.ldlt().solve(rhs);
  const Vector3 centre = found.head<3>();
  trial.radius_m = std::sqrt(found(3) + centre.squaredNorm());
  for (const Vector3& point : trial.cloud.points) {
    trial.rms_m += std::pow((point - place_in_couch - centre).norm() - trial.radius_m, 2);
  }
  trial.rms_m = std::sqrt(trial.rms_m / static_cast<double>(trial.cloud.size()));
  return trial;
}

}  // namespace tuina::app
