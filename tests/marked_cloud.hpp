// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "tuina/body/learn/labelled_body.hpp"
#include "tuina/core/random.hpp"
#include "tuina/core/units.hpp"
#include "tuina/sim/person/person.hpp"

namespace tuina::test {

/// Cloud of a person with balls of 10 mm stuck on places of the skin, with 0.3 mm of noise.
inline PointCloud marked_cloud(const sim::Person& person, const std::vector<Vector3>& places,
                               double spacing_m, std::uint64_t seed) {
  constexpr double radius_m = 5_mm;
  Random random = make_random(seed, "marked cloud");
  const Vector3 out = person.position == BodyPosture::sitting ? Vector3::UnitY() : Vector3::UnitZ();
  PointCloud cloud = body::sample(person.skin_in_couch, spacing_m);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    double rise_m = 0.0;
    for (const Vector3& place : places) {
      const double off_m = (cloud.points[i] - place).norm();
      if (off_m < radius_m) rise_m = radius_m + std::sqrt(radius_m * radius_m - off_m * off_m);
    }
    cloud.points[i] += (rise_m + gaussian(random, 0.3_mm)) * out;
  }
  return cloud;
}

}  // namespace tuina::test
