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

TEST_CASE("of a zone or phase that does not exist the hardest limits there are are judged too") {
  Scene scene;
  scene.proposal.zone = static_cast<Zone>(99);
  scene.force_n = 90.5;  // over the trip of the bench
  CHECK(scene.tick().cause == Cause::force_over_trip);
}
