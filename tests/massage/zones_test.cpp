// SPDX-License-Identifier: Apache-2.0
#include "tuina/massage/zones.hpp"

#include <doctest/doctest.h>

#include <Eigen/Geometry>

#include "tests/massage/backs.hpp"
#include "tests/reason.hpp"

using namespace tuina;
using namespace tuina::massage;

namespace {

struct Man {
  explicit Man(double uncertainty_m = 0.0)
      : points(test::seven_points(test::wall(), uncertainty_m)),
        landmarks(test::landmarks_of_a_man()),
        chart(BackChart::from(points, landmarks).value()),
        zones(chart, points, landmarks) {}
  std::vector<Acupoint> points;
  std::vector<Landmark> landmarks;
  BackChart chart;
  ZoneMap zones;
};

}  // namespace

TEST_CASE("each part of a back is the zone that an anatomist would name") {
  const Man man;
  const auto zone = [&](double x, double z) { return man.zones.at(Vector3(x, 0.1, z)); };
  CHECK(zone(0.0, 0.45) == Zone::spine);
  CHECK(zone(0.014, 0.60) == Zone::spine);
  CHECK(zone(0.0, 0.28) == Zone::gv4);
  CHECK(zone(0.0, 0.26) == Zone::spine);
  CHECK(zone(-0.025, 0.45) == Zone::spine_margin);
  CHECK(zone(0.05, 0.45) == Zone::muscle);
  CHECK(zone(0.08, 0.34) == Zone::kidney);
  CHECK(zone(-0.08, 0.34) == Zone::kidney);
  CHECK(zone(0.09, 0.54) == Zone::scapula_edge);
  CHECK(zone(-0.135, 0.58) == Zone::scapula_edge);
  CHECK(zone(0.12, 0.55) == Zone::muscle);
  CHECK(zone(0.12, 0.42) == Zone::ribs);
  CHECK(zone(0.04, 0.165) == Zone::iliac_crest);
  CHECK(zone(0.0, 0.68) == Zone::neck);
  CHECK(zone(0.05, 0.645) == Zone::neck);
  CHECK(zone(0.2, 0.45) == Zone::outside);
  CHECK(zone(0.05, 0.15) == Zone::outside);
}

TEST_CASE("the caps are below what the zones may feel, and only muscle may be tapped") {
  for (std::size_t i = 0; i < zone_rules.size(); ++i) {
    const Zone zone = static_cast<Zone>(i);
    CAPTURE(name_of(zone));
    CHECK(rule_of(zone).cap_n < rule_of(zone).trip_n);
    CHECK(cap_n(zone, Technique::press) <= std::max(0.0, rule_of(zone).cap_n - 2.0));
    CHECK((cap_n(zone, Technique::tap) > 0.0) == (zone == Zone::muscle));
    CHECK((cap_n(zone, Technique::knead) > 0.0) == rule_of(zone).sliding);
    for (const Technique technique : all_techniques) {
      CHECK(cap_n(zone, technique) <= cap_n(zone, Technique::press));
    }
  }
  CHECK(cap_n(Zone::gv4, Technique::press) == 8.0);
  CHECK(cap_n(Zone::gv4, Technique::rub) == 0.0);
  CHECK(cap_n(Zone::gv4, Technique::knead) == 0.0);
  CHECK(cap_n(Zone::kidney, Technique::knead) == 17.0);
  CHECK(cap_n(Zone::spine, Technique::press) == 0.0);
}

TEST_CASE("the less certain the points, the lower the cap of a place, never the higher") {
  const Man certain;
  const Man uncertain(15_mm);
  int stricter = 0;
  for (double x = -0.2; x <= 0.2; x += 5_mm) {
    for (double z = 0.14; z <= 0.7; z += 5_mm) {
      const double before = cap_n(certain.zones.at(Vector3(x, 0.1, z)), Technique::press);
      const double after = cap_n(uncertain.zones.at(Vector3(x, 0.1, z)), Technique::press);
      CAPTURE(x);
      CAPTURE(z);
      CHECK(after <= before);
      stricter += after < before;
    }
  }
  CHECK(stricter > 100);
}

