// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <algorithm>

#include "apps/simulated/labelled_phantom.hpp"
#include "tests/reason.hpp"
#include "tuina/body/acupoints.hpp"
#include "tuina/core/random.hpp"
#include "tuina/core/units.hpp"
#include "tuina/sim/scanner/depth_camera.hpp"

namespace tuina::body {
namespace {

const Atlas& shipped() {
  static const Atlas atlas = *read_atlas(TUINA_SOURCE_DIR "/models/atlas.tuina");
  return atlas;
}

LabelledBody phantom(BodyPosture position) {
  return app::labelled(sim::make_phantom(sim::draw_phantom(78), position));
}

Result<Mapping> map(const PointCloud& cloud) {
  const auto back = fit_back(cloud);
  if (!back) return tl::unexpected(back.error());
  return locate_acupoints(*back, shipped());
}

/// Chair or bed in view.
PointCloud couch(BodyPosture position) {
  PointCloud cloud;
  Random random = make_random(4, "couch");
  const double half_m = position == BodyPosture::sitting ? 0.3 : 0.95;
  for (int i = 0; i < 20000; ++i) {
    cloud.points.emplace_back(uniform(random, -0.35, 0.35), uniform(random, -half_m, half_m),
                              gaussian(random, 3_mm));
  }
  return cloud;
}

/// The top and sides of a box that stands on the couch.
void add_box(PointCloud& cloud, const Vector3& middle, const Vector3& half) {
  Random random = make_random(6, "box");
  for (int i = 0; i < 4000; ++i) {
    Vector3 p(uniform(random, -1.0, 1.0), uniform(random, -1.0, 1.0), uniform(random, -1.0, 1.0));
    p[i % 3] = i % 2 == 0 ? 1.0 : -1.0;
    cloud.points.push_back(middle + half.cwiseProduct(p));
  }
}

double max_distance_mm(const Mapping& a, const Mapping& b) {
  double far = 0.0;
  for (std::size_t i = 0; i < seven_acupoints.size(); ++i) {
    far = std::max(far, (a.acupoints[i].at_in_couch - b.acupoints[i].at_in_couch).norm());
  }
  return to_mm(far);
}

}  // namespace

TEST_CASE("an empty couch is refused, with how much stands on it") {
  for (const BodyPosture position : {BodyPosture::sitting, BodyPosture::prone}) {
    const auto found = map(couch(position));
    REQUIRE_FALSE(found);
    CHECK(found.error().message.find("0 of 20000 points are above the couch") != std::string::npos);
  }
}

TEST_CASE("another thing on the couch beside the person changes nothing") {
  for (const BodyPosture position : {BodyPosture::sitting, BodyPosture::prone}) {
    CAPTURE(name_of(position));
    PointCloud cloud = sample(phantom(position).skin_in_couch, 5_mm);
    const auto alone = map(cloud);
    REQUIRE(alone);
    double rim = 0.0;
    for (const Vector3& p : cloud.points) rim = std::min(rim, p.x());
    add_box(cloud, {rim - 0.2, -0.1, 0.10}, {0.08, 0.12, 0.06});
    const auto beside = map(cloud);
    REQUIRE_MESSAGE(beside.has_value(), test::reason(beside));
    CHECK(max_distance_mm(*alone, *beside) < 3.0);
  }
}

TEST_CASE("ten thousand points or a million of one person give the same answer") {
  for (const BodyPosture position : {BodyPosture::sitting, BodyPosture::prone}) {
    const LabelledBody person = phantom(position);
    PointCloud many = sample(person.skin_in_couch, 1_mm);
    Random random = make_random(7, "camera");
    PointCloud few;
    const double share = 1e4 / static_cast<double>(many.size());
    for (Vector3& p : many.points) {
      if (uniform(random, 0.0, 1.0) < share) few.points.push_back(p);
      for (Eigen::Index k = 0; k < 3; ++k) p[k] += gaussian(random, 1.7_mm);  // 3 mm in all
    }
    REQUIRE(many.size() > 500'000);
    const auto from_many = map(many);
    const auto from_few = map(few);
    REQUIRE_MESSAGE(from_many.has_value(), test::reason(from_many));
    REQUIRE_MESSAGE(from_few.has_value(), test::reason(from_few));
    CHECK(max_distance_mm(*from_many, *from_few) < 8.0);
    for (std::size_t i = 0; i < seven_acupoints.size(); ++i) {
      CHECK((from_many->acupoints[i].at_in_couch - person.acupoints[i].at_in_couch).norm() <
            from_many->acupoints[i].uncertainty_m + 2_mm);
    }
  }
}

TEST_CASE("a coarse or fine picture of a depth camera shows the points, couch and floor in view") {
  for (const BodyPosture position : {BodyPosture::sitting, BodyPosture::prone}) {
    for (const int points : {10'000, 1'000'000}) {
      CAPTURE(name_of(position));
      CAPTURE(points);
      const LabelledBody person = phantom(position);
      const PointCloud picture =
          sim::depth_picture(person.skin_in_couch, position, 3, {.points = points});
      const auto found = map(picture);
      REQUIRE_MESSAGE(found.has_value(), test::reason(found));
      for (std::size_t i = 0; i < seven_acupoints.size(); ++i) {
        const Acupoint& point = found->acupoints[i];
        CHECK((point.at_in_couch - person.acupoints[i].at_in_couch).norm() < point.uncertainty_m);
        CHECK(point.uncertainty_m < 40_mm);
      }
    }
  }
}

TEST_CASE("a laser that stood still for hundreds of frames changes no answer") {
  for (const auto position : {BodyPosture::sitting, BodyPosture::prone}) {
    const LabelledBody person = phantom(position);
    PointCloud cloud = sample(person.skin_in_couch, 5_mm);
    const auto before = map(cloud);
    REQUIRE_MESSAGE(before.has_value(), test::reason(before));
    const Vector3 spot = person.acupoints.back().at_in_couch;
    Random random = make_random(9, "laser");
    std::vector<Vector3> lit;
    for (const Vector3& p : cloud.points)
      if ((p - spot).norm() < 20_mm) lit.push_back(p);
    for (std::size_t i = 0; i < 300'000; ++i) {
      const Vector3 noise(gaussian(random, 0.3_mm), gaussian(random, 0.3_mm),
                          gaussian(random, 0.3_mm));
      cloud.points.push_back(lit[i % lit.size()] + noise);
    }
    const auto found = map(cloud);
    REQUIRE_MESSAGE(found.has_value(), test::reason(found));
    CHECK(max_distance_mm(*before, *found) < 5.0);
  }
}

TEST_CASE("pixels that fly above the back of a very dense picture do not change the answer") {
  const LabelledBody person = phantom(BodyPosture::prone);
  PointCloud cloud = sample(person.skin_in_couch, 0.5_mm);
  REQUIRE(cloud.points.size() > 1'500'000);
  const auto clear = map(cloud);
  Vector3 low = cloud.points.front(), high = low;
  for (const Vector3& p : cloud.points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  // So many that they hang together with the skin and with each other.
  Random random = make_random(8, "flying pixels");
  for (int i = 0; i < 40'000; ++i) {
    cloud.points.emplace_back(uniform(random, low.x(), high.x()),
                              uniform(random, low.y(), high.y()),
                              uniform(random, high.z() - 0.05, high.z() + 0.15));
  }
  const auto found = map(cloud);
  REQUIRE_MESSAGE(clear.has_value(), test::reason(clear));
  REQUIRE_MESSAGE(found.has_value(), test::reason(found));
  CHECK(max_distance_mm(*clear, *found) < 5.0);
}

}  // namespace tuina::body
