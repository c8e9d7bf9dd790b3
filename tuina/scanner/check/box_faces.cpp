// SPDX-License-Identifier: Apache-2.0
#include "tuina/scanner/check/box_faces.hpp"

#include <algorithm>
#include <cmath>

#include "tuina/core/decompositions.hpp"
#include "tuina/core/random.hpp"
#include "tuina/core/units.hpp"

namespace tuina::scanner {
namespace {

constexpr int max_faces = 16;
constexpr int tries = 250;
constexpr std::size_t sampled_points = 6000;
constexpr std::size_t min_around = 12;  // sampled points around a seed
constexpr std::size_t min_points = 150;
constexpr double on_face_m = 2.5_mm;
constexpr double around_share = 0.12;  // share of the widest face
const double alike = std::cos(25.0_deg);

struct FaceSample {
  Vector3 point, normal;
};

Face through(std::vector<Vector3> points, const Vector3& toward) {
  Face face;
  for (const Vector3& point : points) face.middle += point;
  face.middle /= static_cast<double>(points.size());
  Matrix3 spread = Matrix3::Zero();
  for (const Vector3& point : points) {
    spread += (point - face.middle) * (point - face.middle).transpose();
  }
  const PrincipalAxes principal = principal_axes(spread);
  face.normal = principal.axes.col(0);
  if (face.normal.dot(toward) < 0.0) face.normal = -face.normal;
  face.offset_m = face.normal.dot(face.middle);
  face.rms_m = std::sqrt(std::max(0.0, principal.moments(0)) / static_cast<double>(points.size()));
  face.points = std::move(points);
  return face;
}

bool on(const Face& face, const FaceSample& sample) {
  return std::abs(face.out_m(sample.point)) < on_face_m && face.normal.dot(sample.normal) > alike;
}

// The plane with most samples, from the flat neighbourhoods of random seeds.
Face largest(const std::vector<FaceSample>& samples, double max_width_m, Random& random) {
  const std::size_t step = std::max<std::size_t>(1, samples.size() / sampled_points);
  Face best;
  std::size_t most = 0;
  for (int i = 0; i < tries; ++i) {
    const auto drawn =
        static_cast<std::size_t>(uniform(random, 0.0, 1.0) * static_cast<double>(samples.size()));
    const FaceSample& seed = samples[std::min(drawn, samples.size() - 1)];
    std::vector<Vector3> around;
    for (std::size_t k = 0; k < samples.size(); k += step) {
      const bool near = (samples[k].point - seed.point).norm() < around_share * max_width_m;
      if (near && samples[k].normal.dot(seed.normal) > alike) around.push_back(samples[k].point);
    }
    if (around.size() < min_around) continue;
    const Face face = through(std::move(around), seed.normal);
    std::size_t points = 0;
    for (std::size_t k = 0; k < samples.size(); k += step) {
      const bool within = (samples[k].point - seed.point).norm() < max_width_m;
      points += within && on(face, samples[k]);
    }
    if (points > most) {
      most = points;
      best = face;
    }
  }
  return best;
}

}  // namespace

std::vector<Face> find_faces(const PointCloud& cloud, double max_width_m) {
  std::vector<FaceSample> rest;
  if (cloud.normals.size() == cloud.size()) {
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      rest.push_back({cloud.points[i], cloud.normals[i]});
    }
  }
  Random random = make_random(1, "faces of a box");
  std::vector<Face> faces;
  for (int i = 0; i < max_faces && rest.size() >= min_points; ++i) {
    Face face = largest(rest, max_width_m, random);
    for (int refined = 0; refined < 3 && !face.points.empty(); ++refined) {
      std::vector<Vector3> members;
      for (const FaceSample& sample : rest) {
        if (on(face, sample)) members.push_back(sample.point);
      }
      if (members.empty()) break;
      face = through(std::move(members), face.normal);
    }
    if (face.points.size() < min_points) break;
    std::erase_if(rest, [&](const FaceSample& sample) { return on(face, sample); });
    // A couch or a wall continues beyond the box.
    const auto within = std::count_if(
        face.points.begin(), face.points.end(),
        [&](const Vector3& point) { return (point - face.middle).norm() < 0.6 * max_width_m; });
    if (static_cast<double>(within) > 0.95 * static_cast<double>(face.points.size())) {
      faces.push_back(std::move(face));
    }
  }
  return faces;
}

}  // namespace tuina::scanner
