// SPDX-License-Identifier: Apache-2.0
#include "tests/safety/scene.hpp"

using namespace tuina;
using namespace tuina::safety;

TEST_CASE("a proposal with a broken normal, target, stiffness, zone or phase is refused") {
  const std::vector<void (*)(Proposal&)> faults = {
      [](Proposal& proposal) { proposal.normal_in_base.setZero(); },
      [](Proposal& proposal) { proposal.normal_in_base *= 1.001005; },
      [](Proposal& proposal) { proposal.normal_in_base *= 0.998995; },
      [](Proposal& proposal) { proposal.normal_in_base.x() = not_a_number; },
      [](Proposal& proposal) { proposal.normal_in_base.x() = infinity; },
      [](Proposal& proposal) { proposal.virtual_target_in_base.y() = infinity; },
      [](Proposal& proposal) { proposal.stiffness_n_per_m = -1e-9; },
      [](Proposal& proposal) { proposal.stiffness_n_per_m = not_a_number; },
      [](Proposal& proposal) { proposal.stiffness_n_per_m = infinity; },
      [](Proposal& proposal) { proposal.zone = static_cast<Zone>(7); },
      [](Proposal& proposal) { proposal.zone = static_cast<Zone>(99); },
      [](Proposal& proposal) { proposal.phase = static_cast<Phase>(4); },
      [](Proposal& proposal) { proposal.phase = static_cast<Phase>(99); }};
  for (const auto& spoil : faults) {
    Scene scene;
    scene.force_n = 5.0;  // which a zone that does not exist bears
    scene.tick(3);
    spoil(scene.proposal);
    CHECK(scene.tick().action == Action::retract);
    CHECK(scene.verdict.cause == Cause::bad_proposal);
    CHECK(scene.verdict.latched);
    CHECK(scene.verdict.allowed_nm.allFinite());
  }
  for (const double length : {1.000995, 0.999005}) {
    Scene scene;
    scene.proposal.normal_in_base *= length;
    CHECK(scene.tick().action == Action::pass);
  }
  Scene scene;
  scene.proposal.stiffness_n_per_m = 0.0;
  CHECK(scene.tick().action == Action::pass);
}

TEST_CASE("a zone that does not exist, or is not for people, is borne as the most careful one is") {
  for (const Zone zone : {static_cast<Zone>(7), static_cast<Zone>(99), Zone::bench}) {
    for (const double force_n : {9.99, 10.01}) {
      Guard::Options options = six_joints();
      options.bench = false;
      Scene scene(options);
      scene.force_n = force_n;
      scene.tick(3);
      scene.proposal.zone = zone;  // the force is judged before the proposal is
      CHECK(scene.tick().cause == (force_n > 10.0 ? Cause::force_over_trip : Cause::bad_proposal));
      CHECK(scene.verdict.action == Action::retract);
    }
  }
}

TEST_CASE("a bench is refused where nobody has said so, be it for one tick in fifty") {
  Guard::Options options = six_joints();
  options.bench = false;
  Scene scene(options);
  scene.force_n = 59.5;
  scene.tick(49);
  scene.proposal.zone = Zone::bench;
  CHECK(scene.tick().action == Action::retract);
  CHECK(scene.verdict.cause == Cause::force_over_trip);
  Scene laboratory;
  laboratory.proposal.zone = Zone::bench;
  laboratory.force_n = 59.5;
  CHECK(laboratory.tick(200).action == Action::pass);
  CHECK_FALSE(Guard::Options{}.bench);
}

TEST_CASE("torques that stay the same to the last bit while the joints change speed are old") {
  const auto repeated = [](double change_rad_per_s, int ticks, double new_nm = 0.0) {
    Scene scene;
    scene.tick(20);
    for (int i = 0; i < ticks; ++i) {
      scene.seen.dq_rad_per_s[2] = i % 2 == 0 ? change_rad_per_s : 0.0;
      scene.proposal.torque_nm[5] += new_nm;
      scene.tick();
    }
    return scene.verdict;
  };
  CHECK(repeated(0.0101, 2).action == Action::pass);
  CHECK(repeated(0.0101, 3).action == Action::freeze);
  CHECK(repeated(-0.0101, 9).action == Action::freeze);
  CHECK(repeated(0.0101, 9).cause == Cause::no_proposal);
  CHECK_FALSE(repeated(0.0101, 9).latched);
  CHECK(repeated(0.0101, 10).action == Action::retract);
  CHECK(repeated(0.0101, 10).latched);
  CHECK(repeated(0.99e-3, 500).action == Action::pass);
  CHECK(repeated(1.01e-3, 500).action == Action::retract);
  CHECK(repeated(0.0101, 500, 1e-12).action == Action::pass);
  Scene scene;  // and is over with the first new one
  scene.tick(20);
  for (int i = 0; i < 5; ++i) scene.seen.dq_rad_per_s[2] = 0.01 * (i % 2), scene.tick();
  CHECK(scene.verdict.action == Action::freeze);
  scene.proposal.torque_nm[5] += 1e-9;
  CHECK(scene.tick().action == Action::pass);
}

