// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "tuina/calibration/calibrate.hpp"
#include "tuina/core/random.hpp"
#include "tuina/scanner/triangulation.hpp"
#include "tuina/sim/scanner/synthetic_shots.hpp"

namespace tuina::test {

/// What the pictures of a set would give, without taking them: corners and lines where they truly
/// are, with noise.
inline calibration::Views seen_boards(const scanner::ScannerCalibration& truth,
                                      const std::vector<sim::SyntheticPicture>& pictures,
                                      const scanner::Board& board, std::uint64_t seed,
                                      double noise_px = 0.05) {
  Random random = make_random(seed, "seen boards");
  calibration::Views views{
      .board = board, .width_px = truth.camera.width_px, .height_px = truth.camera.height_px};
  for (const sim::SyntheticPicture& picture : pictures) {
    const Transform& pose = picture.camera_from_board;
    if (picture.laser) {
      // Rows of the light plane on the board, which lies where z of the board is 0.
      calibration::View& view = views.views.back();
      view.laser_on = true;
      const Vector3 normal = pose.linear().col(2);
      const double distance_m = normal.dot(pose.translation());
      for (int row = 0; row < views.height_px; ++row) {
        const Vector3 across =
            truth.laser_normal_in_camera * distance_m - normal * truth.laser_distance_m;
        double column = truth.camera.cx_px;
        for (int i = 0; i < 10; ++i) {
          const Vector3 ray = scanner::ray_through(truth.camera, column, row);
          column -= across.dot(ray) / across.x() * truth.camera.fx_px;
        }
        const Vector3 ray = scanner::ray_through(truth.camera, column, row);
        const Vector3 at = pose.inverse() * Vector3(ray * (distance_m / normal.dot(ray)));
        const Vector2 squares = at.head<2>() / board.square_m;
        if (squares.x() < -0.8 || squares.x() > board.columns - 0.2) continue;
        if (squares.y() < -0.8 || squares.y() > board.rows - 0.2) continue;
        view.line.push_back({.row = row,
                             .column_px = static_cast<float>(column + gaussian(random, noise_px)),
                             .amplitude_dn = 100.0F,
                             .deviation_px = static_cast<float>(noise_px)});
      }
      continue;
    }
    calibration::View view{.frame = views.board_pictures++,
                           .pose = picture.pose,
                           .yaw_rad = picture.yaw_rad,
                           .corners_px = {},
                           .line = {}};
    for (int y = 0; y < board.rows; ++y) {
      for (int x = 0; x < board.columns; ++x) {
        const Vector3 at = pose * Vector3(x * board.square_m, y * board.square_m, 0.0);
        view.corners_px.push_back(scanner::project(truth.camera, at) +
                                  Vector2(gaussian(random, noise_px), gaussian(random, noise_px)));
      }
    }
    views.views.push_back(view);
  }
  return views;
}

inline calibration::Views seen_boards(const scanner::ScannerCalibration& truth, std::uint64_t seed,
                                      const sim::SyntheticShotsOptions& options = {},
                                      double noise_px = 0.05) {
  return seen_boards(truth, sim::synthetic_pictures(truth, seed, options), options.board, seed,
                     noise_px);
}

}  // namespace tuina::test
