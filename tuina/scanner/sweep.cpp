// SPDX-License-Identifier: Apache-2.0
#include "tuina/scanner/sweep.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "tuina/scanner/check/expected_error.hpp"
#include "tuina/scanner/profile_grid.hpp"
#include "tuina/scanner/sweep_faults.hpp"
#include "tuina/scanner/triangulation.hpp"
#include "tuina/scanner/two_way.hpp"

namespace tuina::scanner {
namespace {

constexpr std::size_t rows_of_a_line = 8;  // fewer lit rows are specks, not a line
constexpr int min_profiles = 10;
constexpr double min_turn_rad = 2.0_deg;
constexpr double max_sweep_s = 300.0;  // a minute at most with the shipped turntable
// At flatter angles a pixel covers many points of the surface.
constexpr double min_cosine = 0.1;

// Noise of the line position above which a point (usually at grazing incidence) needs support by
// its neighbours: seven times the noise stands alone.
constexpr float unsure_px = 0.3F;

Result<void> check(std::span<const TimedLine> lines, const std::vector<double>& yaw_rad) {
  std::size_t lit = 0;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (i > 0 && !(lines[i].time_s > lines[i - 1].time_s)) {
      return fail(Fault::bad_input,
                  "frame {} at {:.4f} s is not later than the one before, at {:.4f} s", i,
                  lines[i].time_s, lines[i - 1].time_s);
    }
    lit += lines[i].line.points.size() >= rows_of_a_line ? 1U : 0U;
  }
  if (lit < min_profiles) {
    return fail(Fault::not_found, "a laser line is seen in {} of {} frames, {} needed", lit,
                lines.size(), min_profiles);
  }
  const double span_s = lines.back().time_s - lines.front().time_s;
  if (span_s > max_sweep_s) {
    return fail(Fault::bad_input,
                "the sweep's frames span {:.0f} s, {:.0f} at most: are the times in seconds?",
                span_s, max_sweep_s);
  }
  const auto [low, high] = std::minmax_element(yaw_rad.begin(), yaw_rad.end());
  if (*high - *low < min_turn_rad) {
    return fail(
        Fault::bad_input,
        "the unit turned by {:.2f} degrees in {} frames, {:.0f} needed; is the motor stalled?",
        to_deg(*high - *low), lines.size(), to_deg(min_turn_rad));
  }
  return {};
}

// Triangulates all lines and turns them by their yaw.
ProfileGrid place_in_couch(std::span<const TimedLine> lines, std::span<const double> yaw_rad,
                           const ScannerCalibration& calibration) {
  const CameraModel& camera = calibration.camera;
  ProfileGrid grid(lines.size(), static_cast<std::size_t>(camera.height_px));
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (lines[i].line.points.size() < rows_of_a_line) continue;
    const Transform couch_from_camera = calibration.couch_from_camera_at(yaw_rad[i]);
    const std::size_t before = i > 0 ? i - 1 : i;
    const std::size_t after = std::min(i + 1, lines.size() - 1);
    const double step_rad = std::abs(yaw_rad[after] - yaw_rad[before]) /
                            std::max<double>(1.0, static_cast<double>(after - before));
    for (const LinePoint& seen : lines[i].line.points) {
      if (seen.row < 0 || seen.row >= camera.height_px) continue;
      const auto point = triangulate(calibration, static_cast<double>(seen.column_px), seen.row);
      if (!point) continue;
      // On a surface tilted by 75 degrees neighbours lie four times as far apart.
      constexpr double steepest = 4.0;
      const double range_m = point->norm();
      const double deviation_m =
          static_cast<double>(seen.deviation_px) * range_m_per_px(calibration, *point);
      grid.light(i, static_cast<std::size_t>(seen.row),
                 {.point = couch_from_camera * *point,
                  .amplitude_dn = seen.amplitude_dn,
                  .deviation_m = static_cast<float>(deviation_m),
                  .reach_rows_m =
                      static_cast<float>(steepest * range_m / camera.fy_px + 3.0 * deviation_m),
                  .reach_profiles_m =
                      static_cast<float>(steepest * range_m * step_rad + 3.0 * deviation_m),
                  .unsure = seen.deviation_px > unsure_px});
    }
  }
  return grid;
}

