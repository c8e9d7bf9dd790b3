// SPDX-License-Identifier: Apache-2.0
#include "apps/tuina/mount/scanner_mount.hpp"

#include <cmath>

namespace tuina::app {
namespace {

constexpr double bar_half_width_m = 20.0_mm, bar_end_m = 30.0_mm, corner_m = 3.0_mm;
constexpr double tripod_screw_m = 6.6_mm;  // a quarter of an inch passes through
// Screws of the horn are M2, on a circle of which makers print no diameter: from 11 to 19 mm fit.
constexpr double horn_screw_m = 2.4_mm, horn_from_m = 5.5_mm, horn_to_m = 9.5_mm;
constexpr double horn_middle_m = 8.0_mm;
constexpr double tab_m = 20.0_mm, ring_half_width_m = 15.0_mm, beam_height_m = 20.0_mm,
                 ring_height_m = 34.0_mm, ring_from_beam_m = 9.0_mm;
// An AX-12A is 32 x 50 mm where its horn is.
constexpr double motor_width_m = 32.0_mm, motor_height_m = 50.0_mm;
constexpr double shelf_width_m = 100.0_mm, shelf_height_m = 90.0_mm, wall_screw_m = 5.5_mm;
constexpr double tie_m = 4.0_mm;  // width of a slot for cable ties

/// A rectangle about the origin, its corners cut.
Outline board(double width_m, double height_m) {
  const double x = 0.5 * width_m, y = 0.5 * height_m, c = corner_m;
  return {{-x + c, -y}, {x - c, -y}, {x, -y + c}, {x, y - c},
          {x - c, y},   {-x + c, y}, {-x, y - c}, {-x, -y + c}};
}

Plate bar(const MountSizes& sizes) {
  const double half_m = 0.5 * sizes.baseline_m;
  Plate plate{.name = "bar",
              .thickness_m = sizes.thickness_m,
              .outline = board(sizes.baseline_m + 2.0 * bar_end_m, 2.0 * bar_half_width_m),
              .windows = {round_hole(Vector2::Zero(), horn_middle_m),
                          round_hole({-half_m, 0.0}, tripod_screw_m)}};
  for (int quarter = 0; quarter < 4; ++quarter) {
    const Vector2 out(std::cos((quarter + 0.5) * 0.5 * pi), std::sin((quarter + 0.5) * 0.5 * pi));
    plate.windows.push_back(slot(horn_from_m * out, horn_to_m * out, horn_screw_m));
  }
  for (const double aside_m : {-16.0_mm, 16.0_mm})
    plate.windows.push_back(
        slot({-half_m + aside_m, -10.0_mm}, {-half_m + aside_m, 10.0_mm}, tie_m));
  // The beam leaves at (half, 0), forward and towards the camera.
  const Vector2 beam(-std::sin(sizes.lean_rad), std::cos(sizes.lean_rad));
  const Vector2 across(beam.y(), -beam.x());
  for (const double ahead_m : {-ring_from_beam_m, ring_from_beam_m})
    plate.windows.push_back(rectangular_hole(Vector2(half_m, 0.0) + ahead_m * beam, across,
                                             tab_m + sizes.play_m,
                                             sizes.thickness_m + sizes.play_m));
  return plate;
}

Plate ring(const MountSizes& sizes) {
  const double tab = 0.5 * tab_m, x = ring_half_width_m, top = ring_height_m, c = corner_m;
  return {.name = "ring",
          .thickness_m = sizes.thickness_m,
          .outline = {{-tab, -sizes.thickness_m},
                      {tab, -sizes.thickness_m},
                      {tab, 0.0},
                      {x, 0.0},
                      {x, top - c},
                      {x - c, top},
                      {-x + c, top},
                      {-x, top - c},
                      {-x, 0.0},
                      {-tab, 0.0}},
          .windows = {round_hole({0.0, beam_height_m}, sizes.laser_diameter_m + sizes.play_m)}};
}

Plate shelf(const MountSizes& sizes) {
  const double play_m = 2.0 * sizes.play_m;
  Plate plate{.name = "shelf",
              .thickness_m = sizes.thickness_m,
              .outline = board(shelf_width_m, shelf_height_m),
              .windows = {rectangular_hole(Vector2::Zero(), Vector2::UnitX(),
                                           motor_width_m + play_m, motor_height_m + play_m)}};
  for (const double x : {-1.0, 1.0}) {
    for (const double y : {-1.0, 1.0})
      plate.windows.push_back(
          round_hole({x * (0.5 * shelf_width_m - 10.0_mm), y * (0.5 * shelf_height_m - 10.0_mm)},
                     wall_screw_m));
    const double tie_x = x * (0.5 * motor_width_m + 7.0_mm);
    plate.windows.push_back(slot({tie_x, -12.0_mm}, {tie_x, 12.0_mm}, tie_m));
  }
  return plate;
}

}  // namespace

std::vector<Plate> scanner_mount(const MountSizes& sizes) {
  return {bar(sizes), ring(sizes), shelf(sizes)};
}

}  // namespace tuina::app
