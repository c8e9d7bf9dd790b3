// SPDX-License-Identifier: Apache-2.0
#include "tuina/scanner/sweep.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "tests/reason.hpp"
#include "tuina/core/random.hpp"
#include "tuina/scanner/triangulation.hpp"

using namespace tuina;
using namespace tuina::scanner;

namespace {

constexpr double count_deg = 300.0 / 1024.0;

std::vector<double> frame_times(int frames) {
  std::vector<double> times;
  for (int i = 0; i < frames; ++i) times.push_back(i / 30.0);
  return times;
}

// A motor polled about every 20 ms, its clock behind by the latency.
template <typename Yaw>
std::vector<YawReading> poll(double from_s, double to_s, double latency_s, std::uint64_t seed,
                             Yaw&& yaw_deg) {
  Random random = make_random(seed, "polling");
  std::vector<YawReading> readings;
  for (double time_s = from_s; time_s < to_s; time_s += uniform(random, 0.014, 0.026)) {
    readings.push_back(
        {time_s - latency_s, from_deg(std::round(yaw_deg(time_s) / count_deg) * count_deg)});
  }
  return readings;
}

double worst_error_deg(const std::vector<double>& times, const std::vector<double>& yaw_rad,
                       auto&& yaw_deg) {
  double worst = 0.0;
  for (std::size_t i = 0; i < times.size(); ++i) {
    worst = std::max(worst, std::abs(to_deg(yaw_rad[i]) - yaw_deg(times[i])));
  }
  return worst;
}

ScannerCalibration upright_scanner() {
  ScannerCalibration scanner;
  scanner.camera = {.width_px = 480,
                    .height_px = 640,
                    .fx_px = 1041.67,
                    .fy_px = 1041.67,
                    .cx_px = 239.5,
                    .cy_px = 319.5};
  scanner.laser_normal_in_camera = {std::sin(73.0_deg), 0.0, std::cos(73.0_deg)};
  scanner.laser_distance_m = 0.2 * std::sin(73.0_deg);
  scanner.axis_point_in_camera = {0.1, 0.0, 0.0};
  scanner.latency_s = 0.12;
  return scanner;
}

// The lines that a scanner at the origin sees of a wall n . X = d, exact but for the given noise.
std::vector<TimedLine> lines_of_wall(const ScannerCalibration& scanner, const Vector3& n, double d,
                                     double noise_px, int frames, auto&& yaw_deg) {
  Random random = make_random(9, "wall");
  std::vector<TimedLine> lines;
  for (int i = 0; i < frames; ++i) {
    TimedLine line{.time_s = i / 30.0, .line = {}};
    const Transform world_from_camera =
        scanner.couch_from_camera_at(from_deg(yaw_deg(line.time_s)));
    const Vector3 n_in_camera = world_from_camera.linear().transpose() * n;
    const double d_in_camera = d - n.dot(world_from_camera.translation());
    for (int row = 0; row < 640; ++row) {
      const double y = (row - scanner.camera.cy_px) / scanner.camera.fy_px;
      // Wall, light plane and row: three planes meet in one point.
      Matrix3 planes;
      planes.row(0) = n_in_camera;
      planes.row(1) = scanner.laser_normal_in_camera;
      planes.row(2) = Vector3(0.0, 1.0, -y);
      const Vector3 point = planes.inverse() * Vector3(d_in_camera, scanner.laser_distance_m, 0.0);
      const double column = project(scanner.camera, point).x() + gaussian(random, noise_px);
      if (column < 0.0 || column > 479.0) continue;
      line.line.points.push_back({.row = row,
                                  .column_px = static_cast<float>(column),
                                  .amplitude_dn = 200.0F,
                                  .deviation_px = static_cast<float>(std::max(0.01, noise_px))});
    }
    lines.push_back(line);
  }
  return lines;
}

}  // namespace

