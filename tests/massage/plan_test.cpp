// SPDX-License-Identifier: Apache-2.0
#include "tuina/massage/plan.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "tests/massage/backs.hpp"
#include "tests/reason.hpp"
#include "tuina/massage/technique/contact_path.hpp"

using namespace tuina;
using namespace tuina::massage;

namespace {

struct Person {
  explicit Person(double uncertainty_m = 8_mm)
      : back(test::back_of(test::barrel_y, 0.7_mm)),
        points(test::seven_points(back, uncertainty_m)) {}
  body::BackSurface back;
  std::vector<Acupoint> points;
};

Programme programme_of(const std::string& parts) {
  return parse_programme("name = \"test\"\n" + parts, "test.toml").value();
}

bool noted(const Plan& plan, const char* what) {
  return std::any_of(plan.notes.begin(), plan.notes.end(), [&](const Sentence& note) {
    return note.words.find(what) != std::string::npos;
  });
}

}  // namespace

TEST_CASE("every shipped programme fits on a back, with both arms, within its caps and bounds") {
  const Person person;
  for (const ShippedProgramme& shipped : shipped_programmes()) {
    CAPTURE(shipped.name);
    const Programme programme = load_programme(std::string(shipped.name)).value();
    std::vector<Acupoint> points = person.points;
    for (const Acupoint& point : test::inner_points(person.back, 8_mm)) points.push_back(point);
    const auto plan = massage::plan(person.back, points, {}, programme);
    REQUIRE_MESSAGE(plan.has_value(), test::reason(plan));
    const bool whole_back = shipped.name == "full_back_20min";
    CHECK(plan->duration_s > (whole_back ? 900.0 : 40.0));
    CHECK(plan->duration_s < (whole_back ? 1400.0 : 240.0));
    CHECK(plan->min_tool_distance_m >= closest_tools_m);
    std::set<Arm> arms;
    const BackChart chart = BackChart::from(person.points, {}).value();
    const ZoneMap zones(chart, person.points, {});
    for (const PlannedPath& planned : plan->paths) {
      CAPTURE(planned.path.name);
      arms.insert(planned.arm);
      CHECK(planned.cap_n <= rule_of(planned.zone).cap_n);
      const ContactPoint* before = nullptr;
      for (const ContactPoint& point : planned.path.points) {
        REQUIRE(point.at_in_couch.allFinite());
        REQUIRE(point.force_n <= planned.cap_n + 1e-9);
        REQUIRE(point.force_n <= cap_n(zones.at(point.at_in_couch), planned.path.technique) + 1e-9);
        REQUIRE(std::abs(point.normal_in_couch.norm() - 1.0) < 1e-9);
        if (before != nullptr) {
          REQUIRE(std::abs(point.force_n - before->force_n) <= max_force_n_per_s * sample_s);
          REQUIRE((point.at_in_couch - before->at_in_couch).norm() <=
                  max_slide_m_per_s * sample_s + 1e-9);
          REQUIRE(point.normal_in_couch.dot(before->normal_in_couch) > 0.99);
        }
        before = &point;
      }
      CHECK(planned.path.duration_s() <= rule_of(planned.zone).max_duration_s);
    }
    CHECK(arms.size() == 2);
  }
}

TEST_CASE("the relaxing programme presses all seven points, rubs and strokes") {
  const Person person;
  const auto plan = massage::plan(person.back, person.points, {}, load_programme("relax").value());
  std::set<std::string> pressed;
  std::set<Technique> techniques;
  for (const PlannedPath& planned : plan->paths) {
    techniques.insert(planned.path.technique);
    if (planned.path.technique == Technique::press) pressed.insert(planned.path.acupoints.at(0));
  }
  CHECK(pressed.size() == seven_acupoints.size());
  CHECK(techniques == std::set<Technique>{Technique::press, Technique::rub, Technique::stroke});
  CHECK(plan->duration_s > 60.0);
  CHECK(plan->duration_s < 120.0);
}

TEST_CASE("one plan is one plan: the same back and programme give the same numbers") {
  const Person person;
  const Programme relax = load_programme("relax").value();
  const auto one = massage::plan(person.back, person.points, {}, relax);
  const auto two = massage::plan(person.back, person.points, {}, relax);
  REQUIRE(one->paths.size() == two->paths.size());
  for (std::size_t i = 0; i < one->paths.size(); ++i) {
    CHECK(one->paths[i].start_s == two->paths[i].start_s);
    CHECK(one->paths[i].path.points.back().at_in_couch ==
          two->paths[i].path.points.back().at_in_couch);
  }
}

