// SPDX-License-Identifier: Apache-2.0
// The law that holds a force, and the escape from somebody who comes closer.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tuina/control/force_target.hpp"
#include "tuina/core/random.hpp"
#include "tuina/core/units.hpp"

using namespace tuina;
using namespace tuina::control;

TEST_CASE("the virtual target never pulls harder than the set force and its leash") {
  Random random = make_random(3, "leash");
  ForceTarget::Options options;
  ForceTarget law(options);
  law.begin({.force_n = 1.5}, 1.5);
  double set_n = 1.5;
  for (int i = 0; i < 20000; ++i) {
    if (i % 200 == 0) set_n = uniform(random, 0.0, 60.0);
    const double force = law.step({.depth_m = uniform(random, -0.1, 0.1),
                                   .force_n = uniform(random, -5.0, 100.0),
                                   .set_force_n = set_n},
                                  1e-3);
    REQUIRE(law.spring_n() <= law.set_n() + options.max_over_set_n + 1e-9);
    REQUIRE(force <= law.set_n() + options.max_over_set_n + options.max_outward_damping_n + 1e-9);
    REQUIRE(std::abs(law.skin_error_m()) <= options.max_skin_rise_m);
  }
}

TEST_CASE("contact that was lost and found again may be missed for six ticks anew") {
  ForceTarget law;
  law.begin({.force_n = 10.0}, 10.0);
  const auto feel = [&law](double force_n, int ticks) {
    for (int i = 0; i < ticks; ++i)
      (void)law.step({.depth_m = 4e-3, .force_n = force_n, .set_force_n = 10.0}, 1e-3);
    return law.lost();
  };
  CHECK_FALSE(feel(10.0, 100));
  CHECK_FALSE(feel(0.0, 6));
  CHECK(feel(0.0, 1));
  CHECK_FALSE(feel(3.2, 1));
  CHECK_FALSE(feel(0.0, 6));
  CHECK(feel(0.0, 1));
}

TEST_CASE("a force that leaps above the set one is answered outward at once, a slow one is not") {
  ForceTarget law;
  law.begin({.force_n = 1.5}, 1.5);
  double force_n = 1.5;
  for (int i = 0; i < 4000; ++i) {  // a press up to 30 N, five of which are the controller's own
    force_n = std::min(30.0, 1.5 + 25e-3 * i);
    (void)law.step({.depth_m = 4e-3, .force_n = force_n + 5.0, .set_force_n = force_n}, 1e-3);
    REQUIRE_FALSE(law.lost());
  }
  int ticks = 0;
  double push_n = 0.0;
  for (; push_n >= 0.0 && ticks < 100; ++ticks) {
    force_n += 2.0;
    push_n = law.step({.depth_m = 4e-3, .force_n = force_n, .set_force_n = 30.0}, 1e-3);
  }
  CHECK(ticks <= 3);
  CHECK(push_n == doctest::Approx(-Escape::Options().push_out_n));
  for (; force_n > 0.0; force_n -= 2.0)
    push_n = law.step({.depth_m = 4e-3, .force_n = force_n, .set_force_n = 30.0}, 1e-3);
  CHECK(law.pushed_away());
  CHECK(std::abs(push_n) < 5.0);
}

TEST_CASE(
    "whoever pushes the tool out is pressed less the harder they push, whatever it is damped by") {
  ForceTarget law;
  law.begin({.force_n = 3.0}, 3.0);
  // A cough: the force rises too gently for somebody who starts up.
  for (int i = 0; i < 200; ++i) {
    const double felt_n = std::min(3.0 + 0.06 * i, 14.0);
    const double inward_n = law.step(
        {.depth_m = 4e-3 - 5e-5 * i, .speed_m_per_s = -0.05, .force_n = felt_n, .set_force_n = 3.0},
        1e-3);
    CAPTURE(felt_n);
    CHECK(inward_n <= std::max(3.0 + 20.0 - 2.0 * (felt_n - 3.0), 0.0) + 1e-9);
  }
}

