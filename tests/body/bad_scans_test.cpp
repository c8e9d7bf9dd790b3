// SPDX-License-Identifier: Apache-2.0
#include "apps/simulated/bad_scans.hpp"

#include <doctest/doctest.h>

#include <string_view>

#include "apps/simulated/labelled_phantom.hpp"
#include "tests/reason.hpp"

namespace tuina::app {
namespace {

const body::Atlas& shipped() {
  static const body::Atlas atlas = *body::read_atlas(TUINA_SOURCE_DIR "/models/atlas.tuina");
  return atlas;
}

Result<body::Mapping> map(const body::LabelledBody& person) {
  const auto back = body::fit_back(person.scan_in_couch);
  if (!back) return tl::unexpected(back.error());
  return body::locate_acupoints(*back, shipped());
}

body::LabelledBody phantom(BodyPosture position) {
  return labelled(sim::make_phantom(sim::draw_phantom(79), position));
}

const BadScan& named(std::string_view name) {
  for (const BadScan& bad : bad_scans()) {
    if (bad.name == name) return bad;
  }
  FAIL("no such bad scan");
  return bad_scans().front();
}

}  // namespace

TEST_CASE("a bad scan is refused or answered with a radius that holds its points") {
  // Every fourth kind; `evaluate acupoints --bad-scans` tries all of them on several people.
  const auto kinds = bad_scans();
  for (std::size_t i = 0; i < kinds.size(); i += 4) {
    const auto position = i % 8 == 0 ? BodyPosture::sitting : BodyPosture::prone;
    CAPTURE(kinds[i].name);
    CAPTURE(name_of(position));
    const body::LabelledBody person = spoilt(phantom(position), kinds[i]);
    const auto found = map(person);
    if (!found) continue;
    for (std::size_t k = 0; k < seven_acupoints.size(); ++k) {
      CAPTURE(seven_acupoints[k]);
      CAPTURE(found->acupoints[k].uncertainty_m);
      CAPTURE(place_error_m(found->acupoints[k], person.acupoints[k]));
      CHECK_FALSE(wrong_and_sure(found->acupoints[k], person.acupoints[k]));
    }
  }
}

TEST_CASE("a lying person of whom 540 mm with the seven points are in view is answered") {
  const body::LabelledBody person = spoilt(phantom(BodyPosture::prone), named("540 mm in view"));
  const auto found = map(person);
  REQUIRE_MESSAGE(found.has_value(), test::reason(found));
  for (std::size_t k = 0; k < seven_acupoints.size(); ++k) {
    CHECK(place_error_m(found->acupoints[k], person.acupoints[k]) <
          found->acupoints[k].uncertainty_m);
  }
}

}  // namespace tuina::app