TEST_CASE(
    "the two sides are served together by the arm of their side, the middle by one arm alone") {
  const Person person;
  const auto plan =
      massage::plan(person.back, person.points, {}, load_programme("demonstration").value());
  for (const PlannedPath& planned : plan->paths) {
    const auto partners =
        std::count_if(plan->paths.begin(), plan->paths.end(),
                      [&](const PlannedPath& other) { return other.step == planned.step; });
    const bool middle = planned.path.acupoints.at(0) == "GV4";
    // The circles reach inwards to 100 mm of each other, too close for two arms.
    const bool alone = middle || (planned.path.technique == Technique::rub &&
                                  planned.path.acupoints.at(0).starts_with("BL"));
    CHECK(partners == (alone ? 1 : 2));
    if (middle) continue;
    const bool left = planned.path.acupoints.at(0).ends_with("_L");
    CHECK(planned.arm == (left ? Arm::left : Arm::right));
  }
}

TEST_CASE("hand after hand: the sides take turns, one press, turn or stroke each") {
  const Person person;
  for (const char* part : {"technique = \"press\"\npoints = [\"BL47\"]\n",
                           "technique = \"rub\"\npoints = [\"BL47\"]\n",
                           "technique = \"stroke\"\npoints = [\"BL47\", \"BL50\"]\n"}) {
    CAPTURE(part);
    const auto plan = massage::plan(
        person.back, person.points, {},
        programme_of(fmt::format("[[part]]\n{}alternating = true\nrepeats = 3\n", part)));
    REQUIRE_MESSAGE(plan.has_value(), test::reason(plan));
    REQUIRE(plan->paths.size() == 6);
    for (std::size_t i = 0; i < 6; ++i) {
      CHECK(plan->paths[i].arm == (i % 2 == 0 ? Arm::left : Arm::right));
      CHECK(plan->paths[i].step == static_cast<int>(i));
      CHECK(plan->paths[i].path.duration_s() == plan->paths[0].path.duration_s());
    }
    const auto at_once = massage::plan(
        person.back, person.points, {},
        programme_of(fmt::format("[[part]]\n{}together = false\nrepeats = 3\n", part)));
    CHECK(at_once->paths.size() == 2);
  }
}

TEST_CASE("hand over hand: one hand takes over before the other leaves, and they stay apart") {
  const Person person;
  const char* part =
      "[[part]]\ntechnique = \"stroke\"\nline = \"bladder_outer\"\nforce_n = 12\n"
      "hand_over_hand = true\nrepeats = 3\n";
  const auto plan = massage::plan(person.back, person.points, {}, programme_of(part));
  REQUIRE_MESSAGE(plan.has_value(), test::reason(plan));
  REQUIRE(plan->paths.size() == 2);
  CHECK(plan->paths[0].step == plan->paths[1].step);
  CHECK(plan->min_tool_distance_m >= closest_tools_m);
  const PerArm<const ContactPath*> hand = {.of = {&plan->paths[0].path, &plan->paths[1].path}};
  // From the first full stroke to the last one some hand always strokes with all of its force, each
  // slides back only while the other strokes, and both have their three turns.
  PerArm<int> turns;
  PerArm<bool> strokes;
  const double first_s = 2.0, last_s = hand[Arm::right]->duration_s() - 2.0;
  for (double t = 0.0; t < hand[Arm::right]->duration_s(); t += 0.01) {
    PerArm<double> force_n;
    for (const Arm arm : both_arms) {
      force_n[arm] =
          t < hand[arm]->duration_s()
              ? hand[arm]->points[static_cast<std::size_t>(std::lround(t / sample_s))].force_n
              : 0.0;
      turns[arm] += force_n[arm] > 11.9 && !strokes[arm];
      strokes[arm] = force_n[arm] > 11.9;
    }
    CAPTURE(t);
    if (t > first_s && t < last_s) CHECK(std::max(force_n[Arm::left], force_n[Arm::right]) > 11.9);
  }
  CHECK(turns[Arm::left] == 3);
  CHECK(turns[Arm::right] == 3);
}

