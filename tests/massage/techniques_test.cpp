// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "tests/massage/backs.hpp"
#include "tuina/massage/technique/contact_path.hpp"
#include "tuina/massage/technique/knead.hpp"
#include "tuina/massage/technique/press.hpp"
#include "tuina/massage/technique/rub.hpp"
#include "tuina/massage/technique/stroke.hpp"
#include "tuina/massage/technique/tap.hpp"

using namespace tuina;
using namespace tuina::massage;

namespace {

/// What holds for every path: even times, unit normals, no step in place, force or normal, force
/// zero at the ends and never changing faster than the bound.
void check_path(const ContactPath& path, double force_n, double max_n_per_s = max_force_n_per_s) {
  REQUIRE(path.points.size() > 2);
  CHECK(path.points.front().force_n == 0.0);
  CHECK(path.points.back().force_n == 0.0);
  double highest_n = 0.0;
  for (std::size_t i = 0; i < path.points.size(); ++i) {
    const ContactPoint& point = path.points[i];
    REQUIRE(std::abs(point.time_s - sample_s * static_cast<double>(i)) < 1e-9);
    REQUIRE(std::abs(point.normal_in_couch.norm() - 1.0) < 1e-9);
    REQUIRE(point.force_n >= 0.0);
    highest_n = std::max(highest_n, point.force_n);
    if (i == 0) continue;
    const ContactPoint& before = path.points[i - 1];
    REQUIRE(std::abs(point.force_n - before.force_n) <= max_n_per_s * sample_s + 1e-9);
    REQUIRE((point.at_in_couch - before.at_in_couch).norm() <= max_slide_m_per_s * sample_s + 1e-9);
    REQUIRE(point.normal_in_couch.dot(before.normal_in_couch) > 0.999);
  }
  CHECK(highest_n <= force_n + 1e-9);
  CHECK(highest_n > 0.99 * force_n);
}

/// Speeds between neighbouring samples while the force is at its height.
std::pair<double, double> speeds_at_full_force(const ContactPath& path, double force_n) {
  std::pair<double, double> range{1e9, 0.0};
  for (std::size_t i = 1; i < path.points.size(); ++i) {
    if (std::min(path.points[i - 1].force_n, path.points[i].force_n) < force_n - 1e-6) continue;
    const double speed =
        (path.points[i].at_in_couch - path.points[i - 1].at_in_couch).norm() / sample_s;
    range = {std::min(range.first, speed), std::max(range.second, speed)};
  }
  return range;
}

const body::SurfacePoint somewhere{{0.08, 0.1, 0.4}, Vector3::UnitY(), 0.0};

}  // namespace

TEST_CASE("the window of a press is (3.20): half way up after eta/2, full for T, half way down") {
  const PressWindow window{.edge_s = 0.8, .hold_s = 2.0, .steepness = 20.0};
  CHECK(window.at(0.0) == 0.0);
  CHECK(window.at(0.4) == doctest::Approx(0.5));
  CHECK(window.at(0.8) == doctest::Approx(1.0));
  CHECK(window.at(1.8) == 1.0);
  CHECK(window.at(2.8 + 0.4) == doctest::Approx(0.5));
  CHECK(window.at(3.6) == 0.0);
  // With a eta = 20 normalising changes (3.20) by less than 1e-4 anywhere on its edge.
  for (double t = 0.01; t < 0.8; t += 0.01) {
    CHECK(window.at(t) == doctest::Approx(1.0 / (1.0 + std::exp(-25.0 * (t - 0.4)))).epsilon(1e-3));
  }
}

TEST_CASE("the window of a press has no step where its branches meet, however flat the sigmoid") {
  for (const double steepness : {3.0, 6.0, 10.0, 30.0}) {
    const PressWindow window{.edge_s = 0.5, .hold_s = 1.0, .steepness = steepness};
    double before = 0.0;
    double steepest = 0.0;
    for (double t = 0.0; t < 2.2; t += 1e-4) {
      steepest = std::max(steepest, std::abs(window.at(t) - before) / 1e-4);
      before = window.at(t);
    }
    CHECK(steepest == doctest::Approx(window.max_slope_per_s()).epsilon(0.01));
  }
}