TEST_CASE("the spine is ruled out further from the midline the less certain the points are") {
  const auto doubtful_to_m = [](double uncertainty_m) {
    const Man man(uncertainty_m);
    double beside_m = 0.0;
    while (man.zones.perhaps_spine(Vector3(beside_m, 0.1, 0.45))) beside_m += 0.5_mm;
    // Always beyond the band that is denied.
    CHECK(man.zones.at(Vector3(beside_m, 0.1, 0.45)) != Zone::spine);
    return beside_m;
  };
  CHECK(doubtful_to_m(0.0) > 20_mm);
  CHECK(doubtful_to_m(8_mm) > 26_mm);
  CHECK(doubtful_to_m(8_mm) < 30_mm);
  CHECK(doubtful_to_m(16_mm) > 36_mm);
  // GV4 itself is certain only where the points are.
  CHECK_FALSE(Man(0.0).zones.perhaps_spine(Vector3(0.0, 0.1, 0.28)));
  CHECK(Man(8_mm).zones.perhaps_spine(Vector3(0.0, 0.1, 0.28)));
}

TEST_CASE("the borders of sacrum and kidney are as unsure as the points beside them") {
  // How far up the back stays outside beside the sacrum, and how far down the kidney reaches.
  const auto borders_m = [](double sacral_m, double lumbar_m) {
    Man man;
    man.points.push_back({"GV2", {0.0, 0.1, 0.1}, Vector3::UnitY(), sacral_m});
    man.points.push_back({"GV3", {0.0, 0.1, 0.25}, Vector3::UnitY(), lumbar_m});
    const ZoneMap zones(man.chart, man.points, man.landmarks);
    double outside_m = 0.0, kidney_m = 0.4;
    while (zones.at(Vector3(0.06, 0.1, outside_m)) == Zone::outside) outside_m += 0.5_mm;
    while (kidney_m > 0.0 && zones.at(Vector3(0.06, 0.1, kidney_m)) != Zone::kidney)
      kidney_m -= 0.5_mm;
    while (zones.at(Vector3(0.06, 0.1, kidney_m)) == Zone::kidney) kidney_m -= 0.5_mm;
    return std::pair(outside_m, kidney_m);
  };
  const auto [sacrum_m, kidney_m] = borders_m(0.0, 0.0);
  CHECK(borders_m(20_mm, 0.0).first > sacrum_m + 10_mm);
  CHECK(borders_m(20_mm, 0.0).second == kidney_m);
  CHECK(borders_m(0.0, 20_mm).second < kidney_m - 5_mm);
}

TEST_CASE("zones belong to the person: they turn, lean and lie down with the back") {
  const Man upright;
  for (const double turn : {0.2, -0.2}) {
    // Sat down askew and bent forward; and prone with the head at either end of the bed.
    for (const Eigen::AngleAxisd& tilt : {Eigen::AngleAxisd(0.3, Vector3::UnitX()),
                                          Eigen::AngleAxisd(0.5 * pi, Vector3::UnitX())}) {
      for (const double end : {0.0, pi}) {
        const Transform moved_from_upright = Eigen::Translation3d(0.07, -0.04, 0.02) *
                                             Eigen::AngleAxisd(turn + end, Vector3::UnitZ()) * tilt;
        Man moved;
        for (Acupoint& point : moved.points)
          point.at_in_couch = moved_from_upright * point.at_in_couch;
        for (Landmark& mark : moved.landmarks)
          mark.at_in_couch = moved_from_upright * mark.at_in_couch;
        moved.chart = BackChart::from(moved.points, moved.landmarks).value();
        const ZoneMap zones(moved.chart, moved.points, moved.landmarks);
        for (double x = -0.1803; x <= 0.18; x += 11_mm) {
          for (double z = 0.1507; z <= 0.7; z += 11_mm) {
            const Vector3 place(x, 0.1, z);
            REQUIRE(zones.at(moved_from_upright * place) == upright.zones.at(place));
          }
        }
      }
    }
  }
}

TEST_CASE(
    "guides are moved off the spine to their own side, off the neck, and stay where they may be") {
  const Man man(8_mm);
  for (const double side : {1.0, -1.0}) {
    for (double x = -0.3; x <= 0.3; x += 7_mm) {
      for (double z = 0.1; z <= 0.8; z += 7_mm) {
        const Vector3 guide(x, 0.1, z);
        const Zone zone = man.zones.at(man.zones.around_denied(guide, side));
        CHECK(cap_n(zone, Technique::stroke) > 0.0);
        CHECK(man.zones.around_denied(guide, side).x() * side > 0.0);
      }
    }
  }
  const Vector3 good(0.06, 0.1, 0.4);
  CHECK((man.zones.around_denied(good, 1.0) - good).norm() < 1e-12);
}