constexpr std::size_t error_row_step = 8;  // the expected error is computed for every eighth row

// Sums over the points with an expected error.
struct ErrorSum {
  double systematic_m2 = 0.0, noise_m2 = 0.0;  // along the normal
  double scatter = 0.0;  // squared distances from the neighbours, of those that noise explains
  double points = 0.0;
};

/// How far a point is moved along its line of sight, and its standard deviation there then.
struct Drawn {
  double towards_eye_m = 0.0, deviation_m = 0.0;
  double scatter = 1.0;  ///< squared distance from the neighbours, of that which noise explains
};

constexpr double square(double x) {
  return x * x;
}

// A noisy point is drawn to where its neighbours see the surface, in the proportion of what both do
// not know: its noise against theirs and what skin bends by among them. A bright point, say on an
// edge, stays where it is.
Drawn draw(const NeighbourFilter::Verdict& verdict, std::size_t row, double deviation_m,
           double cosine) {
  constexpr double bend_m = 0.2_mm;  // of skin with a radius of 40 mm
  const double neighbours = verdict.neighbours[row];
  if (neighbours < 1.0) return {.deviation_m = deviation_m};
  const double noise_m2 = square(deviation_m * cosine);
  const double apart_m2 = noise_m2 + noise_m2 / neighbours + square(bend_m);
  const double share = noise_m2 / apart_m2;
  const auto offset_m = static_cast<double>(verdict.offset_m[row]);
  return {.towards_eye_m = share * offset_m / cosine,
          .deviation_m = std::sqrt(1.0 - share) * deviation_m,
          .scatter = square(offset_m) / apart_m2};
}

// Adds one way of the unit over the scene, as its own grid.
void add_way(std::span<const TimedLine> lines, std::span<const double> yaw_rad,
             std::span<const double> breath_m, const ScannerCalibration& calibration,
             ErrorSum& errors, Scan& scan) {
  const ProfileGrid grid = place_in_couch(lines, yaw_rad, calibration);
  PointCloud& cloud = scan.cloud_in_couch;
  NeighbourFilter neighbours(grid);
  const double turn_s = lines.back().time_s - lines.front().time_s;
  const double rad_per_s = turn_s > 0.0 ? (yaw_rad.back() - yaw_rad.front()) / turn_s : 0.0;
  // The breath moves the person along the central line of sight.
  const Vector3 away =
      calibration.couch_from_camera_at(0.5 * (yaw_rad.front() + yaw_rad.back())).linear().col(2);
  for (std::size_t i = 0; i < grid.profiles(); ++i) {
    const Vector3 eye = calibration.couch_from_camera_at(yaw_rad[i]).translation();
    const ExpectedError expected(calibration, yaw_rad[i], rad_per_s);
    const Vector3 breath = breath_m.empty() ? Vector3::Zero() : Vector3(breath_m[i] * away);
    const NeighbourFilter::Verdict& verdict = neighbours.next();
    int lit = 0;
    scan.first_of_frame.push_back(cloud.size());
    for (std::size_t row = 0; row < grid.rows(); ++row) {
      if (!grid.lit(i, row)) continue;
      ++lit;
      if (verdict.trusted[row] == 0.0F) continue;
      const Vector3 point = grid.point(i, row);
      const Vector3 normal =
          Eigen::Vector3f(verdict.normal[0][row], verdict.normal[1][row], verdict.normal[2][row])
              .cast<double>();
      const Vector3 to_eye = (eye - point).normalized();
      const double cosine = normal.dot(to_eye);
      if (std::abs(cosine) < min_cosine) continue;
      const Drawn drawn = draw(verdict, row, static_cast<double>(grid.deviation_m(i, row)), cosine);
      const Vector3 place = point + drawn.towards_eye_m * to_eye;
      scan.rows.push_back(static_cast<std::uint16_t>(row));
      cloud.points.push_back(place.z() < breathing_from_m ? place : Vector3(place + breath));
      cloud.normals.push_back(cosine > 0.0 ? normal : Vector3(-normal));
      cloud.amplitude.push_back(grid.amplitude_dn(i, row));
      cloud.deviation_m.push_back(static_cast<float>(drawn.deviation_m));
      if (row % error_row_step == 0) {
        constexpr double max_scatter = 9.0;  // an edge is no noise
        errors.systematic_m2 += expected.variance_m2(place, normal, 0.0);
        errors.noise_m2 += square(drawn.deviation_m * cosine);
        errors.scatter += std::min(drawn.scatter, max_scatter);
        errors.points += 1.0;
      }
    }
    scan.rows_lit += lit;
    scan.profiles += lit > 0 ? 1 : 0;
    scan.ambiguous_rows += lines[i].line.ambiguous_rows;
  }
}

}  // namespace

