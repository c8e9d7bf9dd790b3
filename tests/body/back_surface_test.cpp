// SPDX-License-Identifier: Apache-2.0
#include "tuina/body/back_surface.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "tuina/core/random.hpp"
#include "tuina/core/units.hpp"

namespace tuina::body {
namespace {

/// Half an elliptic cylinder of a person's size sitting on the seat: every normal of it is known.
constexpr double wide_m = 0.18;
constexpr double deep_m = 0.11;
constexpr double tall_m = 0.80;

PointCloud sitting_log(double noise_m, int points = 30000) {
  Random random = make_random(7, "log");
  PointCloud cloud;
  for (int i = 0; i < points; ++i) {
    const double angle = uniform(random, 0.0, pi);
    const Vector3 at(wide_m * std::cos(angle), deep_m * std::sin(angle),
                     uniform(random, 0.03, tall_m));
    const Vector3 normal =
        Vector3(at.x() / (wide_m * wide_m), at.y() / (deep_m * deep_m), 0.0).normalized();
    cloud.points.push_back(at + gaussian(random, noise_m) * normal);
  }
  return cloud;
}

PointCloud scaled(PointCloud cloud, double factor) {
  for (Vector3& p : cloud.points) p *= factor;
  return cloud;
}

double elliptic_distance(const Vector3& p) {  // to first order
  const double f = p.x() * p.x() / (wide_m * wide_m) + p.y() * p.y() / (deep_m * deep_m) - 1.0;
  const Vector3 g(2.0 * p.x() / (wide_m * wide_m), 2.0 * p.y() / (deep_m * deep_m), 0.0);
  return std::abs(f) / g.norm();
}

}  // namespace

TEST_CASE("a place beside the skin falls onto it, with the normal of the skin") {
  const auto back = fit_back(sitting_log(2_mm));
  REQUIRE(back);
  CHECK(back->position() == BodyPosture::sitting);
  Random random = make_random(3, "places");
  for (int i = 0; i < 200; ++i) {
    const double angle = uniform(random, 0.3, pi - 0.3);
    const Vector3 skin(wide_m * std::cos(angle), deep_m * std::sin(angle),
                       uniform(random, 0.1, 0.7));
    const Vector3 normal =
        Vector3(skin.x() / (wide_m * wide_m), skin.y() / (deep_m * deep_m), 0.0).normalized();
    const SurfacePoint found = back->nearest(skin + uniform(random, -10_mm, 20_mm) * normal);
    CHECK(elliptic_distance(found.at_in_couch) < 1.5_mm);
    CHECK((found.at_in_couch - skin).norm() < 4_mm);
    CHECK(found.normal_in_couch.dot(normal) > std::cos(6_deg));
  }
}

TEST_CASE("a ray meets the skin where it enters, and passes by where there is none") {
  const auto back = fit_back(sitting_log(1_mm));
  REQUIRE(back);
  const auto hit = back->along({0.05, 1.0, 0.5}, {0.0, -1.0, 0.0});
  REQUIRE(hit);
  const double y = deep_m * std::sqrt(1.0 - 0.05 * 0.05 / (wide_m * wide_m));
  CHECK(std::abs(hit->at_in_couch.y() - y) < 1_mm);
  CHECK(std::abs(hit->at_in_couch.x() - 0.05) < 1e-9);
  CHECK(std::abs(hit->distance_m - (1.0 - y)) < 1_mm);
  CHECK_FALSE(back->along({0.4, 1.0, 0.5}, {0.0, -1.0, 0.0}));
}

TEST_CASE("what is not a person on the couch is refused with the cause") {
  CHECK(fit_back(PointCloud{}).error().message.find("no person") != std::string::npos);
  CHECK(fit_back(sitting_log(0.0, 500)).error().message.find("500 points") != std::string::npos);
  CHECK(fit_back(scaled(sitting_log(0.0), 1000.0)).error().message.find("millimetres") !=
        std::string::npos);
  CHECK(fit_back(scaled(sitting_log(0.0), 100.0)).error().message.find("centimetres") !=
        std::string::npos);
  CHECK_FALSE(fit_back(sitting_log(0.0), {.position = BodyPosture::prone}));
  PointCloud two = sitting_log(0.0);
  for (const Vector3& p : sitting_log(0.0).points) two.points.push_back(p + Vector3(0.6, 0.0, 0.0));
  CHECK(fit_back(two).error().message.find("two people") != std::string::npos);
}

TEST_CASE("points that are not numbers change nothing") {
  PointCloud cloud = sitting_log(1_mm);
  const auto clean = fit_back(cloud);
  cloud.points.insert(cloud.points.begin() + 100, Vector3::Constant(std::nan("")));
  const auto dirty = fit_back(cloud);
  REQUIRE(clean);
  REQUIRE(dirty);
  CHECK(clean->points().points == dirty->points().points);
}

}  // namespace tuina::body