TEST_CASE("where a place bears little more, less force is a person who comes closer") {
  // How much more than 13 N is felt as the tool begins to push itself out.
  const auto startled_n = [](double bears_n, double startle_n) {
    ForceTarget::Options options;
    options.escape.startle_n = startle_n;
    ForceTarget law(options);
    law.begin({.depth_m = 4e-3, .force_n = 1.5, .set_force_n = 13.0, .max_spring_n = bears_n}, 1.5);
    double more_n = 0.0, push_n = 0.0;
    for (int i = 0; i < 2000; ++i) {
      const double force_n = std::min(13.0, 1.5 + 25e-3 * i);
      (void)law.step(
          {.depth_m = 4e-3, .force_n = force_n, .set_force_n = 13.0, .max_spring_n = bears_n},
          1e-3);
    }
    for (; more_n < 30.0 && push_n > -50.0; more_n += 0.02)
      push_n = law.step(
          {.depth_m = 4e-3, .force_n = 13.0 + more_n, .set_force_n = 13.0, .max_spring_n = bears_n},
          1e-3);
    return more_n;
  };
  const double lead_n = 0.4;  // of the rise, 20 N/s
  CHECK(startled_n(60.0, 16.0) == doctest::Approx(16.0 - lead_n).epsilon(0.01));
  CHECK(startled_n(25.0, 16.0) == doctest::Approx(0.8 * 12.0 - lead_n).epsilon(0.01));
  CHECK(startled_n(15.0, 16.0) == doctest::Approx(6.0 - lead_n).epsilon(0.01));
  CHECK(startled_n(25.0, 5.0) == doctest::Approx(5.0 - lead_n).epsilon(0.02));
  CHECK(startled_n(25.0, std::numeric_limits<double>::infinity()) >= 30.0);
}

TEST_CASE(
    "an escape begins where the rise of a force leads, and ends once the force is nearly gone") {
  const auto ticks_until = [](double n_per_ms, double expected_n) {
    Escape escape;
    escape.begin(expected_n);
    double force_n = expected_n;
    for (int ticks = 0; ticks < 1000; ++ticks) {
      if (escape.step(force_n, {expected_n, 0.0}, 1e-3)) return ticks;
      force_n += n_per_ms;
    }
    return 1000;
  };
  for (const double expected_n : {0.0, 20.0}) {
    CHECK(ticks_until(0.1, expected_n) == doctest::Approx((16.0 - 2.0) / 0.1).epsilon(0.03));
    CHECK(ticks_until(0.05, expected_n) == doctest::Approx((16.0 - 1.0) / 0.05).epsilon(0.03));
  }
  CHECK(ticks_until(4.0, 20.0) == 1);
  CHECK(ticks_until(4.0, 0.0) == 2);  // 4 N are to be felt
  CHECK(ticks_until(-1.0, 20.0) == 1000);
  Escape escape;
  escape.begin(0.0);
  double force_n = 0.0;
  while (!escape.step(force_n, {}, 1e-3)) force_n += 5.0;
  CHECK(escape.startled());
  CHECK_FALSE(escape.over());
  for (int i = 0; i < 50; ++i) CHECK(escape.step(30.0, {}, 1e-3));  // as long as it is pressed
  for (force_n = 30.0; force_n > -10.0 && escape.step(force_n, {}, 1e-3);) force_n -= 3.0;
  CHECK(force_n > 0.0);  // sensors lag: it ends before nothing is felt
  CHECK(escape.over());
  CHECK_FALSE(escape.step(60.0, {}, 1e-3));  // whoever wants another begins anew
}

TEST_CASE("an arm that swings in the air with 2 N is nobody who comes closer") {
  Escape escape;
  escape.begin(0.0);
  bool pushes = false;
  for (int i = 0; i < 500; ++i)
    pushes = pushes || escape.step(2.0 * std::sin(2.0 * pi * 80.0 * 1e-3 * i), {}, 1e-3);
  CHECK_FALSE(pushes);
}