Result<Scan> make_cloud(std::span<const TimedLine> lines, std::span<const YawReading> readings,
                        const ScannerCalibration& calibration, double max_lost_share) {
  std::vector<double> times_s;
  times_s.reserve(lines.size());
  for (const TimedLine& line : lines) times_s.push_back(line.time_s);
  auto yaw_rad = yaw_at(times_s, readings, calibration.latency_s);
  if (!yaw_rad) return tl::unexpected(yaw_rad.error());
  if (const auto good = check(lines, *yaw_rad); !good) return tl::unexpected(good.error());
  const auto whole = check_sequence(lines, readings, *yaw_rad, max_lost_share);
  if (!whole) return tl::unexpected(whole.error());

  Scan scan;
  scan.sweep_s = times_s.back() - times_s.front();
  std::size_t rows_seen = 0;
  for (const TimedLine& line : lines) rows_seen += line.line.points.size();
  PointCloud& cloud = scan.cloud_in_couch;
  cloud.points.reserve(rows_seen);
  cloud.normals.reserve(rows_seen);
  cloud.amplitude.reserve(rows_seen);
  cloud.deviation_m.reserve(rows_seen);
  scan.rows.reserve(rows_seen);
  scan.first_of_frame.reserve(lines.size() + 1);

  ErrorSum errors;
  const auto turn = turning_point(lines, *yaw_rad);
  if (turn) {
    // Noise of the slopes biases each latency estimate towards zero, so the estimate is applied and
    // repeated.
    TwoWay two;
    double latency_error_s = 0.0;
    constexpr double settled_s = 1e-4;
    for (int look = 0; look < 6; ++look) {
      two = compare_ways(lines, *yaw_rad, *turn, calibration);
      latency_error_s += two.compared.latency_error_s;
      yaw_rad = yaw_at(times_s, readings, calibration.latency_s + latency_error_s);
      if (!yaw_rad) return tl::unexpected(yaw_rad.error());
      if (std::abs(two.compared.latency_error_s) < settled_s) break;
    }
    two.compared.latency_error_s = latency_error_s;
    scan.ways = two.compared;
    const std::span<const double> yaw = *yaw_rad;
    const std::span<const double> breath = two.breath_at_m;
    add_way(lines.first(*turn), yaw.first(*turn), breath.first(*turn), calibration, errors, scan);
    add_way(lines.subspan(*turn), yaw.subspan(*turn), breath.subspan(*turn), calibration, errors,
            scan);
  } else {
    add_way(lines, *yaw_rad, {}, calibration, errors, scan);
  }
  scan.first_of_frame.push_back(cloud.size());
  if (cloud.points.empty()) {
    return fail(Fault::not_found, "{} rows are lit, but no surface lies under them", scan.rows_lit);
  }
  // Hair, drops and speckle scatter more than the noise of the pictures says.
  const double points = std::max(1.0, errors.points);
  scan.expected_error_m = std::sqrt(
      (errors.systematic_m2 + std::max(1.0, errors.scatter / points) * errors.noise_m2) / points);
  return scan;
}

}  // namespace tuina::scanner
