// SPDX-License-Identifier: Apache-2.0
// Tools that go outward: a person who gets up or coughs, a controller that escapes or lets go, and
// a tool that flies on after it.
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

namespace {

/// A tool that leaves outward while somebody presses it.
Scene leaving(double outward_m_per_s) {
  Scene scene;
  scene.face(Vector3::UnitZ());
  scene.proposal.virtual_target_in_base = scene.seen.tool_in_base;
  scene.pull(Vector3::Zero());
  scene.seen.tool_velocity_m_per_s = {0.0, 0.0, outward_m_per_s};
  scene.proposal.phase = Phase::retract;
  return scene;
}

/// Ticks until a tool has gone so far, and has been too fast for three.
int ticks_of(double way_m, double m_per_s) {
  return static_cast<int>(way_m / (1e-3 * m_per_s)) + 2;
}
constexpr double cough_m = 20e-3;

}  // namespace

TEST_CASE("a tool that was pressed may fly on when it leaves, a quarter of a metre") {
  for (const double m_per_s : {0.31, 1.3}) {
    CHECK(leaving(m_per_s).ticks_until_it_acts() == ticks_of(0.25, m_per_s));
    Scene let_go = leaving(m_per_s);
    CHECK(let_go.tick(4).action == Action::pass);
    let_go.force_n = 0.0;  // nobody comes after it
    CHECK(let_go.ticks_until_it_acts() == ticks_of(0.25, m_per_s) - 4);
    CHECK(let_go.verdict.cause == Cause::tool_too_fast);
  }
  Scene racing = leaving(1.3001);
  CHECK(racing.ticks_until_it_acts() == ticks_of(cough_m, 1.3001));
  Scene aside = leaving(0.5);
  aside.seen.tool_velocity_m_per_s.x() = 0.301;
  CHECK(aside.ticks_until_it_acts() == 2);
}

TEST_CASE("it begins to fly from the skin only: once it has stopped it is slow again") {
  Scene scene = leaving(0.31);
  CHECK(scene.tick(100).action == Action::pass);
  scene.force_n = 0.0;
  scene.seen.tool_velocity_m_per_s.setZero();
  CHECK(scene.tick(3).action == Action::pass);
  scene.seen.tool_velocity_m_per_s.z() = 0.31;
  CHECK(scene.ticks_until_it_acts() == ticks_of(cough_m, 0.31));
  Scene slow = leaving(0.001);  // as somebody presses it, and faster when nobody does any more
  CHECK(slow.tick(3).action == Action::pass);
  slow.force_n = 0.0;
  CHECK(slow.tick(10).action == Action::pass);
  slow.seen.tool_velocity_m_per_s.z() = 0.31;
  CHECK(slow.ticks_until_it_acts() == ticks_of(0.25, 0.31));
  Scene pressed_in = leaving(-0.001);
  CHECK(pressed_in.tick(3).action == Action::pass);
  pressed_in.force_n = 0.0;
  CHECK(pressed_in.tick(10).action == Action::pass);
  pressed_in.seen.tool_velocity_m_per_s.z() = 0.31;
  CHECK(pressed_in.ticks_until_it_acts() == ticks_of(cough_m, 0.31));
  Scene contact = leaving(0.31);
  CHECK(contact.tick(100).action == Action::pass);
  contact.proposal.phase = Phase::contact;
  CHECK(contact.ticks_until_it_acts() == 2);
}

TEST_CASE("joints may be as fast as a tool that flies away needs") {
  const auto swinging = [](double outward_m_per_s) {
    Scene scene = leaving(outward_m_per_s);
    CHECK(scene.tick(2).action == Action::pass);
    scene.seen.dq_rad_per_s[1] = 3.01;
    return scene;
  };
  CHECK(swinging(0.1201).tick(20).action == Action::pass);
  Scene slow = swinging(0.1199);
  CHECK(slow.ticks_until_it_acts() == 2);
  CHECK(slow.verdict.cause == Cause::joint_too_fast);
}