TEST_CASE("the push of an escape fades as the tool leaves") {
  const Escape escape;
  const Escape::Options options;
  CHECK(escape.push_n(-1.0) == options.push_out_n);
  CHECK(escape.push_n(options.full_push_m_per_s) == doctest::Approx(options.push_out_n));
  CHECK(escape.push_n(0.5 * (options.full_push_m_per_s + options.max_m_per_s)) ==
        doctest::Approx(0.5 * options.push_out_n));
  CHECK(escape.push_n(options.max_m_per_s) == 0.0);
  CHECK(escape.push_n(2.0) == 0.0);
}

TEST_CASE("a fast landing is nobody who comes closer, the same rise under a tool at rest is") {
  // The tool lands with 0.09 m/s on skin that is some millimetres higher than believed.
  for (const bool lands : {true, false}) {
    ForceTarget law;
    const ContactModel model;
    constexpr double m_per_s = 0.09;
    double force_n = 1.5;
    law.begin({.force_n = force_n}, force_n);
    while (force_n < 15.0) {
      force_n += 1e-3 * m_per_s * stiffness_at(model, force_n);
      (void)law.step({.depth_m = depth_at(model, force_n),
                      .speed_m_per_s = lands ? m_per_s : 0.0,
                      .force_n = force_n,
                      .set_force_n = 10.0},
                     1e-3);
    }
    CHECK((law.spring_n() < -50.0) == !lands);
  }
}

TEST_CASE("the speed of skin that rises and falls under the tool is no motion to damp") {
  const auto worst_error_n = [](double carried_after_s) {
    ForceTarget::Options options;
    options.carried_after_s = carried_after_s;
    ForceTarget law(options);
    law.begin({.force_n = 1.5}, 1.5);
    constexpr double set_n = 20.0, mass_kg = 3.5, dt_s = 1e-3;
    const double skin_n_per_m = stiffness_at({}, set_n);
    double depth_m = 1.5 / skin_n_per_m, m_per_s = 0.0, worst_n = 0.0;
    for (int i = 0; i < 7000; ++i) {
      const double rises_m = 1.5e-3 * (1.0 - std::cos(pi * i * dt_s));
      const double force_n = std::max(0.0, skin_n_per_m * (depth_m + rises_m));
      if (i > 3000) worst_n = std::max(worst_n, std::abs(force_n - set_n));
      const double push_n = law.step({depth_m, m_per_s, 0.0, 0.0, force_n, set_n, mass_kg}, dt_s);
      m_per_s += dt_s / mass_kg * (push_n - force_n);
      depth_m += dt_s * m_per_s;
    }
    return worst_n;
  };
  CHECK(worst_error_n(ForceTarget::Options().carried_after_s) < 0.85 * worst_error_n(1e6));
}

TEST_CASE("changes of the target can put in no more energy than the tank holds") {
  ForceTarget law;
  law.begin({.force_n = 1.5}, 1.5);
  // A skin that gives way wherever the tool pushes would take energy for ever.
  double depth_m = 0.0;
  for (int i = 0; i < 5000; ++i) {
    (void)law.step({.depth_m = depth_m, .force_n = 5.0, .set_force_n = 40.0}, 1e-3);
    depth_m += 1e-4;
    REQUIRE(law.tank_j() >= 0.0);
  }
  CHECK(law.spring_n() < 5.0);
}

TEST_CASE("bone that rises by 0.3 mm against a tool that cannot give way doubles a force of 30 N") {
  const ContactModel bone = {.tissue = {.alpha_n = 4.559, .beta_per_m = 263.2},
                             .torso_n_per_m = std::numeric_limits<double>::infinity()};
  CHECK(depth_at(bone, 60.0) - depth_at(bone, 30.0) < 0.3_mm);
}
