// SPDX-License-Identifier: Apache-2.0
#include "tuina/body/field_morphing.hpp"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "tuina/core/random.hpp"
#include "tuina/core/units.hpp"

namespace tuina::body {
namespace {

Vector2 somewhere(Random& random) {
  return {uniform(random, -0.3, 0.3), uniform(random, -0.5, 0.3)};
}

std::vector<FeatureLine> some_lines(Random& random) {
  std::vector<FeatureLine> lines(4);
  for (auto& line : lines) line = {somewhere(random), somewhere(random)};
  return lines;
}

}  // namespace

TEST_CASE("equal lines morph nothing, [thesis] (5.1)-(5.5)") {
  Random random = make_random(1, "lines");
  for (int i = 0; i < 200; ++i) {
    const auto lines = some_lines(random);
    const Vector2 x = somewhere(random);
    CHECK((warp(x, lines, lines) - x).norm() < 1e-12);
  }
}

TEST_CASE("lines moved together move every point with them") {
  Random random = make_random(2, "lines");
  const Vector2 shift(0.07, -0.02);
  for (int i = 0; i < 200; ++i) {
    const auto lines = some_lines(random);
    auto moved = lines;
    for (auto& line : moved) line = {line.p + shift, line.q + shift};
    const Vector2 x = somewhere(random);
    CHECK((warp(x, lines, moved) - (x + shift)).norm() < 1e-12);
  }
}

TEST_CASE("lines turned together turn every point with them") {
  Random random = make_random(3, "lines");
  const Eigen::Rotation2Dd turn(0.3);
  for (int i = 0; i < 200; ++i) {
    const auto lines = some_lines(random);
    auto turned = lines;
    for (auto& line : turned) line = {turn * line.p, turn * line.q};
    const Vector2 x = somewhere(random);
    CHECK((warp(x, lines, turned) - turn * x).norm() < 1e-12);
  }
}

TEST_CASE("a line twice as long stretches along itself and not across, [thesis] (5.3)") {
  const std::vector<FeatureLine> line = {{{0.0, 0.0}, {0.0, 0.2}}};
  const std::vector<FeatureLine> longer = {{{0.0, 0.0}, {0.0, 0.4}}};
  CHECK((warp({0.05, 0.1}, line, longer) - Vector2(0.05, 0.2)).norm() < 1e-12);
}

TEST_CASE("a point on a line goes with that line whatever the others do, when a is small") {
  const std::vector<FeatureLine> lines = {{{-0.2, 0.0}, {0.2, 0.0}}, {{0.0, -0.4}, {0.0, -0.1}}};
  auto moved = lines;
  moved[0] = {{-0.25, 0.02}, {0.25, 0.02}};
  moved[1] = {{0.05, -0.5}, {0.05, -0.1}};
  const Vector2 x = warp({0.1, 0.0}, lines, moved, {.a_m = 1e-9, .b = 2.0, .p = 0.5});
  CHECK((x - Vector2(0.125, 0.02)).norm() < 1e-6);
}

TEST_CASE("exchanging the roles of the lines brings a point back when one line pair is given") {
  Random random = make_random(4, "lines");
  for (int i = 0; i < 100; ++i) {
    const std::vector<FeatureLine> from = {{somewhere(random), somewhere(random)}};
    const std::vector<FeatureLine> to = {{somewhere(random), somewhere(random)}};
    const Vector2 x = somewhere(random);
    CHECK((warp(warp(x, from, to), to, from) - x).norm() < 1e-9);
  }
}

TEST_CASE("a mark is carried to where the picture way would show it") {
  Random random = make_random(5, "lines");
  int carried = 0;
  for (int i = 0; i < 100; ++i) {
    const auto standard = some_lines(random);
    auto person = standard;
    for (auto& line : person)
      line = {line.p + 0.1 * somewhere(random), line.q + 0.1 * somewhere(random)};
    const Vector2 mark = somewhere(random);
    const Vector2 found = carry(mark, person, standard);
    if ((warp(found, person, standard) - mark).norm() < 1e-6) ++carried;
    CHECK((warp(found, person, standard) - mark).norm() < 5_mm);
  }
  CHECK(carried >= 95);  // near crossing lines the warp folds, and nothing is there
}

}  // namespace tuina::body
