// SPDX-License-Identifier: Apache-2.0
#include "tuina/session/earlier/known_tissue.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "tuina/core/units.hpp"
#include "tuina/massage/technique/contact_path.hpp"
#include "tuina/session/steering.hpp"
#include "tuina/tissue/tangent_model.hpp"

using namespace tuina;
using namespace tuina::session;

namespace {

constexpr TangentTissue soft{5.0, 210.0}, hard{11.0, 216.0};

KnownTissue felt_earlier() {
  KnownTissue known{.position = BodyPosture::prone};
  const Vector3 places[] = {
      {0.08, 0.01, 0.50}, {-0.08, 0.0, 0.50}, {0.06, 0.0, 0.4}, {-0.06, 0.02, 0.4}, {0, 0, 0.25}};
  for (const char* name : {"SI11_L", "SI11_R", "BL47_L", "BL47_R", "GV4"}) {
    known.lay.push_back({.name = name, .at_in_couch = places[known.lay.size()]});
    known.places.push_back({.name = name, .tissue = soft, .log_sd = 0.08});
  }
  return known;
}

std::vector<Acupoint> later(const KnownTissue& known) {
  const Transform motion = Eigen::Translation3d(0.04, -0.02, 0.03) *
                           Eigen::AngleAxisd(0.2, Vector3(0.3, 1.0, 0.2).normalized());
  std::vector<Acupoint> now = known.lay;
  for (Acupoint& point : now) point.at_in_couch = motion * point.at_in_couch;
  return now;
}

/// How a place of 22 N is probed that feels like `felt`.
struct Probed {
  int presses = 0;
  double highest_n = 0.0, allowed_n = 0.0;
  bool dropped = false, relied = false;

  Probed(std::vector<KnownPlace> known, const TangentTissue& felt,
         massage::Zone zone = massage::Zone::muscle) {
    massage::PlannedPath planned;
    planned.path = {.name = "press BL47_L",
                    .technique = Technique::press,
                    .acupoints = {"BL47_L"},
                    .points = {ContactPoint{.force_n = 22.0}}};
    planned.cap_n = 30.0;
    planned.zone = zone;
    const massage::Plan plan{.paths = {planned}};
    Steering steering(plan,
                      {.presses = tissue::pressed_by_robot(18e3, 0.2), .known = std::move(known)});
    double time_s = 0.0;
    steering.begin(Arm::left, 0, time_s);
    relied = steering.known(Arm::left) != nullptr;
    const auto feel = [&](double force_n) {
      constexpr double torso_n_per_m = 20e3;
      const double depth_m =
          force_n > 0.0 ? tissue::depth_at_force(felt, force_n) + force_n / torso_n_per_m : -2e-3;
      steering.feel(Arm::left, time_s, {.depth_m = depth_m, .force_n = force_n}, force_n);
      time_s += 1e-3;
    };
    for (int i = 0; i < 300; ++i) feel(0.0);
    for (int i = 0; i < 300; ++i) feel(massage::kept_force_n * i / 300.0);
    steering.touch(Arm::left, time_s);
    const double touched_s = time_s;
    while (steering.probing(Arm::left) && time_s < 10.0) {
      const double force_n = steering.probe_force_n(Arm::left, time_s);
      highest_n = std::max(highest_n, force_n);
      feel(force_n);
    }
    presses = static_cast<int>((time_s - touched_s) / 1.2 + 0.5);
    allowed_n = steering.steered_n(Arm::left, 22.0);
    for (const Decision& made : steering.decisions())
      dropped = dropped || std::string(made.reason).find("not as it was felt") != std::string::npos;
  }
};

}  // namespace

TEST_CASE("tissue felt earlier counts for the same person in the same position") {
  const KnownTissue known = felt_earlier();
  std::vector<Acupoint> now = later(known);
  const Recognised same = recognised(known, BodyPosture::prone, now);
  REQUIRE(same.places.size() == 5);
  CHECK(same.places[0].log_sd == doctest::Approx(0.08).scale(1e-6));
  CHECK(same.note.words.find("5 of 5 places") != std::string::npos);

  CHECK(recognised(known, BodyPosture::sitting, now).places.empty());
  CHECK(recognised(known, BodyPosture::sitting, now).note.words.find("prone") != std::string::npos);
  CHECK(recognised({}, BodyPosture::prone, now).note.empty());
  const Recognised few = recognised(known, BodyPosture::prone, std::span(now).first(2));
  CHECK(few.places.empty());
  CHECK(few.note.words.find("3 are needed") != std::string::npos);
}