TEST_CASE("the angle of a frame is known ten times finer than the motor tells it") {
  const auto times = frame_times(181);
  const auto even = [](double t) { return -18.0 + 6.0 * t; };
  const auto yaw = yaw_at(times, poll(-0.3, 6.3, 0.12, 1, even), 0.12);
  REQUIRE(yaw.has_value());
  CHECK(worst_error_deg(times, *yaw, even) < 0.1 * count_deg);
}

TEST_CASE("a motor that speeds up, stands and returns is followed too") {
  const auto times = frame_times(300);
  const auto wander = [](double t) { return 15.0 * std::sin(2.0 * pi * t / 11.0); };
  const auto yaw = yaw_at(times, poll(-0.3, 10.3, -0.05, 2, wander), -0.05);
  REQUIRE(yaw.has_value());
  CHECK(worst_error_deg(times, *yaw, wander) < 0.7 * count_deg);
}

TEST_CASE(
    "a unit that stands still for every frame is where the motor says, however late it shoots") {
  // A step of two counts every 0.2 s, 60 ms of it turning; the frame is taken just before the next.
  constexpr double step_s = 0.2;
  const auto steps = [](double t) {
    const double begun = std::floor(t / step_s);
    const double on_the_way = std::min(1.0, (t / step_s - begun) * step_s / 0.06);
    return -10.0 * count_deg + 2.0 * count_deg * std::clamp(begun - 1.0 + on_the_way, 0.0, 39.0);
  };
  std::vector<double> times;
  for (int i = 0; i < 40; ++i) times.push_back((i + 1.83) * step_s);
  const auto yaw = yaw_at(times, poll(-0.3, 9.0, 0.1, 6, steps), 0.1);
  REQUIRE(yaw.has_value());
  CHECK(worst_error_deg(times, *yaw, steps) < 1e-9);
}

TEST_CASE("a latency that is not known shows as a wrong angle") {
  const auto times = frame_times(181);
  const auto even = [](double t) { return -18.0 + 6.0 * t; };
  const auto yaw = yaw_at(times, poll(-0.3, 6.3, 0.12, 1, even), 0.0);
  REQUIRE(yaw.has_value());
  CHECK(worst_error_deg(times, *yaw, even) == doctest::Approx(0.72).epsilon(0.1));
}

TEST_CASE("readings that cannot give angles are refused") {
  const auto times = frame_times(30);
  CHECK_FALSE(yaw_at(times, {}, 0.0).has_value());
  const std::vector<YawReading> late = {{2.0, 0.0}, {3.0, 0.1}};
  CHECK(yaw_at(times, late, 0.0).error().message.find("outside") != std::string::npos);
  const std::vector<YawReading> back = {{0.0, 0.0}, {2.0, 0.1}, {1.0, 0.2}};
  CHECK_FALSE(yaw_at(times, back, 0.0).has_value());
  const std::vector<YawReading> broken = {{0.0, 0.0}, {2.0, std::nan("")}};
  CHECK_FALSE(yaw_at(times, broken, 0.0).has_value());
  // A reading that no motor could have turned to: 60 degrees within 20 ms.
  const std::vector<YawReading> torn = {{-0.5, 0.0}, {0.5, 0.05}, {0.52, 1.05}, {2.0, 0.1}};
  CHECK(yaw_at(times, torn, 0.0).error().message.find("yaw reading 2") != std::string::npos);
}