TEST_CASE("hands that would meet stroke one after the other instead, and the plan says so") {
  const Person person;
  const auto plan = massage::plan(
      person.back, person.points, {},
      programme_of("[[part]]\ntechnique = \"stroke\"\nline = \"bladder_inner\"\nforce_n = 8\n"
                   "hand_over_hand = true\nrepeats = 3\n"));
  REQUIRE_MESSAGE(plan.has_value(), test::reason(plan));
  CHECK(plan->paths.size() == 6);
  for (std::size_t i = 0; i < plan->paths.size(); ++i)
    CHECK(plan->paths[i].step == static_cast<int>(i));
  CHECK(noted(*plan, "hand after hand, not hand over hand"));
}

TEST_CASE("what has only one side takes its turns alone") {
  const Person person;
  const auto plan = massage::plan(
      person.back, person.points, {},
      programme_of("[[part]]\ntechnique = \"press\"\npoints = [\"GV4\", \"BL47\"]\nalternating = "
                   "true\nrepeats = 2\nforce_n = 5\n"));
  REQUIRE_MESSAGE(plan.has_value(), test::reason(plan));
  std::string order;
  for (const PlannedPath& planned : plan->paths) order += planned.path.name + ", ";
  CHECK(order == "press GV4, press GV4, press BL47_L, press BL47_R, press BL47_L, press BL47_R, ");
}

TEST_CASE("a person with the head at the other end keeps the arms uncrossed") {
  Person person;
  const Transform turned = Transform(Eigen::AngleAxisd(pi, Vector3::UnitZ()));
  PointCloud cloud = person.back.points();
  for (Vector3& point : cloud.points) point = turned * point;
  for (Vector3& normal : cloud.normals) normal = turned * normal;
  const body::BackSurface back(std::move(cloud), BodyPosture::prone, 4_mm);
  for (Acupoint& point : person.points) point.at_in_couch = turned * point.at_in_couch;
  const auto plan = massage::plan(back, person.points, {}, load_programme("relax").value());
  for (const PlannedPath& planned : plan->paths) {
    const double x = planned.path.points.front().at_in_couch.x();
    if (std::abs(x) > 20_mm) CHECK((x > 0.0) == (planned.arm == Arm::left));
  }
}

TEST_CASE("no arm has two paths at once, and no path begins before the step before has ended") {
  const Person person;
  const auto plan =
      massage::plan(person.back, person.points, {}, load_programme("shoulders").value());
  for (const PlannedPath& one : plan->paths) {
    for (const PlannedPath& other : plan->paths) {
      if (one.step < other.step) CHECK(one.end_s() + Transfers{}.retract_s() <= other.start_s);
      if (&one != &other && one.step == other.step) CHECK(one.arm != other.arm);
    }
  }
}

TEST_CASE("paths that come too close to each other are done one after the other") {
  const Person person;
  const Programme wide =
      programme_of("[[part]]\ntechnique = \"rub\"\npoints = [\"SI11\"]\nradius_mm = 30\n");
  // Circles of 30 mm radius around points 240 mm apart leave 180 mm; 168 mm apart they leave 108
  // mm.
  Person slim;
  for (Acupoint& point : slim.points) {
    if (point.name.starts_with("SI"))
      point = {
          point.name,
          slim.back
              .nearest({0.7 * point.at_in_couch.x(), point.at_in_couch.y(), point.at_in_couch.z()})
              .at_in_couch,
          Vector3::UnitY(), 0.0};
    point.uncertainty_m = 0.0;
  }
  const auto apart = massage::plan(person.back, person.points, {}, wide);
  CHECK(apart->paths.at(0).step == apart->paths.at(1).step);
  const auto close = massage::plan(slim.back, slim.points, {}, wide);
  REQUIRE(close->paths.size() == 2);
  CHECK(close->paths[0].step != close->paths[1].step);
  const auto ordered = massage::plan(
      person.back, person.points, {},
      programme_of("[[part]]\ntechnique = \"rub\"\npoints = [\"BL47\"]\ntogether = false\n"));
  CHECK(ordered->paths.at(0).step != ordered->paths.at(1).step);
}

