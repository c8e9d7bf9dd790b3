// SPDX-License-Identifier: Apache-2.0
// A map of the zones of a person; what the guard knows by it can only tighten what it is told.
#include "tests/safety/scene.hpp"
#include "tuina/safety/zone_field.hpp"

using namespace tuina;
using namespace tuina::safety;

namespace {

/// Four columns along y, three rows up along z, seen from the front; each cell has a normal of its
/// own to be known by.
ZoneField four_by_three(Zone zone = Zone::bony) {
  ZoneField field{.corner_in_base = {1.0, 0.1, 0.2},
                  .along_in_base = Vector3::UnitY(),
                  .up_in_base = Vector3::UnitZ(),
                  .cell_m = 0.01,
                  .columns = 4,
                  .rows = 3};
  for (int i = 0; i < 12; ++i)
    field.cells.push_back({zone, Eigen::Vector3f(static_cast<float>(i), 0.0F, 0.0F)});
  return field;
}

int cell_at(const ZoneField& field, double y_m, double z_m, double x_m = 1.0) {
  const ZoneField::Cell* cell = field.at({x_m, y_m, z_m});
  return cell == nullptr ? -1 : static_cast<int>(cell->normal_in_base.x());
}

/// A map of one row or column of bone with one cell of muscle in its middle; how many cells to
/// either side are muscle once it reaches that far.
int reached(double reach_m, bool upward) {
  ZoneField field{.cell_m = 5e-3, .columns = upward ? 1 : 21, .rows = upward ? 21 : 1};
  field.cells.resize(21, {Zone::bony});
  field.cells[10].zone = Zone::muscle;
  const ZoneField wide = field.reaching(reach_m);
  int cells = 0;
  for (std::size_t i = 0; i < 21; ++i)
    if (wide.cells[i].zone == Zone::muscle) ++cells;
  return (cells - 1) / 2;
}

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

TEST_CASE("a place lies over one cell, however far before or behind the skin") {
  const ZoneField field = four_by_three();
  CHECK(cell_at(field, 0.1001, 0.2001) == 0);
  CHECK(cell_at(field, 0.1099, 0.2099) == 0);
  CHECK(cell_at(field, 0.1101, 0.2001) == 1);
  CHECK(cell_at(field, 0.1399, 0.2001) == 3);
  CHECK(cell_at(field, 0.1001, 0.2101) == 4);
  CHECK(cell_at(field, 0.1399, 0.2299) == 11);
  CHECK(cell_at(field, 0.1250, 0.2150, 7.0) == 6);
  CHECK(cell_at(field, 0.1250, 0.2150, -7.0) == 6);
}

TEST_CASE("beside the grid, or nowhere, there is no cell") {
  const ZoneField field = four_by_three();
  const double nowhere = std::numeric_limits<double>::quiet_NaN();
  CHECK(cell_at(field, 0.0999, 0.2150) == -1);
  CHECK(cell_at(field, 0.1550, 0.2050) == -1);
  CHECK(cell_at(field, 0.1401, 0.2150) == -1);
  CHECK(cell_at(field, 0.1250, 0.1999) == -1);
  CHECK(cell_at(field, 0.1250, 0.2301) == -1);
  CHECK(cell_at(field, nowhere, 0.2150) == -1);
  CHECK(cell_at(field, 0.1250, nowhere) == -1);
  CHECK(cell_at(field, 1e300, 0.2150) == -1);
  CHECK(cell_at({}, 0.0, 0.0) == -1);
  CHECK(ZoneField{}.empty());
  CHECK_FALSE(field.empty());
}

TEST_CASE("a grid with fewer cells than it says has none where they lack") {
  ZoneField field = four_by_three();
  field.cells.resize(11);
  CHECK(cell_at(field, 0.1299, 0.2299) == 10);
  CHECK(cell_at(field, 0.1399, 0.2299) == -1);
}

TEST_CASE("a corner of the grid and the first cell's edge belong to it, the last one's not") {
  ZoneField field = four_by_three();
  field.corner_in_base.setZero();
  field.cell_m = 0.25;
  CHECK(cell_at(field, 0.0, 0.0) == 0);
  CHECK(cell_at(field, 0.25, 0.5) == 9);
  CHECK(cell_at(field, 1.0, 0.0) == -1);
  CHECK(cell_at(field, 0.0, 0.75) == -1);
}

TEST_CASE("a zone reaches as many whole cells into a stricter one as fit into its reach") {
  for (const bool upward : {false, true}) {
    CHECK(reached(0.0, upward) == 0);
    CHECK(reached(4.9e-3, upward) == 0);
    CHECK(reached(5.1e-3, upward) == 1);
    CHECK(reached(14.9e-3, upward) == 2);
    CHECK(reached(20.1e-3, upward) == 4);
    CHECK(reached(1.0, upward) == 10);
  }
}

TEST_CASE("a zone reaches in a circle, and never into a milder one") {
  ZoneField field{.cell_m = 5e-3, .columns = 7, .rows = 9};
  field.cells.resize(63, {Zone::spine, Eigen::Vector3f(0.6F, 0.0F, 0.8F)});
  field.cells[4 * 7 + 3].zone = Zone::kidney;
  field.cells[4 * 7 + 6].zone = Zone::muscle;
  const ZoneField wide = field.reaching(11e-3);
  for (int row = 0; row < 9; ++row) {
    for (int column = 0; column < 7; ++column) {
      const auto& cell = wide.cells[static_cast<std::size_t>(row * 7 + column)];
      const auto within = [&](int at) {
        return (row - 4) * (row - 4) + (column - at) * (column - at) <= 4;
      };
      CAPTURE(row);
      CAPTURE(column);
      CHECK(cell.zone == (within(6) ? Zone::muscle : within(3) ? Zone::kidney : Zone::spine));
      CHECK(cell.normal_in_base == Eigen::Vector3f(0.6F, 0.0F, 0.8F));
    }
  }
  CHECK(wide.columns == 7);
  CHECK(wide.rows == 9);
  CHECK(wide.cell_m == 5e-3);
}

TEST_CASE("zones that bear alike stay as they are beside each other") {
  ZoneField field{.cell_m = 5e-3, .columns = 3, .rows = 1};
  field.cells = {{Zone::spine}, {Zone::denied}, {Zone::spine}};
  const ZoneField wide = field.reaching(15e-3);
  for (std::size_t i = 0; i < 3; ++i) CHECK(wide.cells[i].zone == field.cells[i].zone);
}

TEST_CASE("a cell that nobody has filled in is denied, and its way out is up") {
  CHECK(ZoneField::Cell{}.zone == Zone::denied);
  CHECK(ZoneField::Cell{}.normal_in_base == Eigen::Vector3f::UnitZ());
  CHECK(ZoneField{}.columns == 0);
  CHECK(ZoneField{}.rows == 0);
  CHECK(ZoneField{}.cell_m == 5e-3);
}

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
  CHECK(scene.outward_n() == doctest::Approx(80.0));  // it pressed when it was last believed
}

TEST_CASE("torques and leash may press as hard as the place bears, whatever it is called") {
  const Cell here = cell(Zone::bony);
  Scene scene;
  scene.seen.skin = &here;
  scene.force_n = 0.0;
  scene.proposal.set_force_n = 15.0;
  scene.tick(3);
  scene.lean(-60.0 * scene.normal());
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
