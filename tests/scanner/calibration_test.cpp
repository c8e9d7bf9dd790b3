// SPDX-License-Identifier: Apache-2.0
#include "tuina/scanner/calibration.hpp"

#include <doctest/doctest.h>

#include <string>

#include "tests/reason.hpp"
#include "tuina/core/random.hpp"
#include "tuina/core/units.hpp"

using namespace tuina;
using namespace tuina::scanner;

namespace {

const std::string good =
    "[camera]\nwidth_px = 640\nheight_px = 480\nfx_px = 1041.67\nfy_px = 1041.67\ncx_px = "
    "319.5\ncy_px = 239.5\n"
    "distortion = [0, 0, 0, 0, 0]\n"
    "[laser]\nnormal = [0.9563, 0.0, 0.2924]\ndistance_m = 0.1912\n"
    "[yaw_axis]\npoint_in_camera_m = [0.1, 0.0, 0.0]\ndirection_in_camera = [0.0, -1.0, "
    "0.0]\nlatency_s = 0.0\n"
    "[couch_from_camera]\nrotation = [[1,0,0],[0,0,1],[0,-1,0]]\ntranslation_m = [0.0, 1.1, "
    "0.35]\n";

std::string with(const std::string& from, const std::string& to) {
  std::string text = good;
  const auto at = text.find(from);
  REQUIRE(at != std::string::npos);
  return text.replace(at, from.size(), to);
}

}  // namespace

TEST_CASE("the calibration of the documentation is read, typed digits made exact") {
  const auto read = parse_calibration(good, "calibration.toml");
  REQUIRE(read.has_value());
  CHECK(read->camera.fx_px == 1041.67);
  CHECK(read->laser_normal_in_camera.norm() == doctest::Approx(1.0).epsilon(1e-14));
  CHECK(read->laser_distance_m == 0.1912);
  CHECK((read->couch_from_camera * Vector3(0, 0, 1)).isApprox(Vector3(0.0, 2.1, 0.35)));
}

TEST_CASE("what is written is read back bit for bit") {
  Random random = make_random(7, "calibrations");
  for (int i = 0; i < 200; ++i) {
    ScannerCalibration one;
    one.camera.fx_px = uniform(random, 500.0, 2000.0);
    one.camera.distortion = {gaussian(random, 0.1), gaussian(random, 0.1), 1e-7, 0.0, -0.0};
    one.laser_normal_in_camera =
        Vector3(uniform(random, 0.5, 1), gaussian(random, 0.1), gaussian(random, 0.3)).normalized();
    one.latency_s = gaussian(random, 0.1);
    one.couch_from_camera =
        Eigen::Translation3d(0.0, gaussian(random, 1.0), 1.0 / 3.0) *
        Eigen::AngleAxisd(uniform(random, -3, 3), Vector3(1, 2, 3).normalized());
    const auto read = parse_calibration(to_toml(one), "written");
    REQUIRE(read.has_value());
    CHECK(read->camera.fx_px == one.camera.fx_px);
    CHECK(read->camera.distortion == one.camera.distortion);
    CHECK(read->laser_normal_in_camera == one.laser_normal_in_camera);
    CHECK(read->latency_s == one.latency_s);
    CHECK(read->couch_from_camera.matrix() == one.couch_from_camera.matrix());
  }
}

TEST_CASE("errors of a calibration may be left out, are kept bit for bit, and small ones too") {
  auto one = *parse_calibration(good, "calibration.toml");
  CHECK_FALSE(one.errors.has_value());
  one.latency_s = 5e-6;
  one.errors = CalibrationErrors{
      .depth_m = {0.5, 2.0}, .range_m = {1e-4, 16e-4}, .axis_point_m = 5e-6, .latency_s = 1e-9};
  const auto read = parse_calibration(to_toml(one), "written");
  REQUIRE_MESSAGE(read.has_value(), test::reason(read));
  REQUIRE(read->errors.has_value());
  CHECK(read->latency_s == 5e-6);
  CHECK(read->errors->axis_point_m == 5e-6);
  CHECK(read->errors->latency_s == 1e-9);
  CHECK(read->errors->range_m == one.errors->range_m);
  // Between and beyond the depths that are told, the error grows like a power of the depth.
  CHECK(read->errors->range_at_m(1.0) == doctest::Approx(4e-4));
  CHECK(read->errors->range_at_m(4.0) == doctest::Approx(64e-4));

  const std::string section =
      "[standard_deviations]\ndepth_m = [0.5, 1.0]\nrange_m = [1e-4, 2e-4]\n"
      "axis_direction_rad = 1e-4\naxis_point_m = 1e-3\nlatency_s = 1e-3\n";
  CHECK(parse_calibration(good + section, "cal.toml").has_value());
  const std::pair<std::string, std::string> mistakes[] = {
      {"[0.5, 1.0]", "[1.0, 0.5]"}, {"[0.5, 1.0]", "[0.5]"},       {"[0.5, 1.0]", "[]"},
      {"[0.5, 1.0]", "0.5"},        {"[1e-4, 2e-4]", "[1e-4, 0]"}, {"[1e-4, 2e-4]", "[1e-4, nan]"},
      {"latency_s = 1e-3\n", ""}};
  for (const auto& [from, to] : mistakes) {
    std::string text = section;
    text.replace(text.find(from), from.size(), to);
    CAPTURE(text);
    CHECK_FALSE(parse_calibration(good + text, "cal.toml").has_value());
  }
}