TEST_CASE("the scan of a wall is a plane, its normals upright to it, its deviation what it is") {
  const ScannerCalibration scanner = upright_scanner();
  const auto even = [](double t) { return -18.0 + 6.0 * t; };
  const Vector3 n = Vector3(0.2, -0.1, 1.0).normalized();
  const double d = 1.1;
  for (const double noise_px : {0.0, 0.034}) {
    const auto lines = lines_of_wall(scanner, n, d, noise_px, 181, even);
    const auto scan = make_cloud(lines, poll(-0.3, 6.3, 0.12, 1, even), scanner);
    REQUIRE(scan.has_value());
    CHECK(scan->profiles == 181);
    CHECK(scan->cloud_in_couch.size() > 100000);
    double error2 = 0.0;
    double worst_cosine = 1.0;
    double stated2 = 0.0;
    for (std::size_t i = 0; i < scan->cloud_in_couch.size(); ++i) {
      error2 += std::pow(n.dot(scan->cloud_in_couch.points[i]) - d, 2);
      stated2 += std::pow(static_cast<double>(scan->cloud_in_couch.deviation_m[i]), 2);
      worst_cosine = std::min(worst_cosine, -n.dot(scan->cloud_in_couch.normals[i]));
    }
    const auto count = static_cast<double>(scan->cloud_in_couch.size());
    const double rms_m = std::sqrt(error2 / count);
    CHECK(rms_m < (noise_px > 0.0 ? 0.26e-3 : 0.12e-3));
    CHECK(worst_cosine > std::cos(noise_px > 0.0 ? 8.0_deg : 0.5_deg));
    if (noise_px > 0.0) CHECK(std::sqrt(stated2 / count) == doctest::Approx(rms_m).epsilon(0.25));
  }
}

TEST_CASE("noisy points are drawn to their neighbours, and what is left is told") {
  const ScannerCalibration scanner = upright_scanner();
  const auto even = [](double t) { return -18.0 + 6.0 * t; };
  const Vector3 n = Vector3(0.2, -0.1, 1.0).normalized();
  const double d = 1.1;
  const auto lines = lines_of_wall(scanner, n, d, 0.2, 181, even);
  const auto scan = make_cloud(lines, poll(-0.3, 6.3, 0.12, 1, even), scanner);
  REQUIRE(scan.has_value());
  const auto count = static_cast<double>(scan->cloud_in_couch.size());
  double seen2 = 0.0, error2 = 0.0, stated2 = 0.0;
  for (const TimedLine& line : lines) {
    const Transform world_from_camera = scanner.couch_from_camera_at(from_deg(even(line.time_s)));
    for (const LinePoint& seen : line.line.points) {
      const auto point = triangulate(scanner, static_cast<double>(seen.column_px), seen.row);
      REQUIRE(point.has_value());
      seen2 += std::pow(n.dot(world_from_camera * *point) - d, 2) / count;
    }
  }
  for (std::size_t i = 0; i < scan->cloud_in_couch.size(); ++i) {
    error2 += std::pow(n.dot(scan->cloud_in_couch.points[i]) - d, 2) / count;
    stated2 += std::pow(static_cast<double>(scan->cloud_in_couch.deviation_m[i]), 2) / count;
  }
  CHECK(std::sqrt(seen2) > 1e-3);
  CHECK(std::sqrt(error2) < 0.45 * std::sqrt(seen2));
  CHECK(std::sqrt(stated2) == doctest::Approx(std::sqrt(error2)).epsilon(0.3));
  CHECK(scan->expected_error_m > 0.7 * std::sqrt(error2));
}

TEST_CASE("points between two surfaces and lone specks are left out") {
  const ScannerCalibration scanner = upright_scanner();
  const auto even = [](double t) { return -18.0 + 6.0 * t; };
  auto lines = lines_of_wall(scanner, Vector3::UnitZ(), 1.1, 0.0, 181, even);
  // The lower half of the rows sees a wall behind; one row in between sees a mixture of both.
  const auto behind = lines_of_wall(scanner, Vector3::UnitZ(), 1.4, 0.0, 181, even);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    auto& points = lines[i].line.points;
    for (auto& point : points) {
      if (point.row < 320) continue;
      for (const auto& far : behind[i].line.points) {
        if (far.row != point.row) continue;
        point.column_px =
            point.row == 320 ? 0.5F * (point.column_px + far.column_px) : far.column_px;
      }
    }
  }
  const auto scan = make_cloud(lines, poll(-0.3, 6.3, 0.12, 1, even), scanner);
  REQUIRE(scan.has_value());
  int between = 0;
  for (const Vector3& point : scan->cloud_in_couch.points) {
    between += std::abs(point.z() - 1.1) > 5e-3 && std::abs(point.z() - 1.4) > 5e-3 ? 1 : 0;
  }
  CHECK(between == 0);
  CHECK(scan->cloud_in_couch.size() > 80000);
}

