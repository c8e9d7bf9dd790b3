// SPDX-License-Identifier: Apache-2.0
// Do the two arms reach what a massage asks of them, on every body there is?
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>

#include "tuina/robot/inverse_kinematics.hpp"
#include "tuina/robot/ready_posture.hpp"
#include "tuina/sim/person/person.hpp"
#include "tuina/sim/person/phantom.hpp"
#include "tuina/sim/robot/closest_point.hpp"

using namespace tuina;
using namespace tuina::robot;

namespace {

const ArmTable table = thesis_arm();

struct Place {
  Vector3 at_in_couch;
  Vector3 normal_in_couch;
};

/// The seven acupoints, circles of 30 mm around them, and strokes down each side, all on the skin.
std::vector<Place> massaged_places(const sim::Person& person) {
  const sim::ClosestPoint skin(person.skin_in_couch);
  std::vector<Place> places;
  const auto add = [&](const Vector3& near_skin, const Vector3& normal) {
    places.push_back({skin.find(near_skin).at, normal});
  };
  std::array<Acupoint, 7> seven;
  for (std::size_t i = 0; i < 7; ++i) seven[i] = person.acupoints[i];
  for (const Acupoint& point : seven) {
    add(point.at_in_couch, point.normal_in_couch);
    const Vector3 across = point.normal_in_couch.unitOrthogonal();
    for (int n = 0; n < 12; ++n) {
      const Eigen::AngleAxisd turn(n * 30_deg, point.normal_in_couch);
      add(point.at_in_couch + turn * (30_mm * across), point.normal_in_couch);
    }
  }
  for (const std::size_t side : {0u, 1u}) {
    for (const std::size_t from : {0u, 2u}) {  // SI11 to BL47, BL47 to BL50
      const Acupoint &a = seven[from + side], &b = seven[from + 2 + side];
      for (double s = 0.1; s < 1.0; s += 0.1) {
        add((1 - s) * a.at_in_couch + s * b.at_in_couch,
            ((1 - s) * a.normal_in_couch + s * b.normal_in_couch).normalized());
      }
    }
  }
  return places;
}

struct Tally {
  int places = 0, reached = 0, upright = 0, bodies = 0, bodies_whole = 0;
  double min_dexterity = 1e9, sum_dexterity = 0.0;
};

/// `couch_from_person` moves the person on the couch.
void try_person(const sim::Person& person, const Transform& couch_from_person, Tally& tally) {
  const RobotMount mount = mount_for(person.position);
  const ArmModel left(table, mount, Arm::left), right(table, mount, Arm::right);
  const PerArm<const ArmModel*> arms{.of = {&left, &right}};
  const PerArm<JointVector> ready = ready_posture(table, mount);
  PerArm<std::vector<ContactGoal>> goals, corners;
  const auto places = massaged_places(person);
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Vector3 at_in_couch = couch_from_person * places[i].at_in_couch;
    const ContactGoal goal{.at_in_base = mount.base_from_couch * at_in_couch,
                           .normal_in_base = mount.base_from_couch.linear() *
                                             couch_from_person.linear() *
                                             places[i].normal_in_couch};
    for (const Arm arm : both_arms) {
      const double to_its_side_m = arm == Arm::left ? at_in_couch.x() : -at_in_couch.x();
      if (to_its_side_m < -30_mm) continue;
      goals[arm].push_back(goal);
      if (i < 91 && i % 3 == 0) corners[arm].push_back(goal);
    }
  }
  const auto rail = choose_rail(arms, mount, corners, ready);
  int missed = 0;
  for (const Arm arm : both_arms) {
    for (const ContactGoal& goal : goals[arm]) {
      const auto posture = find_posture(*arms[arm], rail.value_or(0.0), goal, ready[arm]);
      ++tally.places;
      if (posture.reach != Reach::reached) {
        if (++missed == 1) {
          const Vector3 at = mount.base_from_couch.inverse() * goal.at_in_base;
          MESSAGE(fmt::format("{} {}: ({:.3f}, {:.3f}, {:.3f}) {}{}", person.name, name_of(arm),
                              at.x(), at.y(), at.z(), explain(posture.reach),
                              rail ? "" : "; " + rail.error().message));
        }
        continue;
      }
      ++tally.reached;
      tally.upright += posture.tilt_rad < 1_deg ? 1 : 0;
      tally.min_dexterity = std::min(tally.min_dexterity, posture.dexterity);
      tally.sum_dexterity += posture.dexterity;
    }
  }
  ++tally.bodies;
  tally.bodies_whole += missed == 0 ? 1 : 0;
}