TEST_CASE("without landmarks the seven points are enough to know spine, kidneys and neck") {
  const Man man;
  const BackChart chart = BackChart::from(man.points, {}).value();
  const ZoneMap zones(chart, man.points, {});
  CHECK(zones.at(Vector3(0.0, 0.1, 0.45)) == Zone::spine);
  CHECK(zones.at(Vector3(0.0, 0.1, 0.28)) == Zone::gv4);
  CHECK(zones.at(Vector3(0.08, 0.1, 0.34)) == Zone::kidney);
  CHECK(zones.at(Vector3(0.0, 0.1, 0.75)) == Zone::neck);
  CHECK(chart.up_of(Level::T12) == doctest::Approx(man.chart.up_of(Level::T12)).epsilon(0.3));
}

TEST_CASE("points that cannot be those of a back are refused with the reason") {
  Man man;
  auto few = man.points;
  few.erase(few.begin() + 2);
  CHECK(BackChart::from(few, {}).error().message.find("lack BL47_L") != std::string::npos);
  auto millimetres = man.points;
  for (Acupoint& point : millimetres) point.at_in_couch *= 1000.0;
  CHECK(BackChart::from(millimetres, {}).error().message.find("not those of a back") !=
        std::string::npos);
  auto swapped = man.points;
  for (Acupoint& point : swapped) {
    if (point.name.starts_with("BL")) point.at_in_couch.x() *= -1.0;
  }
  CHECK_FALSE(BackChart::from(swapped, {}).has_value());
  auto spine = man.landmarks;
  std::swap(spine[1].at_in_couch, spine[4].at_in_couch);  // T3 and T12
  CHECK_FALSE(BackChart::from(man.points, spine).has_value());
}

TEST_CASE("a place that was shown three times is ruled out as far as a tool reaches") {
  const Man man;
  const Vector3 there(0.05, 0.1, 0.4);
  const std::vector<NoGo> no_go = {{.name = "mole", .corners_in_couch = {there, there, there}},
                                   {.name = "nothing", .corners_in_couch = {}}};
  const ZoneMap zones(man.chart, man.points, man.landmarks, no_go);
  CHECK(man.zones.at(there) == Zone::muscle);
  CHECK(zones.at(there) == Zone::no_go);
  CHECK(zones.at(there + Vector3(0.01, 0.0, 0.0)) == Zone::no_go);
  CHECK(zones.at(there + Vector3(0.04, 0.0, 0.0)) == Zone::muscle);
}

TEST_CASE("a no-go file says what is ruled out, or every line that is wrong with it") {
  const auto good = parse_no_go(
      "[[no_go]]\nname = \"bruise\"\ncorners_m = [[0.05, 0.1, 0.3], [0.1, 0.1, 0.3], [0.1, 0.1, "
      "0.4]]\n",
      "no_go.toml");
  REQUIRE_MESSAGE(good.has_value(), test::reason(good));
  CHECK(good->front().name == "bruise");
  CHECK(good->front().corners_in_couch.size() == 3);

  const auto bad = parse_no_go(
      "[[no_go]]\nname = \"a\"\ncorners_m = [[50, 100, 300], [0, 0, 0], [0, 0]]\n[[no_go]]\n"
      "corner = 1\n",
      "no_go.toml");
  REQUIRE_FALSE(bad.has_value());
  CAPTURE(bad.error().message);
  for (const char* what : {"no_go.toml:3: a corner", "no_go.toml:4: a no_go needs a name",
                           "no_go.toml:5: no_go has no `corner`"}) {
    CHECK(bad.error().message.find(what) != std::string::npos);
  }
  CHECK_FALSE(parse_no_go("", "no_go.toml").has_value());
  const auto crossed = parse_no_go(
      "[[no_go]]\nname = \"scar\"\n"
      "corners_m = [[0.0, 0.1, 0.3], [0.1, 0.12, 0.4], [0.1, 0.1, 0.3], [0.0, 0.11, 0.4]]\n",
      "no_go.toml");
  REQUIRE_FALSE(crossed.has_value());
  CHECK(crossed.error().message ==
        "no_go.toml:3: sides of the outline cross; give its corners in their order");
  CHECK(parse_no_go("[[no_go]]\nname = \"scar\"\ncorners_m = [[0.0, 0.1, 0.3], [0.1, 0.12, 0.3], "
                    "[0.1, 0.1, 0.4], [0.05, 0.1, 0.32], [0.0, 0.11, 0.4]]\n",
                    "no_go.toml")
            .has_value());
}
