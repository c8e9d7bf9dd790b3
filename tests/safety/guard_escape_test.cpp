// SPDX-License-Identifier: Apache-2.0
// Tools that go outward: a person who gets up or coughs, a controller that escapes or lets go.
#include "tests/safety/scene.hpp"

using namespace tuina;
using namespace tuina::safety;

TEST_CASE(
    "a person who gets up pushes the tool out of contact faster than 0.12 m/s and is let go") {
  const auto moving = [](Phase phase, double outward_m_per_s) {
    Scene scene;
    scene.face(Vector3::UnitZ());
    scene.proposal.virtual_target_in_base = scene.seen.tool_in_base;
    scene.proposal.set_force_n = 9.9;  // and 20 N are felt
    scene.proposal.phase = phase;
    scene.seen.tool_velocity_m_per_s = {0.0, 0.0, outward_m_per_s};
    return scene;
  };
  CHECK(moving(Phase::contact, 0.12).tick(10).action == Action::pass);
  CHECK(moving(Phase::contact, -0.149).tick(10).action == Action::pass);
  Scene scene = moving(Phase::contact, 0.1201);
  CHECK(scene.tick(2).action == Action::pass);
  scene.seen.tool_velocity_m_per_s.setZero();
  CHECK(scene.tick().action == Action::pass);
  scene.seen.tool_velocity_m_per_s.z() = 0.1201;
  CHECK(scene.ticks_until_it_acts() == 2);
  CHECK(scene.verdict.action == Action::retract);
  CHECK(scene.verdict.cause == Cause::pushed_out);
  for (const Phase phase : {Phase::free, Phase::approach, Phase::retract})
    CHECK(moving(phase, 0.149).tick(10).action == Action::pass);
}

namespace {

/// A tool in contact that goes outward while its controller pushes it outward.
Scene going_outward(double outward_m_per_s, double pushed_n, double ordered_n) {
  Scene scene;
  scene.face(Vector3::UnitZ());
  scene.proposal.virtual_target_in_base = scene.seen.tool_in_base;
  scene.proposal.set_force_n = ordered_n;
  scene.pull(pushed_n * Vector3::UnitZ());
  scene.seen.tool_velocity_m_per_s = {0.0, 0.0, outward_m_per_s};
  return scene;
}

/// Ticks until a tool has gone 20 mm.
int ticks_of_a_cough(double m_per_s) {
  return static_cast<int>(20e-3 / (1e-3 * m_per_s));
}

}  // namespace

TEST_CASE("a tool that is felt as was ordered may ride on a cough, and no farther") {
  Scene scene = going_outward(0.1201, 0.0, 10.1);
  CHECK(scene.ticks_until_it_acts() == ticks_of_a_cough(0.1201));
  CHECK(scene.verdict.cause == Cause::pushed_out);
  CHECK(going_outward(0.1201, 0.0, 9.9).ticks_until_it_acts() == 2);
  CHECK(going_outward(0.1201, 0.0, not_a_number).ticks_until_it_acts() <= 2);
  Scene twice = going_outward(0.1201, 0.0, 10.1);
  CHECK(twice.tick(100).action == Action::pass);
  twice.seen.tool_velocity_m_per_s.setZero();
  CHECK(twice.tick().action == Action::pass);
  twice.seen.tool_velocity_m_per_s.z() = 0.1201;
  CHECK(twice.ticks_until_it_acts() == ticks_of_a_cough(0.1201));
  Scene harder = going_outward(0.1201, 0.0, 10.1);
  CHECK(harder.tick(10).action == Action::pass);
  harder.force_n = 24.0;  // the median of three tells it one tick later
  CHECK(harder.ticks_until_it_acts() == 1);
}

TEST_CASE("a controller may drive its tool out of a cough, however fast, and no farther") {
  for (const double m_per_s : {0.1201, 0.26}) {
    Scene scene = going_outward(m_per_s, 40.2, 0.0);
    CHECK(scene.ticks_until_it_acts() == ticks_of_a_cough(m_per_s));
    CHECK(scene.verdict.cause == Cause::pushed_out);
    CHECK(going_outward(m_per_s, 39.8, 0.0).ticks_until_it_acts() == 2);
  }
  Scene let_go = going_outward(0.31, 0.0, 0.0);
  let_go.proposal.phase = Phase::retract;
  let_go.force_n = 4.9;  // pressed by nobody
  CHECK(let_go.ticks_until_it_acts() == ticks_of_a_cough(0.31) + 2);
  CHECK(let_go.verdict.cause == Cause::tool_too_fast);
  Scene free = going_outward(0.31, 41.0, 0.0);
  free.proposal.phase = Phase::free;
  CHECK(free.ticks_until_it_acts() == 2);
  CHECK(free.verdict.cause == Cause::tool_too_fast);
  Scene aside = going_outward(0.2, 41.0, 0.0);
  aside.seen.tool_velocity_m_per_s.x() = 0.26;
  CHECK(aside.ticks_until_it_acts() == 2);
  CHECK(aside.verdict.cause == Cause::tool_too_fast);
  Scene mute = going_outward(0.2, 41.0, 0.0);
  mute.proposal.torque_nm.resize(0);
  CHECK(mute.ticks_until_it_acts() <= 2);
}

TEST_CASE("in contact no tool goes inward faster than an approach does; aside it may") {
  const auto going = [](Phase phase, double inward_m_per_s, double aside_m_per_s) {
    Scene scene;
    scene.face(Vector3::UnitZ());
    scene.proposal.phase = phase;
    scene.seen.tool_velocity_m_per_s = {aside_m_per_s, 0.0, -inward_m_per_s};
    return scene;
  };
  CHECK(going(Phase::contact, 0.1499, 0.19).tick(100).action == Action::pass);
  CHECK(going(Phase::contact, 0.0, 0.249).tick(100).action == Action::pass);
  CHECK(going(Phase::contact, 0.1501, 0.0).tick(2).action == Action::pass);
  Scene scene = going(Phase::contact, 0.1501, 0.0);
  CHECK(scene.ticks_until_it_acts() == 2);
  CHECK(scene.verdict.action == Action::comply);
  CHECK(scene.verdict.cause == Cause::tool_too_fast);
  for (const Phase phase : {Phase::free, Phase::retract})
    CHECK(going(phase, 0.249, 0.0).tick(100).action == Action::pass);
}