void report(const char* what, const Tally& tally) {
  MESSAGE(fmt::format(
      "{}: {} bodies, {} wholly; {:.2f} % of {} places, {:.2f} % with the tool upright; "
      "dexterity least {:.3f}, mean {:.3f} m/rad",
      what, tally.bodies, tally.bodies_whole, 100.0 * tally.reached / tally.places, tally.places,
      100.0 * tally.upright / tally.places, tally.min_dexterity,
      tally.sum_dexterity / tally.reached));
}

}  // namespace

TEST_CASE("every massaged place of phantoms of all types is reached, sitting and prone") {
  Tally tally;
  for (const auto type : {sim::BodyType::slim, sim::BodyType::medium, sim::BodyType::hefty}) {
    for (const auto position : {BodyPosture::sitting, BodyPosture::prone}) {
      try_person(sim::make_phantom(sim::draw_phantom(type, 1), position), Transform::Identity(),
                 tally);
    }
  }
  report("phantoms", tally);
  CHECK(tally.reached == tally.places);
}

TEST_CASE(
    "every massaged place of every labelled body is reached, also when the person sits or lies "
    "aside") {
  const std::filesystem::path bodies = TUINA_BODIES;
  if (!std::filesystem::exists(bodies)) {
    MESSAGE("skipped: no labelled bodies in " << bodies.string());
    return;
  }
  // All bodies where TUINA_REACH_ALL is set, else every eighth: the quick tests should stay quick.
  const bool every = std::getenv("TUINA_REACH_ALL") != nullptr;
  PerArm<Tally> as_they_are, aside;  // [0] sitting, [1] prone
  int count = 0;
  std::vector<std::filesystem::path> files;
  for (const char* folder : {"dev", "population"}) {
    for (const auto& entry : std::filesystem::directory_iterator(bodies / folder)) {
      if (entry.path().extension() == ".ply") files.push_back(entry.path());
    }
  }
  std::sort(files.begin(), files.end());
  for (const auto& file : files) {
    if (!every && count++ % 8 != 0) continue;
    const auto person = sim::load_person(file);
    REQUIRE(person.has_value());
    const auto which = static_cast<std::size_t>(person->position);
    try_person(*person, Transform::Identity(), as_they_are.of[which]);
    const double sign = file.stem().string().back() % 2 == 0 ? 1.0 : -1.0;
    Transform moved(Eigen::AngleAxisd(sign * 15_deg, Vector3::UnitZ()));
    // A prone person may lie with the head at either end.
    if (person->position == BodyPosture::prone && sign > 0)
      moved = moved * Eigen::AngleAxisd(pi, Vector3::UnitZ());
    moved.pretranslate(Vector3(sign * 0.1, -sign * 0.1, 0.0));
    try_person(*person, moved, aside.of[which]);
  }
  report("sitting", as_they_are.of[0]);
  report("prone", as_they_are.of[1]);
  report("sitting 0.14 m aside, turned 15 degrees", aside.of[0]);
  report("prone 0.14 m aside, turned 15 degrees, every second head to foot", aside.of[1]);
  for (const Tally& tally : as_they_are.of) CHECK(tally.reached == tally.places);
  for (const Tally& tally : aside.of) CHECK(tally.reached > 0.98 * tally.places);
}
