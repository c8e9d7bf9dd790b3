// SPDX-License-Identifier: Apache-2.0
#include "apps/evaluation/scanner/trials.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>

#include "tuina/core/random.hpp"
#include "tuina/core/units.hpp"
#include "tuina/scanner/triangulation.hpp"
#include "tuina/sim/person/phantom.hpp"
#include "tuina/sim/scanner/line_renderer.hpp"

namespace tuina::app {
namespace {

using scanner::ScannerCalibration;

constexpr int frames_of_a_wall = 12;

// A wall across the sight of a camera that is itself the frame of the world, and nothing else.
Mesh wall_at(double depth_m) {
  Mesh mesh;
  mesh.vertices = {
      {-2.0, -2.0, depth_m}, {2.0, -2.0, depth_m}, {2.0, 2.0, depth_m}, {-2.0, 2.0, depth_m}};
  mesh.triangles = {{0, 2, 1}, {0, 3, 2}};
  return mesh;
}

Mesh far_away() {
  return {.vertices = {{0.0, 0.0, -50.0}, {0.1, 0.0, -50.0}, {0.0, 0.1, -50.0}},
          .triangles = {{0, 1, 2}}};
}

// That of [thesis] Fig. 4-9, whose rows lie across the light plane's turn; it is the world's frame.
ScannerCalibration drawing_of_walls() {
  ScannerCalibration drawing = sim::true_calibration(BodyPosture::prone, {.upright = false});
  drawing.couch_from_camera = Transform::Identity();
  return drawing;
}

// The scanner of the thesis as somebody built it: every part a little off the drawing.
ScannerCalibration built_by_hand(const ScannerCalibration& drawing, std::uint64_t seed) {
  Random random = make_random(seed, "built by hand");
  ScannerCalibration built = drawing;
  built.camera.fx_px += gaussian(random, 15.0);
  built.camera.fy_px = built.camera.fx_px;
  built.camera.cx_px += gaussian(random, 6.0);
  built.camera.cy_px += gaussian(random, 6.0);
  built.camera.distortion = {-0.06 + gaussian(random, 0.03), gaussian(random, 0.05), 0.0, 0.0, 0.0};
  const Vector3 tilt(gaussian(random, 0.4_deg), gaussian(random, 0.4_deg),
                     gaussian(random, 0.4_deg));
  built.laser_normal_in_camera = (built.laser_normal_in_camera + tilt).normalized();
  built.laser_distance_m += gaussian(random, 2.0_mm);
  return built;
}

using Lines = std::vector<scanner::LaserLine>;

Lines lines_of_wall(const ScannerCalibration& truth, double depth_m,
                    const sim::LaserScannerOptions& options, std::uint64_t seed) {
  const sim::LineRenderer renderer(wall_at(depth_m), far_away(), truth, options, seed);
  const auto [first, last] = scanner::columns_between(truth, 0.3, 4.0);
  Lines lines;
  for (std::uint64_t frame = 0; frame < frames_of_a_wall; ++frame) {
    const Image image = renderer.render(0.0, Vector3::Zero(), frame);
    lines.push_back(scanner::find_laser_line(
        image,
        {.method = scanner::LineMethod::likelihood, .first_column = first, .last_column = last}));
  }
  return lines;
}

// Squared errors, so that several scanners are averaged as they should be.
struct Sums {
  double rms2 = 0.0, systematic2 = 0.0, random2 = 0.0;
  int scanners = 0;

