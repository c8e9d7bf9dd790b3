// SPDX-License-Identifier: Apache-2.0
#include "tuina/sim/scanner/skin_light.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "tuina/core/random.hpp"
#include "tuina/core/units.hpp"

using namespace tuina;
using namespace tuina::sim;

namespace {

const Vector3 out = Vector3::UnitY();

LeftSkin light_at(const ScanFlaws& flaws, const Vector3& at, double angle_rad = 0.0) {
  return leave_skin(flaws, at, {std::sin(angle_rad), -std::cos(angle_rad), 0.0}, out, 1);
}

/// Share of many places of the skin at which something is so.
template <typename Claim>
double share_of_places(const ScanFlaws& flaws, const Claim& claim) {
  Random random = make_random(2, "places");
  constexpr int places = 40'000;
  int so = 0;
  for (int i = 0; i < places; ++i) {
    const double x = uniform(random, -0.2, 0.2), z = uniform(random, 0.0, 0.5);
    so += claim(light_at(flaws, {x, 0.02 * std::sin(7.0 * x), z})) ? 1 : 0;
  }
  return static_cast<double>(so) / places;
}

}  // namespace

TEST_CASE("oblique light leaves the skin further along, straight light where it came in") {
  const ScanFlaws flaws{.scatter_m = 0.5_mm};
  CHECK(light_at(flaws, Vector3::Zero()).by.norm() < 1e-12);
  const LeftSkin left = light_at(flaws, Vector3::Zero(), 40_deg);
  CHECK(left.by.x() == doctest::Approx(0.5_mm * std::sin(40_deg) / 1.4).scale(1e-6));
  CHECK(std::abs(left.by.y()) < 1e-12);
  CHECK(left.spread_m > 0.3_mm);
  CHECK(left.share == 1.0);
}

TEST_CASE("dark skin sends back less, without flaws all light comes from where it fell") {
  CHECK(light_at({.dark_share = 0.7}, Vector3::Zero()).share == doctest::Approx(0.3));
  const LeftSkin plain = light_at({}, {0.1, 0.0, 0.2}, 30_deg);
  CHECK(plain.by.norm() == 0.0);
  CHECK(plain.share == 1.0);
  CHECK(plain.spread_m == 0.0);
}

TEST_CASE("hair and sweat cover the share that was said, and a mole some square millimetres") {
  const double hairy =
      share_of_places({.hair_share = 0.1}, [](const LeftSkin& left) { return left.by.y() > 0.0; });
  CHECK(hairy == doctest::Approx(0.1).epsilon(0.1));
  const double wet =
      share_of_places({.sweat_share = 0.1}, [](const LeftSkin& left) { return left.share != 1.0; });
  CHECK(wet == doctest::Approx(0.1).epsilon(0.15));
  const double per_m2 = 200.0;
  const double dark = share_of_places({.moles_per_m2 = per_m2},
                                      [](const LeftSkin& left) { return left.share < 1.0; });
  CHECK(dark > per_m2 * pi * 0.5_mm * 0.5_mm * 0.1);
  CHECK(dark < per_m2 * 40e-6);
}