namespace {

ZoneField::Cell facing(const Vector3& normal) {
  return {Zone::muscle, normal.cast<float>()};
}

/// Which way the guard pushes a tool that was over one cell, leaves by so much out and aside, is
/// over another one, and is stopped there.
Vector3 way_out_after(Phase phase, const Vector3& way_m) {
  const ZoneField::Cell here = facing(Vector3::UnitZ()), rim = facing(Vector3::UnitX());
  Scene scene;
  scene.seen.tool_in_base = {0.5, 0.25, 0.0};
  scene.face(Vector3::UnitZ());
  scene.seen.skin = &here;
  scene.tick(5);
  scene.seen.skin = &rim;
  scene.proposal.phase = phase;
  scene.proposal.stiffness_n_per_m = 0.0;
  scene.force_n = 6.0;
  scene.pushed_along = Vector3(1.0, 0.0, 1.0).normalized();  // pressed, whichever way is out
  scene.seen.tool_in_base += way_m;
  scene.tick(3);
  scene.guard.stop(Action::retract, Cause::asked_to);
  scene.tick(20);
  return scene.allowed_n().normalized();
}

}  // namespace

TEST_CASE("a tool that leaves keeps the way out of where it was, above it and not beside") {
  const Vector3 up = Vector3::UnitZ(), rim = Vector3::UnitX();
  check_same(way_out_after(Phase::retract, {0.0, 0.0, 0.06}), up);
  check_same(way_out_after(Phase::contact, {0.0, 0.0, 0.06}), rim);
  check_same(way_out_after(static_cast<Phase>(4), {0.0, 0.0, 0.06}), rim);
  check_same(way_out_after(Phase::retract, {0.0, 0.0, -0.00499}), up);
  check_same(way_out_after(Phase::retract, {0.0, 0.0, -0.005}), rim);
  check_same(way_out_after(Phase::retract, {0.0, 0.0, -0.00501}), rim);
  check_same(way_out_after(Phase::retract, {0.0, -0.0649, 0.06}), up);
  check_same(way_out_after(Phase::retract, {0.0, -0.0651, 0.06}), rim);
  check_same(way_out_after(Phase::retract, {0.0649, 0.0, 0.06}), up);
  check_same(way_out_after(Phase::retract, {0.0651, 0.0, 0.06}), rim);
}

TEST_CASE("a guard that begins while a tool leaves looks for its way out once") {
  const ZoneField::Cell here = facing(Vector3::UnitX());
  Scene scene;
  scene.face(Vector3::UnitX());
  scene.seen.tool_in_base = {0.0, 0.0, 0.5};
  scene.seen.skin = &here;
  scene.proposal.phase = Phase::retract;
  scene.tick(5);
  scene.guard.stop(Action::retract, Cause::asked_to);
  scene.tick(20);
  check_same(scene.allowed_n().normalized(), Vector3::UnitX());
}

TEST_CASE("springs keep the joints of a stopped arm 0.15 rad off their ends, whoever pushes it") {
  Guard::Options options = six_joints();
  options.min_rad = JointVector::Constant(6, -1.0);
  options.max_rad = JointVector::Constant(6, 1.0);
  for (const double felt_n : {0.0, 20.0}) {
    for (const bool complies : {false, true}) {
      Scene scene(options);
      scene.seen.q_rad << 0.84, 0.0, 0.0, 0.84, -0.84, 0.9;
      scene.force_n = felt_n;
      scene.tick(10);
      const JointVector from_rad = scene.seen.q_rad;
      if (complies)
        scene.comply();
      else
        scene.retract();
      scene.seen.dq_rad_per_s << 0.1, 0.0, 0.0, 0.1, -0.15, 0.05;
      scene.tick(200);
      scene.seen.dq_rad_per_s.setZero();
      scene.tick(20);
      REQUIRE(scene.seen.q_rad[4] == doctest::Approx(-0.87));
      const JointVector held_nm = complies || felt_n > 0.0
                                      ? JointVector(JointVector::Zero(6))
                                      : JointVector(-4.0 * (scene.seen.q_rad - from_rad));
      const JointVector own_nm = scene.verdict.allowed_nm - scene.seen.gravity_nm - held_nm;
      if (complies) CHECK(own_nm[0] == doctest::Approx(-30.0 * 0.01));  // nothing else pulls
      CHECK(own_nm[3] == doctest::Approx(-30.0 * 0.01));
      CHECK(own_nm[4] == doctest::Approx(30.0 * 0.02));
      CHECK(own_nm[5] == doctest::Approx(-30.0 * 0.01));  // from where it was taken over
    }
  }
}