TEST_CASE("pressing keeps a light contact between the presses and stays in its place") {
  const ContactPath path = plan_press(somewhere, {.force_n = 25.0, .repeats = 3}, "press BL47_L");
  check_path(path, 25.0);
  int presses = 0;
  for (std::size_t i = 1; i < path.points.size(); ++i) {
    CHECK(path.points[i].at_in_couch == somewhere.at_in_couch);
    presses += path.points[i - 1].force_n < 14.0 && path.points[i].force_n >= 14.0;
    const double t = path.points[i].time_s;
    if (t > landing_s && t < path.duration_s() - landing_s)
      CHECK(path.points[i].force_n >= kept_force_n - 1e-6);
  }
  CHECK(presses == 3);
}

TEST_CASE("a press that is asked to rise too fast takes the time it needs") {
  const PressOptions hasty{.force_n = 45.0, .repeats = 1, .window = {.edge_s = 0.1, .hold_s = 0.5}};
  check_path(plan_press(somewhere, hasty, "hasty"), 45.0);
}

TEST_CASE("tapping beats at its rate, and no tap is stronger than its rate allows") {
  for (const double rate_hz : {1.0, 3.0, 5.0}) {
    const ContactPath path =
        plan_tap(somewhere, {.force_n = 40.0, .rate_hz = rate_hz, .time_s = 4.0}, "tap");
    const double force_n = std::min(40.0, strongest_tap_n(rate_hz));
    check_path(path, force_n, max_tap_n_per_s);
    int taps = 0;
    const double middle_n = 0.5 * (force_n + kept_force_n);
    for (std::size_t i = 1; i < path.points.size(); ++i) {
      taps += path.points[i - 1].force_n < middle_n && path.points[i].force_n >= middle_n;
    }
    CHECK(taps == static_cast<int>(4.0 * rate_hz));
  }
}

TEST_CASE("a rub circle on a wall is (3.21) without a slope: round, closed, walked at one speed") {
  const body::BackSurface back = test::wall();
  const auto circle = circle_on(back, somewhere, 30_mm, Vector3::UnitX(), true);
  REQUIRE(circle.has_value());
  CHECK(circle->length_m() == doctest::Approx(2.0 * pi * 30_mm).epsilon(0.002));
  const ContactPath path = plan_rub(*circle, {.force_n = 15.0, .rate_hz = 0.35, .turns = 4}, "rub");
  check_path(path, 15.0);
  for (const ContactPoint& point : path.points) {
    CHECK((point.at_in_couch - somewhere.at_in_couch).norm() ==
          doctest::Approx(30_mm).epsilon(0.01));
  }
  CHECK((path.points.front().at_in_couch - path.points.back().at_in_couch).norm() < 1e-6);
  const auto [slowest, fastest] = speeds_at_full_force(path, 15.0);
  CHECK(fastest / slowest < 1.001);
  CHECK(fastest == doctest::Approx(0.35 * circle->length_m()).epsilon(0.001));
}

