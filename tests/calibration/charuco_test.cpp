// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "tests/folder.hpp"
#include "tests/reason.hpp"
#include "tuina/calibration/board/find_charuco.hpp"
#include "tuina/calibration/calibrate.hpp"
#include "tuina/core/units.hpp"
#include "tuina/scanner/triangulation.hpp"
#include "tuina/sim/scanner/laser_scanner.hpp"
#include "tuina/sim/scanner/synthetic_shots.hpp"

using namespace tuina;
using namespace tuina::calibration;

namespace {

const scanner::ScannerCalibration truth = sim::built_scanner(4);

Transform standing(const Board& board, const Vector3& middle, double tilt_rad, double roll_rad) {
  Transform pose = Transform::Identity();
  pose.linear() = (Eigen::AngleAxisd(tilt_rad, Vector3(0.6, 0.8, 0.0)) *
                   Eigen::AngleAxisd(roll_rad, Vector3::UnitZ()))
                      .toRotationMatrix();
  pose.translation() = middle - 0.5 * (pose.linear() * (corner_on(board, board.corners() - 1)));
  return pose;
}

Image picture_of(const Board& board, const Transform& pose) {
  Random random = make_random(1, "charuco test");
  return sim::photograph(truth, board, pose, sim::board_exposure(), random);
}

// How many corners are farther from where they truly are than this.
int wrong(const SeenBoard& seen, const Board& board, const Transform& pose,
          double tolerance_px = 0.15) {
  int count = 0;
  for (std::size_t k = 0; k < seen.corners_px.size(); ++k) {
    const Vector2 true_px = scanner::project(truth.camera, pose * corner_on(board, seen.which[k]));
    count += (seen.corners_px[k] - true_px).norm() > tolerance_px ? 1 : 0;
  }
  return count;
}

}  // namespace

TEST_CASE("corners of a board with markers are named and found, tilted, turned, near and far") {
  for (const int cells : {4, 5, 6}) {
    Board board = sim::charuco_board();
    board.marker_cells = cells;
    for (const double away_m : {0.6, 1.0, 1.5}) {
      if (cells > 4 && away_m > 1.2) continue;  // smaller cells are read from nearer
      for (const double roll_rad : {0.0, 100.0_deg, -170.0_deg}) {
        const Transform pose = standing(board, {0.0, 0.0, away_m}, 25.0_deg, roll_rad);
        const auto seen = find_charuco(picture_of(board, pose), board);
        CAPTURE(cells);
        CAPTURE(away_m);
        REQUIRE(seen.has_value());
        CHECK(seen->which.size() >= 20);
        CHECK(wrong(*seen, board, pose) == 0);
      }
    }
  }
}

TEST_CASE("part of a board with markers is enough") {
  const Board board = sim::charuco_board();
  const Transform pose = standing(board, {-0.13, 0.12, 0.6}, 15.0_deg, 10.0_deg);
  const Image half_out = picture_of(board, pose);
  const auto seen = find_charuco(half_out, board);
  REQUIRE(seen.has_value());
  CHECK(seen->which.size() >= 8);
  CHECK(seen->which.size() < 24);
  CHECK(wrong(*seen, board, pose) == 0);

  // A hand over the middle of one that is wholly in view.
  const Transform held = standing(board, {0.0, 0.0, 0.8}, 15.0_deg, 10.0_deg);
  Image covered = picture_of(board, held);
  const Vector2 middle = scanner::project(truth.camera, held * corner_on(board, 13));
  for (int y = -40; y < 40; ++y) {
    for (int x = -40; x < 40; ++x) {
      covered.row(static_cast<int>(middle.y()) + y)[static_cast<int>(middle.x()) + x] = 120;
    }
  }
  const auto beside = find_charuco(covered, board);
  REQUIRE(beside.has_value());
  CHECK(std::find(beside->which.begin(), beside->which.end(), 13) == beside->which.end());
  CHECK(beside->which.size() >= 12);
  CHECK(wrong(*beside, board, held, 0.8) == 0);
}

TEST_CASE("what is no board with these markers is none") {
  const Board board = sim::charuco_board();
  const Transform pose = standing(board, {0.0, 0.0, 0.8}, 15.0_deg, 10.0_deg);
  const Image image = picture_of(board, pose);
  Board other = board;
  other.marker_cells = 5;
  CHECK_FALSE(find_charuco(image, other).has_value());
  Image mirrored(image.width, image.height);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      mirrored.row(y)[x] = image.row(y)[image.width - 1 - x];
    }
  }
  CHECK_FALSE(find_charuco(mirrored, board).has_value());
  const Board plain{.columns = 4, .rows = 6, .square_m = 0.035};
  CHECK_FALSE(find_charuco(picture_of(plain, pose), board).has_value());
  CHECK_FALSE(find_charuco(Image(image.width, image.height), board).has_value());
}

TEST_CASE("a board that OpenCV printed before version 4.6 begins with a white square") {
  // Six rows of squares: all markers lie one square to the left of where they are now.
  const Board board{.columns = 4, .rows = 5, .square_m = 0.035, .marker_m = 0.026};
  const auto now = scanner::markers_of(board);
  const auto before = scanner::markers_of(board, false);
  REQUIRE(now.size() == before.size());
  CHECK(now[0].column == 1);
  CHECK(before[0].column == 0);
  CHECK(now[0].cells == before[0].cells);
  CHECK(now[0].cells == 0xb532);  // the first of DICT_4X4_50
}

TEST_CASE("a scanner is known from a board with markers as well") {
  const test::Folder folder;
  const auto written = sim::render_calibration_shots(
      truth, 4, folder.path() / "shots",
      {.board = sim::charuco_board(), .poses = 12, .standing_poses = 2, .sweeps = false});
  REQUIRE_MESSAGE(written.has_value(), test::reason(written));
  Views views;
  const auto result = calibrate_folder(folder.path() / "shots", views);
  REQUIRE_MESSAGE(result.has_value(), test::reason(result));
  CHECK(result->poses == 12);
  CHECK(result->reprojection_px < 0.1);
  CHECK(sim::range_error_m(truth, result->calibration, 1.0) < 1.0_mm);
  // Some boards were partly out of view.
  CHECK(std::any_of(views.views.begin(), views.views.end(),
                    [](const View& view) { return view.corners_px.size() < 24; }));
}
