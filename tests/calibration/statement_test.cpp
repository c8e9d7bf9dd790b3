// SPDX-License-Identifier: Apache-2.0
// What a calibration says of its own errors.
#include <doctest/doctest.h>

#include <cmath>

#include "tests/calibration/seen_boards.hpp"
#include "tests/reason.hpp"
#include "tuina/calibration/calibrate.hpp"
#include "tuina/calibration/fit/pose_covariance.hpp"
#include "tuina/calibration/fit/residual_statistics.hpp"
#include "tuina/core/units.hpp"
#include "tuina/sim/scanner/laser_scanner.hpp"

using namespace tuina;
using namespace tuina::calibration;
using tuina::test::seen_boards;

TEST_CASE("rows that err by themselves are told from poses that err as a whole") {
  // One number seen through twenty boards, each of which adds another unknown to half of its rows.
  const auto deviations = [](double of_row, double of_pose) {
    Random random = make_random(1, "poses");
    std::vector<FitRow> rows;
    double sum = 0.0;
    for (int pose = 0; pose < 20; ++pose) {
      const double alike = gaussian(random, of_pose);
      for (int row = 0; row < 50; ++row) {
        FitRow seen{.pose = pose, .residual = alike + gaussian(random, of_row), .slopes = {}};
        seen.slopes.emplace_back(0, 1.0);
        sum += seen.residual;
        rows.push_back(seen);
        rows.push_back({.pose = pose, .residual = 0.0, .slopes = {{0, 1.0}, {pose + 1, 1.0}}});
      }
    }
    for (FitRow& row : rows) {
      if (row.slopes.size() == 1) row.residual -= sum / 1000.0;
    }
    const auto covariance = pose_covariance(rows, 1);
    REQUIRE(covariance.has_value());
    return std::pair(std::sqrt(covariance->of_rows(0, 0)), std::sqrt(covariance->of_poses(0, 0)));
  };
  const auto [told_of_rows, rows] = deviations(1.0, 0.0);
  CHECK(told_of_rows == doctest::Approx(1.0 / std::sqrt(1000.0)).epsilon(0.01));
  CHECK(rows == doctest::Approx(told_of_rows).epsilon(0.4));
  const auto [told_of_poses, poses] = deviations(0.0, 1.0);
  CHECK(told_of_poses == doctest::Approx(told_of_rows));
  CHECK(poses == doctest::Approx(1.0 / std::sqrt(20.0)).epsilon(0.4));
}

TEST_CASE("what one pose alone tells does not hinder the jackknife of the rest") {
  std::vector<FitRow> rows;
  for (int pose = 0; pose < 6; ++pose) {
    const double residual = pose % 2 == 0 ? 0.1 : -0.1;
    rows.push_back({.pose = pose, .residual = residual, .slopes = {{0, 1.0}}});
  }
  rows.push_back({.pose = 5, .residual = 0.0, .slopes = {{1, 1000.0}}});
  const auto covariance = pose_covariance(rows, 2);
  REQUIRE(covariance.has_value());
  // Six numbers of 0.1 around their mean: 5 / 6 of six changes by 0.1 / 5.
  CHECK(covariance->of_poses(0, 0) == doctest::Approx(0.002));
  CHECK(covariance->of_poses(1, 1) == 0.0);
  CHECK_FALSE(pose_covariance(rows, 3).has_value());
}

TEST_CASE("lines that are off as a whole, each another way, are stated to be") {
  double true2 = 0.0;
  double stated2 = 0.0;
  double of_poses2 = 0.0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const auto truth = sim::built_scanner(seed);
    Views views = seen_boards(truth, seed, {.poses = 20, .standing_poses = 2}, 0.02);
    Random random = make_random(seed, "bent boards");
    for (View& view : views.views) {
      const double off_px = gaussian(random, 0.15);
      for (auto& point : view.line) point.column_px += static_cast<float>(off_px);
    }
    const auto result = calibrate(views);
    REQUIRE_MESSAGE(result.has_value(), test::reason(result));
    const Covariance& poses = result->fit.covariance_of_poses;
    CHECK(poses.allFinite());
    true2 += std::pow(sim::range_error_m(truth, result->calibration, 1.0), 2);
    stated2 += std::pow(result->expected[1]->systematic_m, 2);
    of_poses2 += std::pow(expected_range_error(result->fit.geometry, poses, 1.0)->systematic_m, 2);
  }
  MESSAGE("range at 1 m: true ", 1e3 * std::sqrt(true2 / 4), " mm, stated ",
          1e3 * std::sqrt(stated2 / 4), " mm, jackknife ", 1e3 * std::sqrt(of_poses2 / 4), " mm");
  CHECK(std::sqrt(true2 / stated2) < 1.5);
  CHECK(std::sqrt(stated2 / 4) < 0.5_mm);
}

TEST_CASE("rows of a line that err alike count as one") {
  Random random = make_random(1, "alike");
  std::vector<std::vector<double>> alone(20);
  std::vector<std::vector<double>> in_fours(20);
  for (std::size_t line = 0; line < alone.size(); ++line) {
    double grain = 0.0;
    for (int row = 0; row < 300; ++row) {
      if (row % 4 == 0) grain = gaussian(random, 1.0);
      alone[line].push_back(gaussian(random, 1.0));
      in_fours[line].push_back(grain);
    }
  }
  CHECK(rows_alike(alone, 5.0) == doctest::Approx(1.0).epsilon(0.1));
  CHECK(rows_alike(in_fours, 5.0) == doctest::Approx(4.0).epsilon(0.1));
  CHECK(robust_deviation({0.2, 0.5, 0.6745, 1.0, 90.0}) == doctest::Approx(1.0).epsilon(0.01));
}

TEST_CASE("what is stated is what is true, over scanners and sets") {
  double true2 = 0.0;
  double stated2 = 0.0;
  double axis2 = 0.0;
  double axis_stated2 = 0.0;
  constexpr int sets = 8;
  for (std::uint64_t seed = 1; seed <= sets; ++seed) {
    const auto truth = sim::built_scanner(seed);
    Views views = seen_boards(truth, seed, {.poses = 20, .standing_poses = 3}, 0.1);
    const auto result = calibrate(views);
    REQUIRE_MESSAGE(result.has_value(), test::reason(result));
    true2 += std::pow(sim::range_error_m(truth, result->calibration, 1.0), 2);
    stated2 += std::pow(result->expected[1]->systematic_m, 2);
    const auto& covariance = result->fit.covariance;
    axis2 += result->calibration.axis_direction_in_camera.cross(truth.axis_direction_in_camera)
                 .squaredNorm();
    axis_stated2 += covariance(axis_tilt_1, axis_tilt_1) + covariance(axis_tilt_2, axis_tilt_2);
  }
  MESSAGE("range at 1 m: true ", 1e3 * std::sqrt(true2 / sets), " mm, stated ",
          1e3 * std::sqrt(stated2 / sets), " mm");
  // Eight sets know their own spread to 25 %.
  CHECK(std::sqrt(true2 / stated2) > 0.6);
  CHECK(std::sqrt(true2 / stated2) < 1.5);
  CHECK(std::sqrt(axis2 / axis_stated2) > 0.6);
  CHECK(std::sqrt(axis2 / axis_stated2) < 1.5);
}
