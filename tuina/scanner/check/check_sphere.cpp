// SPDX-License-Identifier: Apache-2.0
#include "tuina/scanner/check/check_sphere.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

#include "tuina/core/random.hpp"
#include "tuina/core/units.hpp"

namespace tuina::scanner {
namespace {

constexpr int sphere_tries = 4000;
constexpr std::size_t sampled_sphere_points = 3000;
constexpr double on_sphere_m = 3.0_mm;
constexpr std::size_t min_sphere_points = 300;
constexpr double sphere_allowed_m = 2.0_mm;
constexpr double sphere_allowed_share = 0.01;

bool on(const FoundSphere& sphere, const Vector3& point) {
  return std::abs((point - sphere.centre).norm() - 0.5 * sphere.diameter_m) < on_sphere_m;
}

// Least squares of |p|^2 = 2 c . p + k, linear in the centre c and k = r^2 - |c|^2.
FoundSphere fitted(const PointCloud& cloud, const FoundSphere& near) {
  Eigen::Matrix4d sums = Eigen::Matrix4d::Zero();
  Eigen::Vector4d moments = Eigen::Vector4d::Zero();
  FoundSphere result = near;
  result.points = 0;
  for (const Vector3& point : cloud.points) {
    if (!on(near, point)) continue;
    const Vector3 p = point - near.centre;
    const Eigen::Vector4d place(2.0 * p.x(), 2.0 * p.y(), 2.0 * p.z(), 1.0);
    sums += place * place.transpose();
    moments += place * p.squaredNorm();
    ++result.points;
  }
  if (result.points < 4) return near;
  const Eigen::Vector4d solution = sums.ldlt().solve(moments);
  result.centre = near.centre + solution.head<3>();
  result.diameter_m =
      2.0 * std::sqrt(std::max(0.0, solution(3) + solution.head<3>().squaredNorm()));
  double sum2 = 0.0;
  for (const Vector3& point : cloud.points) {
    if (!on(near, point)) continue;
    sum2 += std::pow((point - result.centre).norm() - 0.5 * result.diameter_m, 2);
  }
  result.rms_m = std::sqrt(sum2 / static_cast<double>(result.points));
  return result;
}

}  // namespace

Result<FoundSphere> find_sphere(const PointCloud& cloud, double diameter_m) {
  const auto none = [&] {
    return fail(Fault::not_found,
                "no ball of about {:.0f} mm is found among {} points; put it where the line "
                "crosses it, nothing within a hand's breadth",
                to_mm(diameter_m), cloud.size());
  };
  if (cloud.size() < min_sphere_points || cloud.normals.size() != cloud.size()) return none();
  Random random = make_random(1, "ball");
  const auto draw = [&] {
    const auto i =
        static_cast<std::size_t>(uniform(random, 0.0, 1.0) * static_cast<double>(cloud.size()));
    return std::min(i, cloud.size() - 1);
  };
  const std::size_t step = std::max<std::size_t>(1, cloud.size() / sampled_sphere_points);
  FoundSphere best;
  std::size_t most = 0;
  for (int i = 0; i < sphere_tries; ++i) {
    // The normals of two points intersect in the centre of the ball.
    const std::size_t a = draw();
    const std::size_t b = draw();
    const Vector3 between = cloud.points[a] - cloud.points[b];
    const Vector3 turned = cloud.normals[a] - cloud.normals[b];
    if (between.norm() > diameter_m || turned.norm() < 0.2) continue;
    const double radius_m = between.dot(turned) / turned.squaredNorm();
    if (std::abs(radius_m) < 0.25 * diameter_m || std::abs(radius_m) > diameter_m) continue;
    const FoundSphere sphere{.centre = cloud.points[a] - radius_m * cloud.normals[a],
                             .diameter_m = 2.0 * std::abs(radius_m),
                             .hollow = radius_m < 0.0};
    std::size_t points = 0;
    for (std::size_t k = 0; k < cloud.size(); k += step) points += on(sphere, cloud.points[k]);
    if (points > most) {
      most = points;
      best = sphere;
    }
  }
  if (most == 0) return none();
  for (int i = 0; i < 10; ++i) best = fitted(cloud, best);
  const bool about = best.diameter_m > 0.5 * diameter_m && best.diameter_m < 2.0 * diameter_m;
  if (best.points < min_sphere_points || !about) return none();
  return best;
}

Result<FoundSphere> check_sphere(const PointCloud& cloud, double diameter_m) {
  auto sphere = find_sphere(cloud, diameter_m);
  if (!sphere) return sphere;
  if (sphere->hollow) {
    return fail(Fault::bad_input,
                "the ball of {:.0f} mm comes out hollow: a sign of the calibration is wrong; are "
                "the pictures mirrored?",
                to_mm(diameter_m));
  }
  const double off_m = sphere->diameter_m - diameter_m;
  if (std::abs(off_m) > std::max(sphere_allowed_m, sphere_allowed_share * diameter_m)) {
    return fail(Fault::bad_input,
                "the ball of {:.1f} mm measures {:.1f} mm, round to {:.1f} mm: the scale of the "
                "calibration "
                "is wrong (is square_m in board.toml right?), or it is no ball",
                to_mm(diameter_m), to_mm(sphere->diameter_m), to_mm(sphere->rms_m));
  }
  return sphere;
}

}  // namespace tuina::scanner