TEST_CASE("an unsure profile is kept where its surface goes on on both sides, not where it ends") {
  const ScannerCalibration scanner = upright_scanner();
  const auto even = [](double t) { return -18.0 + 6.0 * t; };
  auto lines = lines_of_wall(scanner, Vector3::UnitZ(), 1.1, 0.034, 181, even);
  const auto grow_unsure = [](TimedLine& line, float off_px) {
    for (LinePoint& point : line.line.points) {
      point.column_px += off_px;
      point.deviation_px = 0.34F;
    }
  };
  grow_unsure(lines[90], 0.0F);
  // The wall ends at frame 120, where a part of the laser's sheet still touches it.
  for (std::size_t i = 121; i < lines.size(); ++i) lines[i].line.points.clear();
  grow_unsure(lines[120], -1.5F);
  const auto scan = make_cloud(lines, poll(-0.3, 6.3, 0.12, 1, even), scanner);
  REQUIRE_MESSAGE(scan.has_value(), test::reason(scan));
  REQUIRE(scan->first_of_frame.size() == lines.size() + 1);
  const auto points_of = [&](std::size_t frame) {
    return scan->first_of_frame[frame + 1] - scan->first_of_frame[frame];
  };
  CHECK(points_of(90) > 600);
  CHECK(points_of(119) > 600);
  CHECK(points_of(120) == 0);
}

TEST_CASE("forth and back over a still roof, the latency that was wrong is found to 3 ms") {
  ScannerCalibration scanner = upright_scanner();
  // 36 degrees forth in 6 s, then back in 4.5 s.
  const auto both = [](double t) { return t < 6.3 ? -18.0 + 6.0 * t : 19.8 - 8.0 * (t - 6.3); };
  // The upper half of the rows sees one side of it, the lower half the other.
  auto lines = lines_of_wall(scanner, Vector3(0.4, 0.0, 1.0).normalized(), 1.1, 0.034, 320, both);
  const auto other =
      lines_of_wall(scanner, Vector3(-0.4, 0.0, 1.0).normalized(), 1.1, 0.034, 320, both);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    std::erase_if(lines[i].line.points, [](const LinePoint& point) { return point.row >= 320; });
    for (const LinePoint& point : other[i].line.points) {
      if (point.row >= 320) lines[i].line.points.push_back(point);
    }
  }
  std::erase_if(lines, [](const TimedLine& line) {
    return line.time_s > 6.01 && line.time_s < 6.53;  // between the ways no frame is taken
  });
  const auto readings = poll(-0.3, 10.9, 0.12, 1, both);
  for (const double wrong_s : {0.0, 0.03, -0.08}) {
    scanner.latency_s = 0.12 + wrong_s;
    const auto scan = make_cloud(lines, readings, scanner);
    REQUIRE_MESSAGE(scan.has_value(), test::reason(scan));
    REQUIRE(scan->ways.has_value());
    CHECK(std::abs(scan->ways->latency_error_s + wrong_s) < 3e-3);
    CHECK(scan->ways->breath_m == 0.0);
  }
}

