// SPDX-License-Identifier: Apache-2.0
#include "tuina/sim/scanner/laser_scanner.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "tests/reason.hpp"
#include "tuina/core/units.hpp"
#include "tuina/scanner/sweep.hpp"
#include "tuina/scanner/triangulation.hpp"
#include "tuina/sim/person/phantom.hpp"
#include "tuina/sim/scanner/ray_scene.hpp"

using namespace tuina;
using namespace tuina::sim;

namespace {

// A rectangle facing the scanner of one who sits: out of the back is +y.
Mesh wall(double x0, double x1, double z0, double z1, double y) {
  Mesh mesh;
  mesh.vertices = {{x0, y, z0}, {x1, y, z0}, {x1, y, z1}, {x0, y, z1}};
  mesh.triangles = {{0, 2, 1}, {0, 3, 2}};
  return mesh;
}

Mesh both(const Mesh& a, const Mesh& b) {
  Mesh mesh = a;
  const auto offset = static_cast<int>(a.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (const auto& t : b.triangles)
    mesh.triangles.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
  return mesh;
}

Result<scanner::Scan> scan_of(LaserScanner& scanner,
                              const scanner::ScannerCalibration& calibration) {
  return scanner::scan_sweep(scanner, scanner, calibration);
}

double nearest_m(const PointCloud& cloud, const Vector3& place) {
  double best2 = 1e9;
  for (const Vector3& point : cloud.points) best2 = std::min(best2, (point - place).squaredNorm());
  return std::sqrt(best2);
}

}  // namespace

TEST_CASE(
    "at yaw 0 the line falls onto the middle of the couch at 1.1 m, on whoever sits or lies") {
  for (const BodyPosture position : {BodyPosture::sitting, BodyPosture::prone}) {
    const auto truth = true_calibration(position);
    const double column =
        truth.camera.cx_px + truth.camera.fx_px * (200_mm / 1.1 - 1.0 / std::tan(73.0_deg));
    const auto point = scanner::triangulate(truth, column, truth.camera.cy_px);
    REQUIRE(point.has_value());
    const Vector3 in_couch = truth.couch_from_camera * *point;
    CHECK(std::abs(in_couch.x()) < 1e-9);
    const ScannerMount mount = usual_mount(position);
    const Vector3 eye = truth.couch_from_camera.translation();
    if (position == BodyPosture::sitting) {
      CHECK(in_couch.z() == doctest::Approx(mount.along_spine_m));
      CHECK(eye.y() > 1.0);
    } else {
      CHECK(in_couch.y() == doctest::Approx(-mount.along_spine_m));
      CHECK(eye.z() > 1.2);
    }
  }
}

TEST_CASE("a flat wall at 1.1 m comes back flat within 0.3 mm, in its place") {
  const Mesh mesh = wall(-0.3, 0.3, 0.1, 0.7, 0.03);
  LaserScanner scanner(mesh, BodyPosture::sitting, {}, 1);
  const auto scan = scan_of(scanner, scanner.true_calibration());
  REQUIRE(scan.has_value());
  const ScanTruth truth = compare_with_truth(scan->cloud_in_couch, mesh);
  CHECK(truth.points > 60000);
  CHECK(truth.rms_error_m < 0.3e-3);
  CHECK(truth.worst_error_m < 3e-3);
}

TEST_CASE("stop and shoot sees the same wall, in more time, and each profile is told as it comes") {
  const Mesh mesh = wall(-0.3, 0.3, 0.1, 0.7, 0.03);
  LaserScanner scanner(mesh, BodyPosture::sitting, {}, 1);
  scanner::SweepOptions options{.step_rad = 2.0 * 300.0_deg / 1024.0};
  std::vector<scanner::LiveProfile> live;
  options.on_profile = [&](const scanner::LiveProfile& profile) { live.push_back(profile); };
  const auto scan = scanner::scan_sweep(scanner, scanner, scanner.true_calibration(), options);
  REQUIRE_MESSAGE(scan.has_value(), test::reason(scan));
  // 62 frames of 0.586 degrees, 117 ms each.
  CHECK(scan->sweep_s == doctest::Approx(61 * 0.117));
  CHECK(compare_with_truth(scan->cloud_in_couch, mesh).rms_error_m < 0.3e-3);

  REQUIRE(live.size() == 62);
  std::size_t points = 0;
  double worst_m = 0.0;
  for (std::size_t i = 0; i < live.size(); ++i) {
    CHECK(live[i].number == static_cast<int>(i) + 1);
    points += live[i].points_in_couch.size();
    for (const Vector3& point : live[i].points_in_couch) {
      if (point.z() > 0.11) worst_m = std::max(worst_m, std::abs(point.y() - 0.03));
    }
  }
  CHECK(points > scan->cloud_in_couch.size() / 5);
  CHECK(worst_m < 10e-3);
}

TEST_CASE("what is seen is counted place by place, both ways too, and what is lost is missing") {
  const Mesh mesh = wall(-0.3, 0.3, 0.1, 0.7, 0.03);
  const auto share_of = [&](double dropped, bool both_ways) {
    LaserScanner scanner(mesh, BodyPosture::sitting, {}, 1, {.dropped_share = dropped});
    const scanner::SweepOptions options{.both_ways = both_ways, .max_lost_share = 1.0};
    const auto scan = scanner::scan_sweep(scanner, scanner, scanner.true_calibration(), options);
    REQUIRE_MESSAGE(scan.has_value(), test::reason(scan));
    REQUIRE(scan->rows.size() == scan->cloud_in_couch.size());
    REQUIRE(scan->first_of_frame.size() == scanner.visible().of_frame.size() + 1);
    return seen_share(scanner.visible(), *scan);
  };
  CHECK(share_of(0.0, false) > 0.98);
  const double both_ways = share_of(0.0, true);
  CHECK(both_ways > 0.98);
  CHECK(both_ways <= 1.0);
  CHECK(share_of(0.2, false) == doctest::Approx(0.8).epsilon(0.1));
}

TEST_CASE("a post hides what is behind it from the laser or from the camera") {
  const Mesh back = wall(-0.3, 0.3, 0.1, 0.7, -0.2);
  const Mesh post = wall(-0.02, 0.02, 0.1, 0.7, 0.3);
  LaserScanner scanner(both(back, post), BodyPosture::sitting, {}, 1);
  const auto scan = scan_of(scanner, scanner.true_calibration());
  REQUIRE(scan.has_value());
  int on_post = 0;
  int in_shadow = 0;
  int beside = 0;
  for (const Vector3& point : scan->cloud_in_couch.points) {
    on_post += std::abs(point.y() - 0.3) < 0.01 ? 1 : 0;
    const bool behind = std::abs(point.y() + 0.2) < 0.01;
    beside += behind && std::abs(point.x()) > 0.15 ? 1 : 0;
    // Seen from laser and camera, 200 mm apart, the shadows of a post half a metre in front lie on
    // both sides.
    in_shadow += behind && std::abs(point.x()) < 0.035 ? 1 : 0;
  }
  CHECK(on_post > 2000);
  CHECK(beside > 10000);
  CHECK(in_shadow < beside / 4);
  CHECK(compare_with_truth(scan->cloud_in_couch, both(back, post)).rms_error_m < 0.6e-3);
}

TEST_CASE(
    "the same seed gives the same frames, whatever the number of threads; another seed other "
    "ones") {
  const Mesh mesh = wall(-0.3, 0.3, 0.1, 0.7, 0.03);
  const auto first_frames = [&](std::uint64_t seed, int threads) {
    LaserScanner scanner(mesh, BodyPosture::sitting, {}, seed, {.threads = threads});
    REQUIRE(scanner.sweep(-3.0_deg, 3.0_deg, 6.0_deg).has_value());
    std::vector<std::uint8_t> pixels;
    while (scanner.arrived() == false) {
      const auto frame = scanner.next_frame(scanner::frame_timeout_s);
      pixels.insert(pixels.end(), frame->image.data.begin(), frame->image.data.end());
    }
    return pixels;
  };
  const auto once = first_frames(5, 1);
  CHECK(once.size() == std::size_t{31} * 640 * 480);
  CHECK(once == first_frames(5, 3));
  CHECK(once != first_frames(6, 1));
}

TEST_CASE("the motor speaks in counts, on a clock of its own, at speeds that it has") {
  LaserScanner scanner(wall(-0.3, 0.3, 0.1, 0.7, 0.03), BodyPosture::sitting, {}, 1);
  REQUIRE(scanner.sweep(-18.0_deg, 18.0_deg, 2.5_deg).has_value());  // becomes 4 steps: 2.664 deg/s
  const auto readings = scanner.readings();
  REQUIRE(readings.has_value());
  for (const auto& reading : *readings) {
    const double counts = to_deg(reading.yaw_rad) * 1024.0 / 300.0;
    CHECK(std::abs(counts - std::round(counts)) < 1e-9);
  }
  const double turned_deg = to_deg(readings->back().yaw_rad - readings->front().yaw_rad);
  const double took_s = readings->back().time_s - readings->front().time_s;
  CHECK(turned_deg / took_s == doctest::Approx(2.664).epsilon(0.01));
  CHECK(readings->front().time_s < -0.3);
  CHECK(scanner.sweep(-200.0_deg, 0.0, 6.0_deg).error().fault == Fault::device);
}

TEST_CASE(
    "a calibration from 40 poses errs as the reference says: about 0.5 mm at 1 m, more beyond") {
  double sum2[3] = {};
  constexpr int seeds = 60;
  const double depths_m[3] = {0.65, 1.0, 1.75};
  const auto truth = true_calibration(BodyPosture::sitting);
  for (int seed = 1; seed <= seeds; ++seed) {
    const auto believed = believed_calibration(truth, static_cast<std::uint64_t>(seed));
    for (int k = 0; k < 3; ++k) {
      for (int row = 20; row < 640; row += 100) {
        const double z = depths_m[k];
        const Vector3 point((truth.laser_distance_m - truth.laser_normal_in_camera.z() * z) /
                                truth.laser_normal_in_camera.x(),
                            (row - truth.camera.cy_px) / truth.camera.fy_px * z, z);
        const Vector2 pixel = scanner::project(truth.camera, point);
        const auto seen = scanner::triangulate(believed, pixel.x(), pixel.y());
        REQUIRE(seen.has_value());
        sum2[k] += std::pow(seen->norm() - point.norm(), 2) / (7.0 * seeds);
      }
    }
  }
  const double at_1_m = std::sqrt(sum2[1]);
  CHECK(at_1_m > 0.3e-3);
  CHECK(at_1_m < 0.7e-3);
  CHECK(std::sqrt(sum2[0]) < at_1_m);
  CHECK(std::sqrt(sum2[2]) > at_1_m);
}

TEST_CASE(
    "phantoms sitting and prone are scanned within 1 mm, from C7 to the sacrum and to both "
    "shoulders") {
  double sum2 = 0.0;
  int scans = 0;
  for (const BodyPosture position : {BodyPosture::sitting, BodyPosture::prone}) {
    for (const BodyType type : {BodyType::slim, BodyType::medium, BodyType::hefty}) {
      const auto seed = static_cast<std::uint64_t>(scans) + 1;
      const Person person = make_phantom(draw_phantom(type, seed), position);
      LaserScanner scanner(person.skin_in_couch, position, {}, seed);
      const auto scan = scan_of(scanner, believed_calibration(scanner.true_calibration(), seed));
      REQUIRE(scan.has_value());
      const ScanTruth truth = compare_with_truth(scan->cloud_in_couch, person.skin_in_couch);
      CAPTURE(person.name);
      CHECK(truth.points > 25000);
      CHECK(truth.rms_error_m < 1.4e-3);
      // What a scan expects of its error without knowing the truth is of the right size. It does
      // not count the place of the couch, which moves all points alike.
      const double apart_m =
          std::sqrt(std::pow(truth.rms_error_m, 2) - std::pow(truth.mean_error_m, 2));
      CHECK(scan->expected_error_m > 0.6 * apart_m);
      CHECK(scan->expected_error_m < 1.6 * apart_m);
      CHECK(scan->compute_ms > 0.0);
      sum2 += truth.rms_error_m * truth.rms_error_m;
      ++scans;
      for (const Acupoint& acupoint : person.acupoints) {
        CAPTURE(acupoint.name);
        CHECK(nearest_m(scan->cloud_in_couch, acupoint.at_in_couch) < 6e-3);
      }
      for (const char* name : {"C7", "sacrum_S2", "acromial_angle_L", "acromial_angle_R"}) {
        for (const Landmark& landmark : person.landmarks) {
          if (landmark.name != name) continue;
          CAPTURE(name);
          CHECK(nearest_m(scan->cloud_in_couch, landmark.at_in_couch) < 15e-3);
        }
      }
    }
  }
  CHECK(std::sqrt(sum2 / scans) < 1.0e-3);
}

TEST_CASE("a person who breathes is smeared by about the breath") {
  const Mesh mesh = wall(-0.3, 0.3, 0.1, 0.7, 0.03);
  LaserScanner scanner(mesh, BodyPosture::sitting, {.amplitude_m = 6.0_mm, .frequency_hz = 0.25},
                       1);
  const auto scan = scan_of(scanner, scanner.true_calibration());
  REQUIRE(scan.has_value());
  // (1 - cos) / 2 of 6 mm has the RMS sqrt(3/8) * 6 mm.
  CHECK(compare_with_truth(scan->cloud_in_couch, mesh).rms_error_m ==
        doctest::Approx(std::sqrt(3.0 / 8.0) * 6.0_mm).epsilon(0.15));
}

TEST_CASE("the distance to a surface is the distance to its nearest place") {
  const RayScene scene(wall(-1.0, 1.0, 0.0, 1.0, 0.0));
  CHECK(std::abs(scene.height_over({0.2, 0.3, 0.5})) == doctest::Approx(0.3));
  CHECK(scene.height_over({0.2, -0.3, 0.5}) ==
        doctest::Approx(-scene.height_over({0.2, 0.3, 0.5})));
  CHECK(std::abs(scene.height_over({2.0, 0.0, 0.5})) == doctest::Approx(1.0));
  CHECK(std::abs(scene.height_over({2.0, 1.0, 2.0})) == doctest::Approx(std::sqrt(3.0)));
}

TEST_CASE("what the simulated user believes to know of a calibration is as good as is said of it") {
  const auto truth = true_calibration(BodyPosture::sitting);
  double axis2 = 0.0;
  double point2 = 0.0;
  double latency2 = 0.0;
  constexpr int calibrations = 60;
  for (const double depth_m : {0.5, 0.65, 1.0, 1.75}) {
    double true2 = 0.0;
    double stated_m = 0.0;
    axis2 = point2 = latency2 = 0.0;
    for (int seed = 1; seed <= calibrations; ++seed) {
      const auto believed = believed_calibration(truth, static_cast<std::uint64_t>(seed));
      REQUIRE(believed.errors.has_value());
      const double error_m = range_error_m(truth, believed, depth_m);
      true2 += error_m * error_m / calibrations;
      stated_m = believed.errors->range_at_m(depth_m);
      const Vector3& axis = truth.axis_direction_in_camera;
      axis2 += believed.axis_direction_in_camera.cross(axis).squaredNorm() / calibrations;
      point2 +=
          (believed.axis_point_in_camera - truth.axis_point_in_camera).squaredNorm() / calibrations;
      latency2 += std::pow(believed.latency_s - truth.latency_s, 2) / calibrations;
    }
    CAPTURE(depth_m);
    CHECK(stated_m == doctest::Approx(std::sqrt(true2)).epsilon(0.25));
  }
  const auto stated = *believed_calibration(truth, 1).errors;
  CHECK(stated.axis_direction_rad == doctest::Approx(std::sqrt(0.5 * axis2)).epsilon(0.25));
  CHECK(stated.axis_point_m == doctest::Approx(std::sqrt(0.5 * point2)).epsilon(0.25));
  CHECK(stated.latency_s == doctest::Approx(std::sqrt(latency2)).epsilon(0.25));
}
