// SPDX-License-Identifier: Apache-2.0
#include "tuina/scanner/triangulation.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "tuina/core/random.hpp"
#include "tuina/core/units.hpp"

using namespace tuina;
using namespace tuina::scanner;

namespace {

// [thesis] 4.2: f = 6.25 mm, pixel 6 um, baseline L = 200 mm, laser leaning by alpha = 73 degrees.
constexpr double f_m = 6.25e-3;
constexpr double pixel_m = 6e-6;
constexpr double L_m = 0.2;

ScannerCalibration thesis_scanner() {
  // (4.11): with this lean the line of an infinitely far wall lies on the edge of the image.
  const double alpha = std::atan(f_m / (320.0 * pixel_m));
  ScannerCalibration scanner;
  scanner.camera.fx_px = scanner.camera.fy_px = f_m / pixel_m;
  scanner.laser_normal_in_camera = {std::sin(alpha), 0.0, std::cos(alpha)};
  scanner.laser_distance_m = L_m * std::sin(alpha);
  return scanner;
}

}  // namespace

TEST_CASE("[thesis] (4.11): the laser leans by 73 degrees") {
  CHECK(to_deg(std::atan(f_m / (320.0 * pixel_m))) == doctest::Approx(73.0).epsilon(0.002));
}

TEST_CASE(
    "[thesis] (4.1), (4.2): range from the distance x to the edge of the image is a special case") {
  const ScannerCalibration scanner = thesis_scanner();
  const double alpha = std::atan(f_m / (320.0 * pixel_m));
  for (const double D_m : {0.35, 0.65, 1.1, 1.75, 4.0}) {
    const double x_m = f_m * L_m / D_m;
    // Infinity is on the left edge, 320 px left of the centre; the line of a near wall lies to the
    // right.
    const double column = scanner.camera.cx_px - 320.0 + x_m / pixel_m;
    const auto point = triangulate(scanner, column, scanner.camera.cy_px);
    REQUIRE(point.has_value());
    CHECK(point->z() == doctest::Approx(D_m).epsilon(1e-9));
    const Vector3 laser(L_m, 0.0, 0.0);
    CHECK((*point - laser).norm() == doctest::Approx(D_m / std::sin(alpha)).epsilon(1e-9));
  }
}

TEST_CASE("[thesis] (4.3): range sensitivity is D^2 / fL, 4.8 mm per pixel at 1 m") {
  const ScannerCalibration scanner = thesis_scanner();
  for (const double D_m : {0.35, 0.65, 1.0, 1.75}) {
    const double column = scanner.camera.cx_px - 320.0 + f_m * L_m / D_m / pixel_m;
    const Vector3 point = triangulate(scanner, column, scanner.camera.cy_px).value();
    const double depth_m_per_px = range_m_per_px(scanner, point) * point.z() / point.norm();
    CHECK(depth_m_per_px == doctest::Approx(D_m * D_m / (f_m * L_m) * pixel_m).epsilon(1e-9));
    const Vector3 next = triangulate(scanner, column + 1e-3, scanner.camera.cy_px).value();
    CHECK((point.norm() - next.norm()) / 1e-3 ==
          doctest::Approx(range_m_per_px(scanner, point)).epsilon(0.02 + 0.1 * D_m));
  }
}

TEST_CASE("[thesis] (4.4), (4.5): D' with f' is the distance from the baseline, not the depth") {
  const ScannerCalibration scanner = thesis_scanner();
  const double x_m = f_m * L_m / 1.1;
  const double dy_m = 150.0 * pixel_m;
  const auto point = triangulate(scanner, scanner.camera.cx_px - 320.0 + x_m / pixel_m,
                                 scanner.camera.cy_px + 150.0);
  REQUIRE(point.has_value());
  const double f_prime_m = f_m / std::cos(std::atan(dy_m / f_m));
  CHECK(std::hypot(point->y(), point->z()) == doctest::Approx(f_prime_m * L_m / x_m).epsilon(1e-9));
  CHECK(point->z() == doctest::Approx(1.1).epsilon(1e-9));
}

TEST_CASE(
    "[thesis] (4.6)-(4.9): polar coordinates about the centre of the baseline give the same "
    "point") {
  const ScannerCalibration scanner = thesis_scanner();
  const double r_m = 0.5 * L_m;
  for (const double row : {60.0, 239.5, 430.0}) {
    const Vector3 point = triangulate(scanner, 180.0, row).value();
    const double b_m = L_m - point.x();  // along the baseline, from the laser
    const double D_m = point.z();
    const double D_prime_m = std::hypot(point.y(), point.z());
    const double R_m = std::hypot(r_m - b_m, D_m);
    const double R_n_m = std::hypot(r_m - b_m, D_prime_m);
    const double theta = b_m <= r_m ? pi - std::asin(D_m / R_m) : std::asin(D_m / R_m);
    const double phi = std::copysign(std::acos(R_m / R_n_m), -point.y());
    CHECK(R_m * std::cos(theta) == doctest::Approx(-(point.x() - r_m)).epsilon(1e-9));
    CHECK(R_m * std::sin(theta) == doctest::Approx(point.z()).epsilon(1e-9));
    CHECK(R_n_m * std::sin(phi) == doctest::Approx(-point.y()).epsilon(1e-9));
  }
}

TEST_CASE("a pixel's ray is undone by projecting, through any usual lens") {
  Random random = make_random(5, "lenses");
  for (int i = 0; i < 500; ++i) {
    CameraModel camera;
    camera.distortion = {gaussian(random, 0.15), gaussian(random, 0.1), gaussian(random, 2e-3),
                         gaussian(random, 2e-3), gaussian(random, 0.05)};
    const double column = uniform(random, 0.0, 639.0);
    const double row = uniform(random, 0.0, 479.0);
    const Vector2 back = project(camera, 1.3 * ray_through(camera, column, row));
    CHECK((back - Vector2(column, row)).norm() < 1e-6);
  }
}

TEST_CASE("a ray beside or along the light plane gives no point") {
  ScannerCalibration scanner = thesis_scanner();
  CHECK_FALSE(triangulate(scanner, scanner.camera.cx_px - 400.0, 240.0).has_value());
  const double edge = scanner.camera.cx_px - 320.0;
  const auto at_infinity = triangulate(scanner, edge, 240.0);
  if (at_infinity) CHECK(at_infinity->z() > 1e6);
}

TEST_CASE("the plane appears between the columns told, and nowhere else") {
  const ScannerCalibration scanner = thesis_scanner();
  const auto [first, last] = columns_between(scanner, 0.5, 1.75);
  CHECK(triangulate(scanner, first, 240.0)->z() > 1.75);
  CHECK(triangulate(scanner, last, 240.0)->z() < 0.5);
  CHECK(triangulate(scanner, last - 30, 240.0)->z() > 0.5);
}