TEST_CASE("a knead circles in its place, lightest where it begins and firmest opposite of it") {
  const body::BackSurface back = test::wall();
  struct Case {
    double radius_m, force_n, rate_hz, given_hz;
  };
  // The third turns slower than asked for by its force, the fourth by its speed along the skin.
  for (const auto& [radius_m, force_n, rate_hz, given_hz] :
       {Case{15_mm, 18.0, 0.8, 0.8}, Case{10_mm, 10.0, 1.25, 1.25},
        Case{10_mm, 45.0, 1.25, 70.0 / (pi * 42.0)}, Case{20_mm, 12.0, 1.25, 0.64},
        Case{12_mm, 3.0, 1.0, 1.0}}) {
    CAPTURE(force_n);
    const auto circle = circle_on(back, somewhere, radius_m, Vector3::UnitX(), true);
    REQUIRE(circle.has_value());
    const KneadOptions options{.force_n = force_n, .rate_hz = rate_hz, .turns = 5};
    CHECK(knead_hz(*circle, options) == doctest::Approx(given_hz).epsilon(0.02));
    const ContactPath path = plan_knead(*circle, options, "knead");
    check_path(path, force_n);
    const double turning_s = path.duration_s() - 2.0 * landing_s;
    CHECK(turning_s == doctest::Approx(5.0 / given_hz + 0.5).epsilon(0.02));
    int swells = 0;
    for (std::size_t i = 1; i < path.points.size(); ++i) {
      const ContactPoint& point = path.points[i];
      const Vector3 aside = point.at_in_couch - somewhere.at_in_couch;
      CHECK(aside.norm() == doctest::Approx(radius_m).epsilon(0.02));
      CHECK(std::abs(aside.y()) < 0.1_mm);
      const double middle_n = 0.5 * (force_n + kept_force_n);
      swells += path.points[i - 1].force_n < middle_n && point.force_n >= middle_n;
      const double landed_s = std::min(point.time_s, path.duration_s() - point.time_s);
      if (landed_s < landing_s + sample_s) {
        CHECK(point.force_n <= kept_force_n + 0.01 * force_n);
        continue;
      }
      // The force belongs to the place: a raised cosine of the angle, also while speed is gained.
      const double expected_n =
          kept_force_n + (force_n - kept_force_n) * 0.5 * (1.0 - aside.x() / aside.norm());
      CHECK(point.force_n == doctest::Approx(expected_n).epsilon(0.01).scale(force_n));
    }
    CHECK(swells == (force_n > kept_force_n ? 5 : swells));
    const Vector3 first = path.points.front().at_in_couch, last = path.points.back().at_in_couch;
    CHECK((first - last).norm() < 0.01_mm);
    // From rest to rest: nothing moves before the tool has landed, nor after the last turn.
    CHECK((path.points[49].at_in_couch - first).norm() < 1e-9);
    CHECK((path.points[path.points.size() - 50].at_in_couch - last).norm() < 0.01_mm);
  }
}

TEST_CASE(
    "a rub circle on a leaning barrel lies on its skin, with even spacing and turning normals") {
  const body::BackSurface back = test::back_of(test::barrel_y, 1_mm);
  const body::SurfacePoint centre = back.nearest({0.1, 0.2, 0.4});
  const auto circle = circle_on(back, centre, 30_mm, Vector3::UnitX(), false);
  REQUIRE(circle.has_value());
  const ContactPath path = plan_rub(*circle, {.force_n = 15.0, .rate_hz = 0.4, .turns = 2}, "rub");
  check_path(path, 15.0);
  for (const ContactPoint& point : path.points) {
    const Vector3& p = point.at_in_couch;
    const Vector3 normal =
        Vector3(p.x() / std::sqrt(0.0625 - p.x() * p.x()), 1.0, 0.17).normalized();
    CHECK(std::abs(p.y() - test::barrel_y(p.x(), p.z())) < 1.5_mm);
    CHECK(point.normal_in_couch.dot(normal) > std::cos(6_deg));
  }
  const auto [slowest, fastest] = speeds_at_full_force(path, 15.0);
  CHECK(fastest / slowest < 1.005);
}

TEST_CASE("clockwise and anticlockwise circles are mirror images on a wall") {
  const body::BackSurface back = test::wall();
  const auto one = circle_on(back, somewhere, 30_mm, Vector3::UnitX(), true);
  const auto other = circle_on(back, somewhere, 30_mm, Vector3::UnitX(), false);
  for (double way = 0.0; way < one->length_m(); way += 10_mm) {
    Vector3 mirrored = one->at(way).at_in_couch;
    mirrored.z() = 2.0 * somewhere.at_in_couch.z() - mirrored.z();
    CHECK((mirrored - other->at(way).at_in_couch).norm() < 0.05_mm);
  }
  // Seen from outside, along -y, x runs to the left: clockwise from x goes up first.
  CHECK(one->at(10_mm).at_in_couch.z() > somewhere.at_in_couch.z());
}

