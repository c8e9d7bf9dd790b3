// SPDX-License-Identifier: Apache-2.0
#include "tuina/scanner/check/check_sphere.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "tests/reason.hpp"
#include "tuina/core/random.hpp"
#include "tuina/core/units.hpp"

using namespace tuina;
using namespace tuina::scanner;

namespace {

// The upper half of a ball of 150 mm lying on a table, with noise.
PointCloud ball_on_table(double noise_m = 0.5_mm) {
  Random random = make_random(3, "ball on a table");
  PointCloud cloud;
  while (cloud.size() < 4000) {
    const Vector3 normal =
        Vector3(gaussian(random, 1.0), gaussian(random, 1.0), std::abs(gaussian(random, 1.0)))
            .normalized();
    cloud.points.push_back(Vector3(0.1, -0.3, 0.075) +
                           (0.075 + gaussian(random, noise_m)) * normal);
    cloud.normals.push_back(normal);
  }
  while (cloud.size() < 12000) {
    cloud.points.emplace_back(uniform(random, -0.4, 0.4), uniform(random, -0.6, 0.0),
                              gaussian(random, noise_m));
    cloud.normals.emplace_back(Vector3::UnitZ());
  }
  return cloud;
}

}  // namespace

TEST_CASE("a ball of known size confirms sign and scale") {
  const auto sphere = check_sphere(ball_on_table(), 0.15);
  REQUIRE_MESSAGE(sphere.has_value(), test::reason(sphere));
  CHECK(std::abs(sphere->diameter_m - 0.15) < 0.5_mm);
  CHECK((sphere->centre - Vector3(0.1, -0.3, 0.075)).norm() < 0.5_mm);
  CHECK(sphere->points > 3000);
  CHECK(sphere->rms_m < 1.0_mm);
}

TEST_CASE("a scan in another scale, inside out, or without the ball is refused") {
  PointCloud large = ball_on_table();
  for (Vector3& point : large.points) point *= 1.05;
  CHECK(std::abs(find_sphere(large, 0.15)->diameter_m - 0.1575) < 0.5_mm);
  CHECK(check_sphere(large, 0.15).error().message.find("scale") != std::string::npos);

  PointCloud hollow = ball_on_table();
  for (Vector3& normal : hollow.normals) normal = -normal;
  CHECK(check_sphere(hollow, 0.15).error().message.find("hollow") != std::string::npos);

  PointCloud table = ball_on_table();
  table.points.erase(table.points.begin(), table.points.begin() + 4000);
  table.normals.erase(table.normals.begin(), table.normals.begin() + 4000);
  CHECK(check_sphere(table, 0.15).error().fault == Fault::not_found);
  CHECK_FALSE(check_sphere(PointCloud{}, 0.15).has_value());
}