  [[nodiscard]] DepthErrors mean() const {
    const double n = std::max(1, scanners);
    return {std::sqrt(rms2 / n), std::sqrt(std::max(0.0, systematic2 / n)), std::sqrt(random2 / n)};
  }
};

template <typename DepthOf>
void add_errors(const Lines& lines, int rows, double depth_m, DepthOf&& depth_of, Sums& sums) {
  std::vector<double> sum(static_cast<std::size_t>(rows)), sum2 = sum, count = sum;
  for (const auto& line : lines) {
    for (const auto& point : line.points) {
      const double error = depth_of(point) - depth_m;
      if (!std::isfinite(error)) continue;
      const auto row = static_cast<std::size_t>(point.row);
      sum[row] += error;
      sum2[row] += error * error;
      count[row] += 1.0;
    }
  }
  double all = 0.0, all2 = 0.0, within2 = 0.0, within = 0.0, mean2 = 0.0, rows_seen = 0.0;
  for (std::size_t row = 0; row < sum.size(); ++row) {
    if (count[row] < 3.0) continue;
    const double mean = sum[row] / count[row];
    const double variance = (sum2[row] - count[row] * mean * mean) / (count[row] - 1.0);
    all += count[row];
    all2 += sum2[row];
    within2 += variance * (count[row] - 1.0);
    within += count[row] - 1.0;
    mean2 += mean * mean - variance / count[row];  // what the mean still owes to noise is taken off
    rows_seen += 1.0;
  }
  if (rows_seen == 0.0) return;
  sums.rms2 += all2 / all;
  sums.systematic2 += mean2 / rows_seen;
  sums.random2 += within2 / within;
  ++sums.scanners;
}

// (4.1) with two free numbers, D = k / (column - edge), fitted on the middle row to walls at known
// distances: what a user without a calibration of the camera would do.
struct Hyperbola {
  double k = 0.0, edge_px = 0.0;
};

Hyperbola fit_hyperbola(const ScannerCalibration& truth, const sim::LaserScannerOptions& options,
                        std::uint64_t seed) {
  // column = edge + k / D is a straight line over 1 / D.
  double n = 0.0, u = 0.0, c = 0.0, uu = 0.0, uc = 0.0;
  for (const double depth_m : {0.5, 0.8, 1.5}) {
    for (const auto& line : lines_of_wall(truth, depth_m, options, seed)) {
      for (const auto& point : line.points) {
        if (std::abs(point.row - truth.camera.height_px / 2) > 5) continue;
        const double inverse = 1.0 / depth_m;
        const auto column = static_cast<double>(point.column_px);
        n += 1.0;
        u += inverse;
        c += column;
        uu += inverse * inverse;
        uc += inverse * column;
      }
    }
  }
  const double k = (n * uc - u * c) / (n * uu - u * u);
  return {k, (c - k * u) / n};
}

void add_line_noise(const Lines& lines, int rows, double& deviation2, double& bound2) {
  std::vector<double> sum(static_cast<std::size_t>(rows)), sum2 = sum, count = sum;
  double bounds2 = 0.0, points = 0.0;
  for (const auto& line : lines) {
    for (const auto& point : line.points) {
      const auto row = static_cast<std::size_t>(point.row);
      const auto column = static_cast<double>(point.column_px);
      sum[row] += column;
      sum2[row] += column * column;
      count[row] += 1.0;
      bounds2 += std::pow(line.noise_dn / static_cast<double>(point.amplitude_dn), 2) * 2.0 *
                 line.width_px / std::sqrt(pi);
      points += 1.0;
    }
  }
  double within2 = 0.0, within = 0.0;
  for (std::size_t row = 0; row < sum.size(); ++row) {
    if (count[row] < 3.0) continue;
    within2 += sum2[row] - sum[row] * sum[row] / count[row];
    within += count[row] - 1.0;
  }
  deviation2 += within > 0.0 ? within2 / within : 0.0;
  bound2 += points > 0.0 ? bounds2 / points : 0.0;
}

BuiltScanner as_drawn(BodyPosture position, const sim::ScannerMount& mount, std::uint64_t seed) {
  const auto truth = sim::true_calibration(position, mount);
  return {.truth = truth, .believed = sim::believed_calibration(truth, seed)};
}

// Heading, x and y over the couch are not measured; the rest of what is believed stays.
void set_heading_right(BuiltScanner& built) {
  const Transform off = built.truth.couch_from_camera * built.believed.couch_from_camera.inverse();
  const double heading = std::atan2(off(1, 0) - off(0, 1), off(0, 0) + off(1, 1));
  Transform right = Transform::Identity();
  right.linear() = Eigen::AngleAxisd(heading, Vector3::UnitZ()).toRotationMatrix();
  const Vector3 on_back(0.0, 0.0, 0.2);
  right.translation().head<2>() = (off * on_back - right.linear() * on_back).head<2>();
  built.believed.couch_from_camera = right * built.believed.couch_from_camera;
}

// The same scanner on the stand for one who sits or lies.
BuiltScanner moved_to(BuiltScanner built, BodyPosture position, const sim::ScannerMount& mount) {
  set_heading_right(built);
  sim::ScannerMount lying = sim::usual_mount(BodyPosture::prone);
  lying.upright = mount.upright;
  const Transform moved =
      sim::true_calibration(position, mount).couch_from_camera *
      sim::true_calibration(BodyPosture::prone, lying).couch_from_camera.inverse();
  built.truth.couch_from_camera = moved * built.truth.couch_from_camera;
  built.believed.couch_from_camera = moved * built.believed.couch_from_camera;
  return built;
}

}  // namespace

std::vector<BuiltScanner> drawn_scanners(int count, std::uint64_t seed) {
  std::vector<BuiltScanner> scanners;
  for (int k = 0; k < count; ++k) {
    const std::uint64_t own_seed = seed * 1000 + static_cast<std::uint64_t>(k);
    const ScannerCalibration truth = built_by_hand(drawing_of_walls(), own_seed);
    scanners.push_back({.truth = truth, .believed = sim::believed_calibration(truth, own_seed)});
  }
  return scanners;
}

std::vector<WallTrial> wall_trials(const std::vector<double>& depths_m,
                                   const sim::LaserScannerOptions& options,
                                   std::span<const BuiltScanner> scanners, std::uint64_t seed) {
  const ScannerCalibration drawing = drawing_of_walls();
  const double edge_px = drawing.camera.cx_px - drawing.camera.fx_px *
                                                    drawing.laser_normal_in_camera.z() /
                                                    drawing.laser_normal_in_camera.x();
  const double fL =
      drawing.camera.fx_px * drawing.laser_distance_m / drawing.laser_normal_in_camera.x();
  const int rows = drawing.camera.height_px;
  std::vector<WallTrial> trials(depths_m.size());
  std::vector<std::array<Sums, 3>> sums(depths_m.size());
  const auto count = static_cast<double>(scanners.size());
  for (std::size_t k = 0; k < scanners.size(); ++k) {
    const std::uint64_t own_seed = seed * 1000 + k;
    ScannerCalibration truth = scanners[k].truth;
    truth.couch_from_camera = Transform::Identity();
    const ScannerCalibration& believed = scanners[k].believed;
    const Hyperbola fitted = fit_hyperbola(truth, options, own_seed);
    for (std::size_t i = 0; i < depths_m.size(); ++i) {
      const double depth_m = depths_m[i];
      const Lines lines = lines_of_wall(truth, depth_m, options, own_seed + 500);
      const auto column = [](const scanner::LinePoint& point) {
        return static_cast<double>(point.column_px);
      };
      add_errors(
          lines, rows, depth_m, [&](const auto& point) { return fL / (column(point) - edge_px); },
          sums[i][0]);
      add_errors(
          lines, rows, depth_m,
          [&](const auto& point) { return fitted.k / (column(point) - fitted.edge_px); },
          sums[i][1]);
      add_errors(
          lines, rows, depth_m,
          [&](const auto& point) {
            const auto seen = scanner::triangulate(believed, column(point), point.row);
            return seen ? seen->z() : std::nan("");
          },
          sums[i][2]);
      double line2 = 0.0, bound2 = 0.0;
      add_line_noise(lines, rows, line2, bound2);
      trials[i].line_px += line2 / count;
      trials[i].bound_px += bound2 / count;
    }
  }
  for (std::size_t i = 0; i < depths_m.size(); ++i) {
    WallTrial& trial = trials[i];
    trial.depth_m = depths_m[i];
    trial.nominal = sums[i][0].mean();
    trial.fitted = sums[i][1].mean();
    trial.ours = sums[i][2].mean();
    trial.line_px = std::sqrt(trial.line_px);
    trial.bound_px = std::sqrt(trial.bound_px);
    trial.predicted_m = trial.line_px * depths_m[i] * depths_m[i] / fL;  // (4.3)
  }
  return trials;
}

BackTrial back_trial(const ScanConditions& conditions, int people, std::uint64_t seed,
                     std::span<const BuiltScanner> scanners) {
  BackTrial trial;
  double squares = 0.0, expected2 = 0.0, points = 0.0, outliers = 0.0, seen = 0.0, visible = 0.0;
  double covered = 0.0, acupoints = 0.0, errors = 0.0;
  for (int k = 0; k < people; ++k) {
    const auto own_seed = seed * 100 + static_cast<std::uint64_t>(k);
    const BodyPosture position = k % 2 == 0 ? BodyPosture::sitting : BodyPosture::prone;
    constexpr std::array types = {sim::BodyType::medium, sim::BodyType::slim, sim::BodyType::hefty};
    const auto shape =
        sim::draw_phantom(types[static_cast<std::size_t>(k) % types.size()], own_seed);
    const sim::Person person = sim::make_phantom(shape, position);
    sim::ScannerMount mount = sim::usual_mount(position);
    mount.upright = conditions.upright;
    const BuiltScanner built =
        scanners.empty()
            ? as_drawn(position, mount, own_seed)
            : moved_to(scanners[static_cast<std::size_t>(k) % scanners.size()], position, mount);
    sim::LaserScanner scanner(person.skin_in_couch, position, conditions.breathing, own_seed,
                              conditions.options, built.truth);
    auto believed = built.believed;
    believed.latency_s += conditions.latency_error_s;
    const auto scan = scanner::scan_sweep(scanner, scanner, believed, conditions.sweep);
    if (!scan) {
      trial.refused = true;
      return trial;
    }
    const auto truth = sim::compare_with_truth(scan->cloud_in_couch, person.skin_in_couch);
    const auto n = static_cast<double>(truth.points);
    squares += n * truth.rms_error_m * truth.rms_error_m;
    errors += n * truth.mean_error_m;
    expected2 += n * scan->expected_error_m * scan->expected_error_m;
    points += n;
    outliers += static_cast<double>(truth.outliers);
    const auto places = static_cast<double>(scanner.visible().count);
    seen += places * sim::seen_share(scanner.visible(), *scan);
    visible += places;
    for (const Acupoint& acupoint : person.acupoints) {
      const auto& cloud = scan->cloud_in_couch.points;
      covered += std::any_of(cloud.begin(), cloud.end(), [&](const Vector3& point) {
        return (point - acupoint.at_in_couch).norm() < 6.0_mm;
      });
      acupoints += 1.0;
    }
  }
  trial.rms_m = std::sqrt(squares / points);
  trial.bias_m = errors / points;
  trial.expected_m = std::sqrt(expected2 / points);
  trial.outlier_share = outliers / points;
  trial.seen_share = seen / visible;
  trial.covered_points = covered / acupoints;
  return trial;
}

Result<PointCloud> scan_of_body(const Mesh& body_in_couch, const sim::LaserScannerOptions& options,
                                std::uint64_t seed) {
  const auto drawing = sim::true_calibration(BodyPosture::sitting);
  sim::LaserScanner scanner(body_in_couch, far_away(), drawing, seed, options);
  auto scan = scanner::scan_sweep(scanner, scanner, sim::believed_calibration(drawing, seed));
  if (!scan) return tl::unexpected(scan.error());
  return std::move(scan->cloud_in_couch);
}

}  // namespace tuina::app