TEST_CASE("both hands knead at once as mirror images, lightest towards the spine") {
  const Person person;
  const auto plan = massage::plan(
      person.back, person.points, {},
      programme_of("[[part]]\ntechnique = \"knead\"\npoints = [\"SI11\"]\nforce_n = 15\n"
                   "radius_mm = 15\nrepeats = 6\n"));
  REQUIRE_MESSAGE(plan.has_value(), test::reason(plan));
  REQUIRE(plan->paths.size() == 2);
  CHECK(plan->paths[0].step == plan->paths[1].step);
  for (const PlannedPath& planned : plan->paths) {
    CAPTURE(planned.path.name);
    CHECK(planned.path.technique == Technique::knead);
    CHECK(planned.path.duration_s() == doctest::Approx(6.0 / 0.8 + 0.5 + 2.0 * landing_s));
    const auto firmest = std::max_element(
        planned.path.points.begin(), planned.path.points.end(),
        [](const ContactPoint& a, const ContactPoint& b) { return a.force_n < b.force_n; });
    CHECK(firmest->force_n == doctest::Approx(15.0).epsilon(0.01));
    const double begin_m = std::abs(planned.path.points.front().at_in_couch.x());
    CHECK(std::abs(firmest->at_in_couch.x()) > begin_m + 25_mm);
  }
}

TEST_CASE("a knead is lowered to what its zone bears") {
  const Person person;
  const auto plan =
      massage::plan(person.back, person.points, {},
                    programme_of("[[part]]\ntechnique = \"knead\"\npoints = [\"SI11\", \"BL50\"]\n"
                                 "force_n = 25\n"));
  REQUIRE_MESSAGE(plan.has_value(), test::reason(plan));
  CHECK(noted(*plan, "knead BL50_L: 25.0 N lowered to "));
  for (const PlannedPath& planned : plan->paths) {
    if (planned.path.acupoints.at(0).starts_with("BL50"))
      CHECK(planned.cap_n <= cap_n(Zone::kidney, Technique::knead));
    for (const ContactPoint& point : planned.path.points) CHECK(point.force_n <= planned.cap_n);
  }
}

TEST_CASE("forces above the cap of a zone are lowered, and the plan says so") {
  const Person person;
  const auto plan =
      massage::plan(person.back, person.points, {},
                    programme_of("intensity = 5\n[[part]]\ntechnique = \"press\"\npoints = "
                                 "[\"BL50\", \"GV4\"]\nforce_n = 45\n"));
  REQUIRE(plan.has_value());
  CHECK(noted(*plan, "press BL50_L: 63.0 N lowered to 18.0 N (kidney)"));
  CHECK(noted(*plan, "press GV4: 63.0 N lowered to 8.0 N (GV4, perhaps spine)"));
  CHECK(plan->zones_touched == std::vector<std::string>{"kidney", "GV4"});
}

TEST_CASE("a plan says which points are known less well than the tool is wide") {
  Person person;
  const Programme presses = programme_of(
      "[[part]]\ntechnique = \"press\"\npoints = [\"SI11\", \"BL50\"]\nforce_n = 10\n");
  const auto sure = massage::plan(person.back, person.points, {}, presses);
  CHECK_FALSE(noted(*sure, "known less well"));
  for (Acupoint& point : person.points) {
    if (point.name == "BL50_R" || point.name == "BL47_L") point.uncertainty_m = 21_mm;
  }
  const auto doubtful = massage::plan(person.back, person.points, {}, presses);
  CHECK(noted(*doubtful, "known less well than that (95 %, mm): BL50_R 21"));
}

TEST_CASE("a configured ceiling lowers every cap, and none raises the ceilings of the zones") {
  const Person person;
  const Programme press = programme_of(
      "[[part]]\ntechnique = \"press\"\npoints = [\"SI11\", \"BL50\"]\nforce_n = 45\n");
  const auto low = massage::plan(person.back, person.points, {}, press, {.force_ceiling_n = 8.0});
  for (const PlannedPath& planned : low->paths) CHECK(planned.cap_n == 8.0);
  const auto high =
      massage::plan(person.back, person.points, {}, press,
                    {.force_scale = 10.0, .muscle_cap_n = 1000.0, .force_ceiling_n = 1000.0});
  for (const PlannedPath& planned : high->paths) CHECK(planned.cap_n <= 45.0);
}