TEST_CASE("a place that lies a little aside is less sure, one that lies far aside is not known") {
  const KnownTissue known = felt_earlier();
  std::vector<Acupoint> now = later(known);
  now[2].at_in_couch.x() += 3_mm;
  const Recognised aside = recognised(known, BodyPosture::prone, now);
  REQUIRE(aside.places.size() == 5);
  CHECK(aside.places[2].log_sd > 0.1);
  now[2].at_in_couch.x() += 8_mm;
  const Recognised far = recognised(known, BodyPosture::prone, now);
  CHECK(far.places.size() == 4);
  CHECK(std::ranges::none_of(far.places, [](const auto& p) { return p.name == "BL47_L"; }));
  // Somebody else.
  now[2].at_in_couch.x() += 20_mm;
  const Recognised other = recognised(known, BodyPosture::prone, now);
  CHECK(other.places.empty());
  CHECK(other.note.words.find("lie otherwise") != std::string::npos);
}

TEST_CASE("somebody else is noticed by where the acupoints lie, also where no tissue is known") {
  KnownTissue seen = felt_earlier();
  seen.places.clear();
  std::vector<Acupoint> now = later(seen);
  CHECK(recognised(seen, BodyPosture::prone, now).note.empty());
  now[4].at_in_couch.z() -= 30_mm;
  CHECK(recognised(seen, BodyPosture::prone, now).note.words.find("another person") == 0);
  CHECK(recognised(seen, BodyPosture::sitting, now).note.empty());
  seen.lay.clear();
  CHECK(recognised(seen, BodyPosture::prone, now).note.empty());
}

TEST_CASE("a press holds, differs or cannot tell, and what is no number never holds") {
  const auto known_to = [](double sd) -> Eigen::Matrix2d {
    return sd * sd * Eigen::Matrix2d::Identity();
  };
  CHECK(match(soft, 0.08, soft, known_to(0.05), 12.0) == KnownMatch::holds);
  CHECK(match(soft, 0.08, soft, known_to(0.5), 12.0) == KnownMatch::unclear);
  CHECK(match(soft, 0.08, hard, known_to(0.05), 12.0) == KnownMatch::differs);
  CHECK(match(hard, 0.08, {1.5 * hard.alpha_n, hard.beta_per_m}, known_to(0.05), 12.0) ==
        KnownMatch::differs);
  CHECK(match(hard, 0.08, {0.5 * hard.alpha_n, hard.beta_per_m}, known_to(0.05), 12.0) ==
        KnownMatch::differs);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK(match(soft, 0.08, {nan, 210.0}, known_to(0.05), 12.0) == KnownMatch::differs);
  CHECK(match(soft, 0.08, soft, known_to(nan), 12.0) == KnownMatch::differs);
}

TEST_CASE("where tissue is known one press will do, and no press is firmer than of a new place") {
  for (const TangentTissue& tissue : {soft, hard}) {
    CAPTURE(tissue.alpha_n);
    const Probed fresh({}, tissue), known({{"BL47_L", tissue, 0.08}}, tissue);
    CHECK_FALSE(fresh.relied);
    CHECK(known.relied);
    CHECK(fresh.presses >= 2);
    CHECK(known.presses == 1);
    CHECK_FALSE(known.dropped);
    CHECK(known.highest_n <= 0.7 * 22.0);
    CHECK(known.allowed_n >= 0.98 * 22.0);
  }
}

TEST_CASE("tissue that has become another one is probed as new, and that is said") {
  for (const TangentTissue& now : {hard, TangentTissue{11.0, 120.0}}) {
    CAPTURE(now.alpha_n);
    const Probed changed({{"BL47_L", soft, 0.08}}, now);
    CHECK(changed.dropped);
    CHECK(changed.presses >= 2);
    CHECK(changed.highest_n <= 0.7 * 22.0);
  }
}

TEST_CASE("next to the spine every place is probed as new") {
  CHECK_FALSE(Probed({{"BL47_L", soft, 0.08}}, soft, massage::Zone::spine_margin).relied);
  CHECK_FALSE(Probed({{"BL47_L", soft, 0.08}}, soft, massage::Zone::gv4).relied);
  CHECK(Probed({{"BL47_L", soft, 0.08}}, soft, massage::Zone::ribs).relied);
}
