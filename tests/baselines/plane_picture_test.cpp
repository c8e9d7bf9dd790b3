// SPDX-License-Identifier: Apache-2.0
#include "tuina/baselines/plane_picture.hpp"

#include <doctest/doctest.h>

#include "tuina/body/acupoints.hpp"
#include "tuina/core/units.hpp"
#include "tuina/sim/person/phantom.hpp"

namespace tuina::baselines {
using namespace body;
namespace {

struct Seen {
  BackSurface back;
  Outline outline;
  std::vector<Vector2> marks;
};

Seen see(sim::BodyType type, std::uint64_t seed) {
  const auto person = sim::make_phantom(sim::draw_phantom(type, seed), BodyPosture::sitting);
  auto back = fit_back({.points = sample(person.skin_in_couch, 5_mm).points});
  REQUIRE(back);
  const auto outline = find_outline(*back);
  REQUIRE(outline);
  std::vector<Vector2> marks;
  for (std::size_t i = 0; i < seven_acupoints.size(); ++i) {
    marks.push_back(outline->plane(person.acupoints[i].at_in_couch));
  }
  return {std::move(*back), *outline, marks};
}

}  // namespace

TEST_CASE("the picture way of the thesis and the point way give the same places, (5.1)-(5.7)") {
  const Seen standard = see(sim::BodyType::medium, 3);
  const Seen person = see(sim::BodyType::hefty, 5);
  constexpr double pixel_m = 3_mm;
  const auto standard_lines = feature_lines(standard.outline);
  const auto person_lines = feature_lines(person.outline);
  const PlanePicture of_standard =
      project(standard.back, standard.outline, standard.marks, pixel_m);
  const PlanePicture of_person = project(person.back, person.outline, {}, pixel_m);
  const PlanePicture morphed = morph(of_standard, standard_lines, of_person, person_lines);
  for (std::size_t i = 0; i < standard.marks.size(); ++i) {
    const auto shown = found_mark(morphed, static_cast<int>(i));
    REQUIRE(shown);
    const Vector2 carried = carry(standard.marks[i], person_lines, standard_lines);
    INFO(seven_acupoints[i], " is ", to_mm((*shown - carried).norm()), " mm apart");
    CHECK((*shown - carried).norm() < 1.0 * pixel_m);
  }
}

TEST_CASE("the ratio of (5.6) shows the person at 0 and the standard in the person's shape at 1") {
  const Seen standard = see(sim::BodyType::medium, 3);
  const PlanePicture picture = project(standard.back, standard.outline, {}, 6_mm);
  const auto lines = feature_lines(standard.outline);
  PlanePicture white = picture;
  for (auto& sample : white.image.data) sample = 255;
  CHECK(morph(white, lines, picture, lines, 0.0).image.data == picture.image.data);
  CHECK(morph(picture, lines, white, lines, 1.0).image.data == picture.image.data);
}

TEST_CASE("the left of the person is on the left of the picture, the head on top") {
  const Seen seen = see(sim::BodyType::slim, 2);
  const PlanePicture picture = project(seen.back, seen.outline, seen.marks, 6_mm);
  const auto shoulder_blade = found_mark(picture, 0);  // SI11_L
  const auto loins = found_mark(picture, 6);           // GV4
  REQUIRE(shoulder_blade);
  REQUIRE(loins);
  CHECK(picture.pixel_of(*shoulder_blade).x() < 0.5 * picture.image.width);
  CHECK(picture.pixel_of(*shoulder_blade).y() < picture.pixel_of(*loins).y());
}

}  // namespace tuina::baselines