TEST_CASE(
    "a circle that would cross the spine is flattened beside it, a tap over the kidneys is left "
    "out") {
  Person person;
  for (Acupoint& point : person.points) {
    if (point.name.starts_with("BL47")) {
      point.at_in_couch =
          person.back.nearest({0.55 * point.at_in_couch.x(), 0.2, point.at_in_couch.z()})
              .at_in_couch;
    }
  }
  const auto plan = massage::plan(
      person.back, person.points, {},
      programme_of("[[part]]\ntechnique = \"rub\"\npoints = [\"BL47\"]\n[[part]]\ntechnique = "
                   "\"tap\"\npoints = [\"BL50\"]\n"));
  REQUIRE_MESSAGE(plan.has_value(), test::reason(plan));
  CHECK(noted(*plan, "rub BL47_L: bent by up to"));
  CHECK(noted(*plan, "tap BL50_R: left out, it may not be done on kidney"));
  for (const PlannedPath& planned : plan->paths) {
    for (const ContactPoint& point : planned.path.points)
      CHECK(std::abs(point.at_in_couch.x()) > 15_mm);
  }
}

TEST_CASE("GV4 bears ten seconds, so fewer presses are done than ordered") {
  const Person person;
  const auto plan =
      massage::plan(person.back, person.points, {},
                    programme_of("[[part]]\ntechnique = \"press\"\npoints = [\"GV4\"]\nrepeats = "
                                 "9\nrise_s = 5\nhold_s = 10\n"));
  CHECK(plan->paths.at(0).path.duration_s() <= 10.0);
  CHECK(noted(*plan, "instead of 9 presses"));
}

TEST_CASE("a point whose place is hardly known is left out, and the plan says so") {
  Person person;
  const Programme programme =
      programme_of("[[part]]\ntechnique = \"press\"\npoints = [\"GV4\", \"BL50\"]\nforce_n = 10\n");
  for (Acupoint& point : person.points) {
    if (point.name == "GV4") point.uncertainty_m = 51_mm;
  }
  const auto plan = massage::plan(person.back, person.points, {}, programme);
  REQUIRE(plan.has_value());
  for (const PlannedPath& planned : plan->paths) CHECK(planned.path.name != "press GV4");
  CHECK(noted(*plan, "the place of GV4 is known to 51 mm only"));
}

TEST_CASE(
    "a stroke whose skin the scan does not show is left out with the reason, not the session") {
  const Person person;
  PointCloud upper;  // the scan ends 80 mm below GV4
  for (const Vector3& point : person.back.points().points) {
    if (point.z() < 0.2) continue;
    upper.points.push_back(point);
    upper.normals.push_back(person.back.nearest(point).normal_in_couch);
  }
  const body::BackSurface cropped(std::move(upper), BodyPosture::sitting, 4_mm);
  const char* low = "[[part]]\ntechnique = \"stroke\"\nplaces = [[3.0, 0.1], [3.0, -0.5]]\n";
  const auto plan = massage::plan(
      cropped, person.points, {},
      programme_of("[[part]]\ntechnique = \"press\"\npoints = [\"BL47\"]\n" + std::string(low)));
  REQUIRE_MESSAGE(plan.has_value(), test::reason(plan));
  CHECK(plan->paths.size() == 2);
  CHECK(noted(*plan, "left out, the scan shows no skin"));
  const auto nothing = massage::plan(cropped, person.points, {}, programme_of(low));
  REQUIRE_FALSE(nothing.has_value());
  CHECK(nothing.error().message.find("the scan shows no skin") != std::string::npos);
}

TEST_CASE("a stroke that is too short, or turns back, is left out with the reason") {
  const Person person;
  for (const auto& [places, why] :
       {std::pair("[[3.0, 0.9], [3.0, 0.85]]", "mm long: 30 at least"),
        std::pair("[[3.0, 0.9], [3.0, 0.9]]", "0.0 mm apart: 1 at least"),
        std::pair("[[3.0, 0.9], [3.0, 0.3], [3.0, 0.8]]", "at place 2: 100 at most")}) {
    CAPTURE(places);
    const auto plan =
        massage::plan(person.back, person.points, {},
                      programme_of("[[part]]\ntechnique = \"press\"\npoints = [\"BL47\"]\n"
                                   "[[part]]\ntechnique = \"stroke\"\nplaces = " +
                                   std::string(places) + "\n"));
    REQUIRE_MESSAGE(plan.has_value(), test::reason(plan));
    CHECK(plan->paths.size() == 2);
    CHECK(noted(*plan, why));
  }
}