TEST_CASE("a stroke runs through its points from the upper to the lower at one speed") {
  const body::BackSurface back = test::back_of(test::barrel_y, 1_mm);
  const auto seven = test::seven_points(back);
  const std::vector<Vector3> places = {seven[0].at_in_couch, seven[2].at_in_couch,
                                       seven[4].at_in_couch};
  const auto line = line_through(back, places);
  REQUIRE(line.has_value());
  const ContactPath path =
      plan_stroke(*line, {.force_n = 12.0, .speed_m_per_s = 0.06, .repeats = 1}, "stroke");
  check_path(path, 12.0);
  for (const Vector3& place : places) {
    double nearest = 1.0;
    for (const ContactPoint& point : path.points)
      nearest = std::min(nearest, (point.at_in_couch - place).norm());
    CHECK(nearest < 2_mm);
  }
  CHECK(path.points.front().at_in_couch.z() > path.points.back().at_in_couch.z() + 0.2);
  const auto [slowest, fastest] = speeds_at_full_force(path, 12.0);
  CHECK(fastest / slowest < 1.005);
  CHECK(fastest == doctest::Approx(0.06).epsilon(0.005));
}

TEST_CASE("a stroke through places unevenly spaced goes past none of them") {
  const body::BackSurface back = test::wall();
  const auto line = line_through(
      back, std::vector<Vector3>{{0.08, 0.1, 0.5}, {0.08, 0.1, 0.31}, {0.08, 0.1, 0.307}});
  REQUIRE(line.has_value());
  for (double way = 0.0; way <= line->length_m(); way += 1_mm)
    CHECK(line->at(way).at_in_couch.z() > 306.5_mm);
  CHECK(line->length_m() == doctest::Approx(193_mm).epsilon(0.005));
}

TEST_CASE("a stroke bends gently enough for its speed, and one that folds back is refused") {
  const body::BackSurface back = test::wall();
  constexpr double leg_m = 150_mm, max_m_per_s2 = 1.0;
  int refused = 0;
  for (const double second_m : {leg_m, 30_mm})
    for (const double turn : {0_deg, 30_deg, 60_deg, 90_deg, 120_deg, 150_deg, 180_deg}) {
      const Vector3 corner(0.08, 0.1, 0.35);
      const Vector3 on = second_m * Vector3(std::sin(turn), 0.0, -std::cos(turn));
      const auto line = line_through(
          back, std::vector<Vector3>{corner + leg_m * Vector3::UnitZ(), corner, corner + on});
      CAPTURE(turn);
      CAPTURE(second_m);
      if (!line) {
        CHECK(line.error().message.find("place 2") != std::string::npos);
        ++refused;
        continue;
      }
      const ContactPath path = plan_stroke(
          *line, {.force_n = 12.0, .speed_m_per_s = max_slide_m_per_s, .repeats = 1}, "stroke");
      double max_push = 0.0;
      for (std::size_t i = 1; i + 1 < path.points.size(); ++i) {
        const Vector3 push = (path.points[i + 1].at_in_couch - 2.0 * path.points[i].at_in_couch +
                              path.points[i - 1].at_in_couch) /
                             (0.01 * 0.01);
        max_push = std::max(max_push, push.norm());
      }
      CHECK(max_push < max_m_per_s2);
    }
  CHECK(refused == 6);
}

TEST_CASE("a stroke from a place to the same place is refused") {
  const auto line =
      line_through(test::wall(), std::vector<Vector3>{{0.08, 0.1, 0.5}, {0.08, 0.1, 0.5}});
  REQUIRE_FALSE(line.has_value());
}

TEST_CASE("between two strokes the tool slides back lightly, without leaving the skin") {
  const body::BackSurface back = test::wall();
  const auto line = line_through(back, std::vector<Vector3>{{0.08, 0.1, 0.5}, {0.08, 0.1, 0.3}});
  const ContactPath path = plan_stroke(*line, {.force_n = 12.0, .repeats = 3}, "stroke");
  check_path(path, 12.0);
  for (std::size_t i = 1; i < path.points.size(); ++i) {
    const bool upward = path.points[i].at_in_couch.z() > path.points[i - 1].at_in_couch.z() + 1e-6;
    if (upward) CHECK(path.points[i].force_n == doctest::Approx(kept_force_n));
  }
  CHECK(path.points.back().at_in_couch.z() < 0.31);
}