TEST_CASE("before a flat wall, where a turn and a step look alike, no latency is claimed") {
  ScannerCalibration scanner = upright_scanner();
  const auto both = [](double t) { return t < 6.3 ? -18.0 + 6.0 * t : 19.8 - 8.0 * (t - 6.3); };
  auto lines = lines_of_wall(scanner, Vector3(0.3, 0.1, 1.0).normalized(), 1.1, 0.034, 320, both);
  std::erase_if(lines,
                [](const TimedLine& line) { return line.time_s > 6.01 && line.time_s < 6.53; });
  scanner.latency_s += 0.03;
  const auto scan = make_cloud(lines, poll(-0.3, 10.9, 0.12, 1, both), scanner);
  REQUIRE(scan.has_value());
  REQUIRE(scan->ways.has_value());
  CHECK(scan->ways->latency_error_s == 0.0);
  CHECK(scan->ways->breath_m == 0.0);
}

TEST_CASE("frames that are lost or stand in the wrong order, and a motor that sticks, are named") {
  const ScannerCalibration scanner = upright_scanner();
  const auto even = [](double t) { return -18.0 + 6.0 * t; };
  const auto readings = poll(-0.3, 6.3, 0.12, 1, even);
  const auto lines =
      lines_of_wall(scanner, Vector3(0.4, 0.0, 1.0).normalized(), 1.1, 0.03, 181, even);
  const auto refusal = [&](const std::vector<TimedLine>& seen,
                           const std::vector<YawReading>& told) -> std::string {
    const auto scan = make_cloud(seen, told, scanner);
    return scan ? "nothing is refused" : scan.error().message;
  };
  CHECK(refusal(lines, readings) == "nothing is refused");

  auto lost = lines;
  for (std::size_t i = 170; i > 10; i -= 10) lost.erase(lost.begin() + static_cast<long>(i));
  CHECK(refusal(lost, readings).find("16 of 181 frames are lost") != std::string::npos);
  auto few = lines;
  few.erase(few.begin() + 50, few.begin() + 55);
  CHECK(refusal(few, readings) == "nothing is refused");

  auto swapped = lines;
  for (std::size_t i = 0; i + 1 < swapped.size(); i += 4) {
    std::swap(swapped[i].line, swapped[i + 1].line);
  }
  CHECK(refusal(swapped, readings).find("not in the order") != std::string::npos);

  const auto sticks = [](double t) {
    return -18.0 + 6.0 * (t < 3.0 ? t : t < 4.2 ? 3.0 : t - 1.2);
  };
  CHECK(refusal(lines, poll(-0.3, 6.3, 0.12, 1, sticks)).find("motor stood still at -0") !=
        std::string::npos);
}

TEST_CASE("a sweep that cannot be a scan is refused with the cause") {
  const ScannerCalibration scanner = upright_scanner();
  const auto even = [](double t) { return -18.0 + 6.0 * t; };
  const auto stalled = [](double) { return 3.0; };
  const auto lines = lines_of_wall(scanner, Vector3::UnitZ(), 1.1, 0.0, 181, even);
  const auto readings = poll(-0.3, 6.3, 0.12, 1, even);
  CHECK(make_cloud({}, readings, scanner).error().fault == Fault::not_found);
  CHECK(make_cloud(std::vector<TimedLine>(20), readings, scanner).has_value() == false);
  const auto still = make_cloud(lines, poll(-0.3, 6.3, 0.12, 1, stalled), scanner);
  REQUIRE_FALSE(still.has_value());
  CHECK(still.error().message.find("stalled") != std::string::npos);
  auto swapped = lines;
  std::swap(swapped[10].time_s, swapped[11].time_s);
  CHECK(make_cloud(swapped, readings, scanner).error().fault == Fault::bad_input);
  // Milliseconds in a column of seconds.
  auto slow_lines = lines;
  auto slow_readings = readings;
  for (TimedLine& line : slow_lines) line.time_s *= 1000.0;
  for (YawReading& reading : slow_readings) reading.time_s *= 1000.0;
  const auto slow = make_cloud(slow_lines, slow_readings, scanner);
  REQUIRE_FALSE(slow.has_value());
  CHECK(slow.error().message.find("are the times in seconds?") != std::string::npos);
}