TEST_CASE("a place in a hole of the scan is left out, and only that") {
  const Person person;
  const Vector3 at = person.points[2].at_in_couch;  // BL47_L
  for (const double radius_m : {20_mm, 30_mm, 40_mm}) {
    PointCloud holed;
    for (const Vector3& point : person.back.points().points) {
      if ((point - at).norm() < radius_m) continue;
      holed.points.push_back(point);
      holed.normals.push_back(person.back.nearest(point).normal_in_couch);
    }
    const body::BackSurface back(std::move(holed), BodyPosture::sitting, 4_mm);
    const auto plan = massage::plan(
        back, person.points, {},
        programme_of("[[part]]\ntechnique = \"press\"\npoints = [\"BL47\", \"BL50\"]\n"));
    REQUIRE_MESSAGE(plan.has_value(), test::reason(plan));
    CAPTURE(radius_m);
    CHECK(noted(*plan, "press BL47_L: left out, "));
    CHECK(plan->paths.size() == 3);
  }
}

TEST_CASE("an area in which the scan shows no skin is said to keep none free") {
  const Person person;
  const Vector3 at = person.points[2].at_in_couch;
  for (const double off_m : {0.0, 1.0}) {
    NoGo area{.name = "scar", .corners_in_couch = {}};
    for (const auto& [dx, dz] : {std::pair{-0.03, -0.03}, {0.03, -0.03}, {0.0, 0.03}})
      area.corners_in_couch.push_back(at + Vector3(dx + off_m, 0.0, dz));
    const auto plan = massage::plan(person.back, person.points, {}, load_programme("relax").value(),
                                    {.no_go = {area}});
    REQUIRE_MESSAGE(plan.has_value(), test::reason(plan));
    CHECK(noted(*plan, "scar keeps no skin free") == (off_m > 0.0));
  }
}

TEST_CASE("what does not belong together is refused") {
  const Person person;
  const Programme relax = load_programme("relax").value();
  auto points = person.points;
  points[2].at_in_couch.x() = std::numeric_limits<double>::quiet_NaN();
  CHECK(
      massage::plan(person.back, points, {}, relax).error().message.find("BL47_L has no finite") !=
      std::string::npos);
  points = person.points;
  for (Acupoint& point : points) point.at_in_couch.y() += 50_mm;
  CHECK(
      massage::plan(person.back, points, {}, relax).error().message.find("off the scanned skin") !=
      std::string::npos);
  CHECK(massage::plan(person.back, person.points, {},
                      programme_of("[[part]]\ntechnique = \"press\"\npoints = [\"BL23\"]\n"))
            .error()
            .message.find("wants BL23_L") != std::string::npos);
}

TEST_CASE(
    "what the therapist rules out is not touched: points fall out, strokes are cut short of it") {
  const Person person;
  // 60 mm around BL47_L.
  NoGo bruise{.name = "bruise", .corners_in_couch = {}};
  for (const auto& [dx, dz] :
       {std::pair{-0.03, -0.03}, {0.03, -0.03}, {0.03, 0.03}, {-0.03, 0.03}}) {
    bruise.corners_in_couch.push_back(person.points[2].at_in_couch + Vector3(dx, 0.0, dz));
  }
  const Programme programme = programme_of(
      "[[part]]\ntechnique = \"press\"\npoints = [\"BL47\"]\n[[part]]\ntechnique = \"rub\"\npoints "
      "= "
      "[\"BL50\"]\n[[part]]\ntechnique = \"stroke\"\npoints = [\"SI11\", \"BL47\", \"BL50\"]\n");
  const auto all = massage::plan(person.back, person.points, {}, programme);
  const auto careful =
      massage::plan(person.back, person.points, {}, programme, {.no_go = {bruise}});
  REQUIRE(all.has_value());
  REQUIRE_MESSAGE(careful.has_value(), test::reason(careful));
  CHECK(noted(*careful, "press BL47_L: left out, it may not be done on no_go"));
  CHECK(noted(*careful, "stroke SI11_L to BL50_L: cut from"));
  CHECK(careful->paths.size() < all->paths.size());
  constexpr double tool_m = 17_mm;
  for (const PlannedPath& planned : careful->paths) {
    CAPTURE(planned.path.name);
    for (const ContactPoint& point : planned.path.points) {
      const Vector3 from_middle = point.at_in_couch - person.points[2].at_in_couch;
      const bool beside = std::abs(from_middle.x()) > 0.03 || std::abs(from_middle.z()) > 0.03;
      REQUIRE(beside);
      REQUIRE(std::hypot(std::max(std::abs(from_middle.x()) - 0.03, 0.0),
                         std::max(std::abs(from_middle.z()) - 0.03, 0.0)) > 0.8 * tool_m);
    }
  }
}
