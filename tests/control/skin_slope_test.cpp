// SPDX-License-Identifier: Apache-2.0
#include "tuina/control/skin_slope.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <functional>

#include "tuina/core/units.hpp"

using namespace tuina;
using control::SkinSlope;

namespace {

// A tool on a circle of 30 mm, once around in 2 s, believed to lie in the plane of x and y. The
// skin there is a cylinder of 0.3 m radius that leans by 3 degrees. Every millisecond `look` gets
// the time, what is learned and the true rise.
using Look = std::function<void(double, const SkinSlope&, const Vector3&)>;

void rub(double duration_s, double breath_m, double grain_m_per_s, const Look& look) {
  SkinSlope slope;
  slope.begin(Vector3::UnitZ());
  constexpr double dt_s = 1e-3, radius_m = 30_mm, bend_m = 0.3;
  for (double t = 0.0; t < duration_s; t += dt_s) {
    const Vector3 at(radius_m - radius_m * std::cos(pi * t), radius_m * std::sin(pi * t), 0.0);
    Vector3 velocity(radius_m * pi * std::sin(pi * t), radius_m * pi * std::cos(pi * t), 0.0);
    const Vector3 rise(-at.x() / bend_m, std::tan(3_deg), 0.0);
    velocity.z() = rise.dot(velocity) + 0.5 * pi * 0.5 * breath_m * std::cos(0.5 * pi * t) +
                   grain_m_per_s * std::sin(2.0 * pi * 6.0 * t);
    slope.learn(velocity, Vector3::UnitZ(), 0.0, dt_s);
    look(t, slope, rise);
  }
}

}  // namespace

TEST_CASE("a tool that goes round learns how the skin leans and bends, along its way and across") {
  double worst = 0.0, unlearned = 0.0;
  rub(4.0, 3_mm, 5e-3, [&](double t, const SkinSlope& slope, const Vector3& rise) {
    if (t < 2.0) return;
    worst = std::max(worst, (slope.rise_in_base() - rise).norm());
    unlearned = std::max(unlearned, rise.norm());
    CHECK(slope.normal_in_base().dot(Vector3(-rise.x(), -rise.y(), 1.0).normalized()) > 0.998);
  });
  CHECK(unlearned > 0.2);
  CHECK(worst < unlearned / 3.0);
}

TEST_CASE("skin that rises under a tool that rests is no slope") {
  SkinSlope slope;
  slope.begin(Vector3::UnitZ());
  for (int i = 0; i < 5000; ++i)
    slope.learn(Vector3(5e-3, 0.0, 0.024 * std::cos(0.5 * pi * 1e-3 * i)), Vector3::UnitZ(), 0.0,
                1e-3);
  CHECK(slope.rise_in_base().norm() == 0.0);
}

TEST_CASE("tissue that yields to a force that grows on the way is no slope") {
  const auto learned = [](double deepening_m_per_s) {
    SkinSlope slope;
    slope.begin(Vector3::UnitZ());
    // The tissue yields by half more than believed.
    for (int i = 0; i < 1000; ++i)
      slope.learn(Vector3(0.05, 0.0, -6e-3), Vector3::UnitZ(), deepening_m_per_s, 1e-3);
    return slope.rise_in_base().norm();
  };
  CHECK(learned(4e-3) < 0.2 * learned(0.0));
}

TEST_CASE("a person who moves away is no steep slope, and a new contact begins with none") {
  SkinSlope slope;
  slope.begin(Vector3::UnitZ());
  for (int i = 0; i < 1000; ++i) slope.learn(Vector3(0.05, 0.0, -0.5), Vector3::UnitZ(), 0.0, 1e-3);
  CHECK(slope.rise_in_base().norm() <= 0.3 + 1e-9);
  slope.begin(Vector3::UnitX());
  CHECK(slope.rise_in_base().norm() == 0.0);
  CHECK((slope.normal_in_base() - Vector3::UnitX()).norm() < 1e-12);
}