TEST_CASE(
    "torques are old from the third time that they come again, and only where speeds change") {
  Scene paired;
  paired.tick(10);
  for (int ms = 0; ms < 90; ++ms) {
    if (ms % 3 == 0) paired.proposal.torque_nm[5] += 1e-9;
    paired.seen.dq_rad_per_s[5] = ms % 2 == 0 ? 0.01 : 0.0;
    CHECK(paired.tick().action == Action::pass);
  }
  for (const double change_rad_per_s : {1e-3, 1.001e-3}) {
    Scene scene;
    scene.tick(10);
    for (int ms = 0; ms < 10; ++ms) {
      scene.seen.dq_rad_per_s[5] = ms % 2 == 0 ? change_rad_per_s : 0.0;
      scene.tick();
    }
    CHECK((scene.verdict.action == Action::pass) == (change_rad_per_s == 1e-3));
  }
}

TEST_CASE("a controller that is silent for 3 ms freezes the arm, for 10 ms it makes it leave") {
  for (std::uint32_t age = 0; age <= 12; ++age) {
    Scene scene;
    scene.tick(20);
    scene.proposal.age_ticks = age;
    scene.tick();
    CAPTURE(age);
    CHECK(scene.verdict.action == (age < 3    ? Action::pass
                                   : age < 10 ? Action::freeze
                                              : Action::retract));
    CHECK(scene.verdict.cause == (age < 3 ? Cause::none : Cause::no_proposal));
    CHECK(scene.verdict.latched == (age >= 10));
    scene.proposal.age_ticks = 0;
    CHECK(scene.tick().action == (age < 10 ? Action::pass : Action::retract));
  }
}

TEST_CASE("a leash may press as hard as the trip, in contact only, and only along the normal") {
  Scene scene;
  scene.face(Vector3::UnitZ());
  scene.seen.tool_in_base = {0.0, 0.0, 0.125};
  const auto drawn = [&](const Vector3& by_m, double stiffness_n_per_m, Phase phase) {
    Scene copy = scene;
    copy.proposal.virtual_target_in_base = copy.seen.tool_in_base + by_m;
    copy.proposal.stiffness_n_per_m = stiffness_n_per_m;
    copy.proposal.phase = phase;
    return copy.tick();
  };
  const Vector3 inward_m(0.0, 0.0, -0.0625);
  CHECK(drawn(inward_m, 960.0, Phase::contact).action == Action::pass);  // 60 N
  CHECK(drawn(inward_m, 960.1, Phase::contact).action == Action::retract);
  CHECK(drawn(inward_m, 960.1, Phase::contact).cause == Cause::leash_too_long);
  CHECK(drawn(inward_m, 960.1, Phase::contact).latched);
  CHECK(drawn(-inward_m, 5000.0, Phase::contact).action == Action::pass);
  CHECK(drawn({0.1, 0.1, 0.0}, 5000.0, Phase::contact).action == Action::pass);
  for (const Phase phase : {Phase::free, Phase::approach, Phase::retract})
    CHECK(drawn(inward_m, 5000.0, phase).action == Action::pass);
}

TEST_CASE("a set force over the ceiling of its zone, or none, is not pressed") {
  for (std::size_t zone = 0; zone < zones; ++zone) {
    const double set_n = force_ceilings[zone].set_n;
    for (const double force_n : {set_n, set_n + 1e-9, not_a_number, infinity}) {
      Scene scene;
      scene.force_n = 0.0;
      scene.proposal.virtual_target_in_base = scene.seen.tool_in_base;
      scene.proposal.zone = static_cast<Zone>(zone);
      scene.proposal.set_force_n = force_n;
      CHECK(scene.tick().action == (force_n == set_n ? Action::pass : Action::retract));
      if (force_n != set_n) CHECK(scene.verdict.cause == Cause::set_force_too_high);
    }
  }
}
