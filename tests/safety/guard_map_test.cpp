// SPDX-License-Identifier: Apache-2.0
// What the guard knows of the skin under the tool can only tighten what it is told.
#include "tests/safety/scene.hpp"

using namespace tuina;
using namespace tuina::safety;

namespace {

using Cell = ZoneField::Cell;

Cell cell(Zone zone, const Vector3& normal = Vector3(1.0, 2.0, 2.0) / 3.0) {
  return {zone, normal.cast<float>()};
}

/// What comes of pressing on a cell what a controller says is a zone.
Verdict pressing(const Cell& here, Zone told, double set_n, double felt_n, int ticks = 3) {
  Scene scene;
  scene.seen.skin = &here;
  scene.proposal.zone = told;
  scene.proposal.set_force_n = set_n;
  scene.proposal.virtual_target_in_base = scene.seen.tool_in_base;
  scene.force_n = felt_n;
  return scene.tick(ticks);
}

}  // namespace

TEST_CASE("the stricter of two zones counts, whichever of them the controller tells") {
  for (const bool lies : {false, true}) {
    const Cell here = cell(lies ? Zone::bony : Zone::muscle);
    const Zone told = lies ? Zone::muscle : Zone::bony;
    CHECK(pressing(here, told, 15.0, 25.0).action == Action::pass);
    CHECK(pressing(here, told, 15.1, 0.0).cause == Cause::set_force_too_high);
    CHECK(pressing(here, told, 15.0, 25.1).cause == Cause::force_over_trip);
    CHECK(pressing(here, told, 15.0, 24.9, 101).action == Action::pass);
  }
  // Each number by itself: the map of a kidney lowers neither of those of a bone.
  CHECK(pressing(cell(Zone::kidney), Zone::bony, 15.1, 0.0).cause == Cause::set_force_too_high);
  CHECK(pressing(cell(Zone::muscle), Zone::muscle, 45.0, 60.0).action == Action::pass);
}

TEST_CASE("a place of no zone that is, or of a bench, is denied to a person's arm") {
  CHECK(pressing(cell(static_cast<Zone>(7)), Zone::muscle, 0.1, 0.0).cause ==
        Cause::set_force_too_high);
  CHECK(pressing(cell(static_cast<Zone>(200)), Zone::muscle, 0.0, 10.1).cause ==
        Cause::force_over_trip);
  CHECK(pressing(cell(Zone::denied), Zone::muscle, 0.0, 10.1).cause == Cause::force_over_trip);
  Guard::Options options = six_joints();
  options.bench = false;
  Scene scene(options);
  const Cell here = cell(Zone::bench);
  scene.seen.skin = &here;
  scene.proposal.set_force_n = 0.1;
  scene.proposal.stiffness_n_per_m = 0.0;
  CHECK(scene.tick().cause == Cause::set_force_too_high);
}

TEST_CASE("over skin that it knows, the guard has a way out of its own") {
  const Cell here = cell(Zone::muscle);
  Scene scene;
  scene.seen.skin = &here;
  const Vector3 out = scene.normal();
  scene.proposal.normal_in_base = -out;
  scene.tick(10);
  scene.retract();
  scene.tick(20);
  CHECK((scene.allowed_n() - 80.0 * out).norm() < 1e-4);
  const Cell other = cell(Zone::muscle, Vector3::UnitX());
  scene.seen.skin = &other;  // once it leaves, it goes on the way it began
  scene.tick(20);
  CHECK((scene.allowed_n() - 80.0 * out).norm() < 1e-4);
}

TEST_CASE("a cell without a direction leaves the way out as it is told") {
  for (const Vector3& normal :
       {Vector3(0.0, 0.0, 0.0), Vector3(0.0, 0.0, 2.0), Vector3(not_a_number, 0.0, 1.0)}) {
    const Cell here = cell(Zone::muscle, normal);
    Scene scene;
    scene.seen.skin = &here;
    scene.tick(10);
    scene.retract();
    scene.tick(20);
    check_same(scene.allowed_n(), 80.0 * scene.normal());
  }
}

TEST_CASE("where the way out is the guard's own, a force against it is the sensor's fault") {
  const Cell here = cell(Zone::muscle);
  Scene scene;
  scene.seen.skin = &here;
  scene.tick(10);
  scene.pushed_along = -scene.normal();
  CHECK(scene.tick(9).action == Action::pass);
  CHECK(scene.tick().action == Action::retract);
  CHECK(scene.verdict.cause == Cause::force_reversed);
  scene.tick(99);
  CHECK(scene.outward_n() == doctest::Approx(8.0).epsilon(1e-3));
}

TEST_CASE("the torques may press as hard as the place bears, whatever it is called") {
  const Cell here = cell(Zone::bony);
  Scene scene;
  scene.seen.skin = &here;
  scene.force_n = 0.0;
  scene.proposal.set_force_n = 0.0;
  scene.tick(3);
  scene.pull(-60.0 * scene.normal());
  scene.tick(50);
  CHECK(scene.verdict.cause == Cause::inward_force);
  CHECK((scene.allowed_n() + 35.0 * scene.normal()).norm() < 1e-4);
  Scene leashed;
  leashed.seen.skin = &here;
  leashed.proposal.set_force_n = 0.0;
  leashed.proposal.stiffness_n_per_m = 1251.0;  // 25.02 N over 20 mm
  CHECK(leashed.tick().cause == Cause::leash_too_long);
}

TEST_CASE("the way out over known skin is that of the skin, felt or not") {
  const Vector3 up = Vector3::UnitZ();
  const Cell here = cell(Zone::muscle, up);
  Scene scene;
  scene.seen.skin = &here;
  scene.force_n = 3.0;  // which agrees with any way out
  scene.tick(5);
  scene.retract();
  scene.tick(20);
  CHECK(scene.allowed_n().normalized().dot(up) > 0.999);
}
