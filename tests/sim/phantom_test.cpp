// SPDX-License-Identifier: Apache-2.0
#include "tuina/sim/person/phantom.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <map>

using namespace tuina;
using namespace tuina::sim;

namespace {

std::map<std::string, Vector3> points_of(const Person& person) {
  std::map<std::string, Vector3> points;
  for (const auto& landmark : person.landmarks) points[landmark.name] = landmark.at_in_couch;
  for (const auto& point : person.acupoints) points[point.name] = point.at_in_couch;
  return points;
}

double distance_to_skin(const Person& person, const Vector3& at) {
  double nearest = 1e9;
  for (const Vector3& vertex : person.skin_in_couch.vertices) {
    nearest = std::min(nearest, (vertex - at).norm());
  }
  return nearest;
}

}  // namespace

TEST_CASE("the same shape gives the same person bit for bit, another seed another person") {
  const Person once = make_phantom(draw_phantom(BodyType::medium, 7), BodyPosture::sitting);
  const Person again = make_phantom(draw_phantom(BodyType::medium, 7), BodyPosture::sitting);
  const Person other = make_phantom(draw_phantom(BodyType::medium, 8), BodyPosture::sitting);
  CHECK(once.skin_in_couch.vertices == again.skin_in_couch.vertices);
  CHECK(once.skin_in_couch.triangles == again.skin_in_couch.triangles);
  CHECK((once.acupoints[0].at_in_couch - other.acupoints[0].at_in_couch).norm() > 1e-3);
}

TEST_CASE("whoever is drawn, the skin is fine, open towards the front, and carries all points") {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    for (const BodyPosture position : {BodyPosture::sitting, BodyPosture::prone}) {
      CAPTURE(seed);
      CAPTURE(name_of(position));
      const Person person = make_phantom(draw_phantom(seed), position);
      const Mesh& skin = person.skin_in_couch;
      CHECK(skin.triangles.size() >= 20000);
      const int out = position == BodyPosture::sitting ? 1 : 2;
      double facing_away = 0.0;
      double area = 0.0;
      for (const auto& [a, b, c] : skin.triangles) {
        const auto at = [&](int i) { return skin.vertices[static_cast<std::size_t>(i)]; };
        const Vector3 normal = (at(b) - at(a)).cross(at(c) - at(a));
        area += normal.norm();
        if (normal[out] < -0.5 * normal.norm()) facing_away += normal.norm();
      }
      CHECK(facing_away / area < 0.01);
      REQUIRE(person.acupoints.size() == 27);
      for (const Acupoint& point : person.acupoints) {
        CAPTURE(point.name);
        CHECK(distance_to_skin(person, point.at_in_couch) < 0.008);
        CHECK(point.normal_in_couch[out] > 0.3);
        CHECK(std::abs(point.normal_in_couch.norm() - 1.0) < 1e-9);
      }
    }
  }
}

TEST_CASE("the acupoints of a straight phantom obey the rules of the World Health Organization") {
  for (const bool woman : {false, true}) {
    const Person person = make_phantom({.woman = woman, .height_m = 1.7}, BodyPosture::sitting);
    auto at = points_of(person);
    const double cun = person.three_cun_m / 3.0;
    CHECK(std::abs(at["BL47_L"].x() - 3.0 * cun) < 0.0005);  // the arms draw the skin a little
    CHECK(at["BL50_R"].x() == doctest::Approx(-3.0 * cun));
    CHECK(at["BL23_L"].x() == doctest::Approx(1.5 * cun));
    CHECK(at["GV4"].x() == doctest::Approx(0.0));
    CHECK(at["GV4"].z() < at["L2"].z());
    CHECK(at["GV4"].z() > at["L4"].z());
    CHECK(at["BL47_L"].z() < at["T9"].z());
    CHECK(at["BL50_L"].z() < at["T12"].z());
    // SI11 lies a third of the way from the middle of the scapula's spine to its tip, both seen
    // from behind; arms that hang forward draw the skin inwards by a few millimetres.
    const double third_down =
        at["scapula_spine_mid_L"].x() +
        (at["scapula_inferior_angle_L"].x() - at["scapula_spine_mid_L"].x()) / 3.0;
    CHECK(std::abs(at["SI11_L"].x() - third_down) < 0.006);
  }
}

TEST_CASE("the body types differ as their names say") {
  const auto waist_m = [](BodyType type) {
    double sum = 0.0;
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      auto at = points_of(make_phantom(draw_phantom(type, seed), BodyPosture::sitting));
      sum += (at["waist_L"] - at["waist_R"]).norm();
    }
    return sum / 5.0;
  };
  CHECK(waist_m(BodyType::slim) < waist_m(BodyType::medium) - 0.02);
  CHECK(waist_m(BodyType::medium) < waist_m(BodyType::hefty) - 0.02);
}

TEST_CASE("a phantom sits on the seat and lies on the bed") {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const Person sitting = make_phantom(draw_phantom(seed), BodyPosture::sitting);
    const Person prone = make_phantom(draw_phantom(seed), BodyPosture::prone);
    double lowest = 1.0;
    double head = 0.0;
    for (const Vector3& v : sitting.skin_in_couch.vertices) {
      lowest = std::min(lowest, v.z());
      head = std::max(head, v.z());
    }
    CHECK(lowest > 0.0);
    CHECK(lowest < 0.12);
    CHECK(head > 0.70);
    CHECK(head < 1.0);
    double below_bed = 0.0;
    double top = 0.0;
    for (const Vector3& v : prone.skin_in_couch.vertices) {
      below_bed = std::min(below_bed, v.z());
      top = std::max(top, v.z());
    }
    CHECK(below_bed > -0.01);
    CHECK(top > 0.18);
    CHECK(top < 0.45);
  }
}