TEST_CASE("every mistake in a calibration is refused with its line") {
  struct Mistake {
    std::string from, to, said;
  };
  const Mistake mistakes[] = {
      {"fx_px = 1041.67", "fx_px = nan", "cal.toml:4: camera.fx_px"},
      {"fx_px = 1041.67", "fx_px = \"wide\"", "cal.toml:4: camera.fx_px"},
      {"fx_px = 1041.67", "fx_px = -5.0", "cal.toml:4: camera.fx_px"},
      {"width_px = 640", "width_px = 0", "cal.toml:2: camera.width_px"},
      {"width_px = 640", "width_px = 640.5", "cal.toml:2: camera.width_px"},
      {"width_px = 640", "widht_px = 640",
       "cal.toml:2: `camera.widht_px` is unknown; is `width_px` meant?"},
      {"[0, 0, 0, 0, 0]", "[0, 0, 0, 0]", "cal.toml:8: camera.distortion"},
      {"[0, 0, 0, 0, 0]", "[0, 0, inf, 0, 0]", "cal.toml:8: camera.distortion"},
      {"[0.9563, 0.0, 0.2924]", "[0.9, 0.0, 0.2924]", "cal.toml:10: laser.normal has length"},
      {"distance_m = 0.1912", "distance_m = 0.0", "light plane through the camera"},
      {"[0.0, -1.0, 0.0]", "[0.0, 0.0, 0.0]", "cal.toml:14: yaw_axis.direction_in_camera"},
      {"[0,-1,0]]", "[0,1,0]]", "cal.toml:17: couch_from_camera.rotation is no rotation"},
      {"[0,-1,0]]", "[0,-1.1,0]]", "is no rotation"},
      {"[0,-1,0]]", "[0,-1]]", "couch_from_camera.rotation"},
      {"latency_s = 0.0\n", "", "yaw_axis.latency_s is missing"},
      {"[laser]", "[lasre]", "`lasre` is unknown; is `laser` meant?"},
      {"[laser]", "[laser", "cal.toml:9"},
  };
  for (const Mistake& mistake : mistakes) {
    const auto read = parse_calibration(with(mistake.from, mistake.to), "cal.toml");
    CAPTURE(mistake.to);
    REQUIRE_FALSE(read.has_value());
    CHECK(read.error().fault == Fault::bad_input);
    CHECK_MESSAGE(read.error().message.find(mistake.said) != std::string::npos,
                  read.error().message);
  }
  CHECK_FALSE(parse_calibration("", "empty").has_value());
  CHECK(read_calibration("/nowhere/calibration.toml").error().fault == Fault::file);
}

TEST_CASE("no mangled calibration file breaks the reader") {
  Random random = make_random(11, "mangled calibration");
  for (int i = 0; i < 3000; ++i) {
    std::string text = good;
    for (int k = 0; k < 3; ++k) {
      const auto at =
          static_cast<std::size_t>(uniform(random, 0.0, static_cast<double>(text.size()) - 1.0));
      const auto byte = static_cast<char>(uniform(random, 0.0, 255.0));
      if (uniform(random, 0.0, 1.0) < 0.5) {
        text[at] = byte;
      } else {
        text.erase(at, 1 + static_cast<std::size_t>(uniform(random, 0.0, 9.0)));
      }
    }
    const auto read = parse_calibration(text, "mangled");
    if (read) {
      CHECK(read->couch_from_camera.matrix().allFinite());
      CHECK(read->laser_normal_in_camera.norm() == doctest::Approx(1.0));
    } else {
      CHECK_FALSE(read.error().message.empty());
    }
  }
}

TEST_CASE("turning the unit turns the camera about the axis, and back") {
  auto calibration = parse_calibration(good, "calibration.toml").value();
  const Vector3 on_axis =
      calibration.axis_point_in_camera + 0.3 * calibration.axis_direction_in_camera;
  const Transform still = calibration.couch_from_camera_at(0.0);
  const Transform turned = calibration.couch_from_camera_at(20.0_deg);
  CHECK((turned * on_axis).isApprox(still * on_axis, 1e-12));
  // The axis of this calibration points up in couch, so a positive yaw is counter-clockwise seen
  // from above.
  const Vector3 before = still.linear() * Vector3::UnitZ();
  const Vector3 after = turned.linear() * Vector3::UnitZ();
  CHECK(before.cross(after).z() == doctest::Approx(std::sin(20.0_deg)));
}