TEST_CASE("paths over a rough scan are smooth to the second derivative") {
  const body::BackSurface back = test::back_of(test::barrel_y, 1_mm);
  const auto circle = circle_on(back, back.nearest({0.1, 0.2, 0.4}), 30_mm, Vector3::UnitX(), true);
  const ContactPath path = plan_rub(*circle, {.rate_hz = 0.4}, "rub");
  // Going round at 75 mm/s with 30 mm radius takes 0.19 m/s2 inwards. Roughness of 1 mm every few
  // millimetres, followed as it is, would take over 5 m/s2.
  double max_acceleration = 0.0;
  double max_step = 0.0;
  Vector3 before = Vector3::Zero();
  for (std::size_t i = 1; i + 1 < path.points.size(); ++i) {
    const Vector3 acceleration =
        (path.points[i - 1].at_in_couch - 2.0 * path.points[i].at_in_couch +
         path.points[i + 1].at_in_couch) /
        (sample_s * sample_s);
    max_acceleration = std::max(max_acceleration, acceleration.norm());
    if (i > 1) max_step = std::max(max_step, (acceleration - before).norm());
    before = acceleration;
  }
  CHECK(max_acceleration < 0.6);
  CHECK(max_step < 0.05);
}

TEST_CASE("a slide too short for its speed goes slower, and every slide arrives") {
  for (const double length_m : {0.001, 0.02, 0.3}) {
    const Slide slide{.length_m = length_m, .speed_m_per_s = 0.06, .ramp_s = 0.5};
    CHECK(slide.way_m(0.0) == 0.0);
    CHECK(slide.way_m(slide.duration_s()) == doctest::Approx(length_m));
    CHECK(slide.way_m(0.5 * slide.duration_s()) == doctest::Approx(0.5 * length_m));
    CHECK(slide.top_speed_m_per_s() <= 0.06);
  }
}

TEST_CASE("a path that leaves the scanned back is refused with the distance") {
  const body::BackSurface back = test::wall();
  const auto line = line_through(back, std::vector<Vector3>{{0.2, 0.1, 0.5}, {0.2, 0.1, 1.1}});
  CHECK(line.has_value());  // places are brought to the rim first
  const auto circle =
      circle_on(back, {{0.4, 0.1, 0.4}, Vector3::UnitY(), 0.0}, 30_mm, Vector3::UnitX(), true);
  REQUIRE_FALSE(circle.has_value());
  CHECK(circle.error().message.find("leaves the scanned back") != std::string::npos);
}

TEST_CASE("a spiral winds outwards at even distance, smooth, and rubs out and in again") {
  const body::BackSurface back = test::wall();
  const auto centre = back.nearest({0.08, 0.1, 0.4});
  const auto spiral = spiral_on(back, centre, 35_mm, Vector3::UnitX(), false);
  REQUIRE(spiral.has_value());
  // The length of an Archimedean spiral whose windings are 9 mm apart, from 6 to 35 mm.
  const double expected_m = pi * (35_mm * 35_mm - 6_mm * 6_mm) / 9_mm;
  CHECK(spiral->length_m() == doctest::Approx(expected_m).epsilon(0.05));
  double before_m = 0.0;
  for (double way_m = 0.0; way_m < spiral->length_m(); way_m += 20_mm) {
    const double radius_m = (spiral->at(way_m).at_in_couch - centre.at_in_couch).norm();
    CHECK(radius_m > before_m);
    before_m = radius_m;
  }
  const ContactPath path =
      plan_rub(*spiral, {.force_n = 12.0, .rate_hz = 0.3, .turns = 2, .radius_m = 35_mm}, "rub");
  const Vector3 first = path.points.front().at_in_couch, last = path.points.back().at_in_couch;
  CHECK((first - last).norm() < 1_mm);
  double max_speed_m_per_s = 0.0;
  for (std::size_t i = 1; i < path.points.size(); ++i) {
    const double moved_m = (path.points[i].at_in_couch - path.points[i - 1].at_in_couch).norm();
    max_speed_m_per_s = std::max(max_speed_m_per_s, moved_m / sample_s);
    CHECK(std::abs(path.points[i].force_n - path.points[i - 1].force_n) / sample_s <=
          1.001 * max_force_n_per_s);
  }
  CHECK(max_speed_m_per_s < 1.01 * 2.0 * pi * 35_mm * 0.3);
}
