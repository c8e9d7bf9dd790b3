// SPDX-License-Identifier: Apache-2.0
#include "tuina/calibration/calibrate.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "tests/folder.hpp"
#include "tests/reason.hpp"
#include "tuina/calibration/board/shots.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/core/io/png.hpp"
#include "tuina/core/units.hpp"
#include "tuina/scanner/picture.hpp"
#include "tuina/sim/scanner/laser_scanner.hpp"
#include "tuina/sim/scanner/synthetic_shots.hpp"

using namespace tuina;
using namespace tuina::calibration;
using tuina::sim::range_error_m;
using tuina::test::Folder;

namespace {

/// The same set as a colour camera takes it under a warm lamp, each laser picture in one with that
/// of its board, exposed so that white paper under the line is not clipped.
void colour(const std::filesystem::path& folder) {
  const auto shots = read_shots(folder);
  REQUIRE_MESSAGE(shots.has_value(), test::reason(shots));
  std::string rows = "frame,kind,pose,time_s,yaw_deg\n";
  for (const Shot& board : shots->shots) {
    if (board.laser) continue;
    const auto laser =
        std::find_if(shots->shots.begin(), shots->shots.end(), [&](const Shot& shot) {
          return shot.laser && shot.pose == board.pose && shot.yaw_rad == board.yaw_rad;
        });
    const bool both = laser != shots->shots.end();
    rows += fmt::format("{},{},{},{},{}\n", board.frame, both ? "both" : "board", board.pose,
                        board.frame, to_deg(board.yaw_rad));
    if (!both) continue;
    const auto scene = scanner::read_picture(board.picture);
    const auto line = scanner::read_picture(laser->picture);
    REQUIRE((scene.has_value() && line.has_value()));
    Image picture(scene->width, scene->height, 3);
    for (std::size_t i = 0; i < scene->data.size(); ++i) {
      const double white = 0.5 * scene->data[i];
      const double red = 1.15 * white + line->data[i];
      picture.data[3 * i] = static_cast<std::uint8_t>(std::min(red, 255.0));
      picture.data[3 * i + 1] = picture.data[3 * i + 2] = static_cast<std::uint8_t>(white);
    }
    REQUIRE(write_file(board.picture, to_png(picture)).has_value());
  }
  REQUIRE(write_file(folder / "frames.csv", rows).has_value());
}

}  // namespace

TEST_CASE("board and laser in one colour picture do as well") {
  const Folder folder;
  const auto truth = sim::built_scanner(4);
  const auto written = sim::render_calibration_shots(truth, 4, folder.path() / "shots",
                                                     {.poses = 14, .standing_poses = 2});
  REQUIRE_MESSAGE(written.has_value(), test::reason(written));
  colour(folder.path() / "shots");
  Views views;
  const auto result = calibrate_folder(folder.path() / "shots", views);
  REQUIRE_MESSAGE(result.has_value(), test::reason(result));
  CHECK(result->poses == 14);
  const double off_m = range_error_m(truth, result->calibration, 1.0);
  MESSAGE(fmt::format("{:.2f} mm at 1 m", to_mm(off_m)));
  CHECK(off_m < 0.8_mm);
}

TEST_CASE("a scanner that nobody has measured is known after one rehearsed set") {
  const Folder folder;
  const auto truth = sim::built_scanner(3);
  const auto written = sim::render_calibration_shots(truth, 3, folder.path() / "shots",
                                                     {.poses = 14, .standing_poses = 2});
  REQUIRE_MESSAGE(written.has_value(), test::reason(written));
  Views views;
  double done = 0.0;
  const auto result = calibrate_folder(folder.path() / "shots", views, [&done](double now) {
    CHECK(now >= done);
    CHECK(now <= 1.0);
    done = now;
  });
  REQUIRE_MESSAGE(result.has_value(), test::reason(result));
  CHECK(done > 0.9);
  const auto& found = result->calibration;
  CHECK(result->poses == 14);
  CHECK(result->reprojection_px < 0.06);

  CHECK(found.camera.fx_px == doctest::Approx(truth.camera.fx_px).epsilon(0.002));
  CHECK(range_error_m(truth, found, 0.65) < 0.5_mm);
  CHECK(range_error_m(truth, found, 1.0) < 0.8_mm);
  CHECK(range_error_m(truth, found, 1.75) < 1.5_mm);

  const double tilt = found.axis_direction_in_camera.cross(truth.axis_direction_in_camera).norm();
  CHECK(tilt < 0.05_deg);
  CHECK(found.axis_direction_in_camera.dot(truth.axis_direction_in_camera) > 0.0);
  const double apart_m = (found.axis_point_in_camera - truth.axis_point_in_camera)
                             .cross(truth.axis_direction_in_camera)
                             .norm();
  CHECK(apart_m < 2.0_mm);

  REQUIRE(result->latency.has_value());
  CHECK(std::abs(found.latency_s - truth.latency_s) < 3e-3);

  REQUIRE(result->couch.has_value());
  const Vector3 up = Vector3::UnitZ();
  const Vector3 up_found = found.couch_from_camera.linear().transpose() * up;
  const Vector3 up_true = truth.couch_from_camera.linear().transpose() * up;
  CHECK(up_found.cross(up_true).norm() < 0.15_deg);
  CHECK(std::abs(found.couch_from_camera.translation().z() -
                 truth.couch_from_camera.translation().z()) < 2.0_mm);

  // The same pictures give the same numbers to the last bit, those of the uncertainty as well.
  const auto again = calibrate(views);
  REQUIRE_MESSAGE(again.has_value(), test::reason(again));
  CHECK(again->fit.covariance == result->fit.covariance);
  CHECK(again->calibration.camera.fx_px == found.camera.fx_px);

  // It says itself about how good it is.
  REQUIRE(result->expected[1].has_value());
  CHECK(result->expected[1]->systematic_m < 1.0_mm);
  CHECK(result->expected[1]->systematic_m > 0.05_mm);
}
