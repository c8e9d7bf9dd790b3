// SPDX-License-Identifier: Apache-2.0
#include "tuina/body/board_plane.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "tests/reason.hpp"
#include "tuina/body/acupoints.hpp"
#include "tuina/core/random.hpp"
#include "tuina/core/units.hpp"
#include "tuina/sim/person/phantom.hpp"

namespace tuina::body {
namespace {

/// A board of 0.4 x 0.6 m on the back rest of a chair that leans backwards by `lean_rad`.
PointCloud board(double lean_rad, double noise_m, double wide_m = 0.4) {
  Random random = make_random(2, "board");
  PointCloud cloud;
  for (int i = 0; i < 5000; ++i) {
    const double up = uniform(random, 0.0, 0.6);
    cloud.points.emplace_back(uniform(random, -0.5, 0.5) * wide_m,
                              up * std::sin(lean_rad) + gaussian(random, noise_m),
                              0.2 + up * std::cos(lean_rad));
  }
  return cloud;
}

}  // namespace

TEST_CASE("three places of a scanned board give its plane, [thesis] 5.3") {
  const auto places = three_places_of(board(12_deg, 1_mm));
  REQUIRE(places);
  const Vector3 normal = plane_normal(*places);
  const Vector3 truth(0.0, std::cos(12_deg), -std::sin(12_deg));
  CHECK(to_deg(std::acos(normal.dot(truth))) < 0.3);
}

TEST_CASE("what is no board is refused with the cause") {
  CHECK(three_places_of(board(0.0, 0.0, 0.05)).error().message.find("mm wide") !=
        std::string::npos);
  CHECK(three_places_of(board(0.0, 20_mm)).error().message.find("no flat board") !=
        std::string::npos);
  CHECK(three_places_of({}).error().message.find("0 points") != std::string::npos);
}

TEST_CASE("the outline is found on the plane of a board as on that of the back itself") {
  const auto person =
      sim::make_phantom(sim::draw_phantom(sim::BodyType::medium, 3), BodyPosture::sitting);
  const auto back = fit_back({.points = sample(person.skin_in_couch, 5_mm).points});
  REQUIRE(back);
  const auto own = find_outline(*back);
  REQUIRE(own);
  const Vector3 normal = own->back_from_couch.linear().transpose() * Vector3::UnitY();
  const auto given = find_outline(*back, normal);
  REQUIRE_MESSAGE(given.has_value(), test::reason(given));
  const Matrix3 between =
      given->back_from_couch.linear() * own->back_from_couch.linear().transpose();
  CHECK((between - Matrix3::Identity()).norm() < 1e-3);
  // The outline stands on the board's plane, whatever the back does.
  const Vector3 tilted = Eigen::AngleAxisd(5_deg, Vector3::UnitX()) * normal;
  const auto other = find_outline(*back, tilted);
  REQUIRE(other);
  CHECK((other->back_from_couch.linear() * tilted - Vector3::UnitY()).norm() < 1e-9);
}

}  // namespace tuina::body
