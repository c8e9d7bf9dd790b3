// SPDX-License-Identifier: Apache-2.0
// A scan of a wall is a plane. The simulated laser scanner looks at a flat square of 60 cm, the
// cloud goes through the same code that sees a person, and a plane is fitted to it.
#include <fmt/core.h>

#include <Eigen/Eigenvalues>

#include "tuina/scanner.hpp"
#include "tuina/sim.hpp"

using namespace tuina;

int main() {
  constexpr std::uint64_t seed = 1;
  const Mesh wall = sim::make_patch({.centre_in_couch = Vector3(0.0, 0.0, 0.41), .size_m = 0.6});

  // The scanner as it is, and what its user knows of it after a careful calibration.
  sim::LaserScanner scanner(wall, BodyPosture::sitting, {}, seed);
  const auto calibration = sim::believed_calibration(scanner.true_calibration(), seed);
  const auto scan = scanner::scan_sweep(scanner, scanner, calibration);
  if (!scan) {
    fmt::print(stderr, "{}\n", scan.error().message);
    return 1;
  }

  // What lies lower is the seat in front of the wall.
  constexpr double seat_m = 50_mm;
  Vector3 mean = Vector3::Zero();
  Matrix3 spread = Matrix3::Zero();
  double count = 0.0;
  for (const Vector3& point : scan->cloud_in_couch.points) {
    if (point.z() < seat_m) continue;
    mean += point;
    spread += point * point.transpose();
    count += 1.0;
  }
  mean /= count;
  spread = spread / count - mean * mean.transpose();

  // The direction in which the points vary least is the normal, and how much they do is the error.
  const Eigen::SelfAdjointEigenSolver<Matrix3> axes(spread);
  const Vector3 normal = axes.eigenvectors().col(0);
  const double rms_m = std::sqrt(std::max(0.0, axes.eigenvalues()[0]));
  const double lean_rad = std::acos(std::min(1.0, std::abs(normal.y())));

  fmt::print("{:.0f} points of the wall from {} laser lines in {:.1f} s\n", count, scan->profiles,
             scan->sweep_s);
  fmt::print("{:.2f} mm RMS from a plane, which leans by {:.2f} degrees and stands {:.2f} mm off\n",
             to_mm(rms_m), to_deg(lean_rad), to_mm(std::abs(mean.y())));
  return rms_m < 1_mm ? 0 : 1;
}
