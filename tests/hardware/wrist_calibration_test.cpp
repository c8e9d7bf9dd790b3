// SPDX-License-Identifier: Apache-2.0
#include "tuina/hardware/wrist_calibration.hpp"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <random>

#include "tests/folder.hpp"
#include "tests/reason.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/core/units.hpp"
#include "tuina/hardware/device_file.hpp"

using namespace tuina;
using namespace tuina::hardware;
using test::reason;

namespace {

constexpr double g = gravity_m_per_s2;

/// What a sensor says of a tool of 0.34 kg, its parts weighed one by one: two masses on a stick,
/// not the one point that the fit believes in.
Wrench said(const Matrix3& base_from_tool, const Wrench& offset) {
  Wrench sum = offset;
  const std::array<std::pair<double, Vector3>, 2> parts = {
      std::pair{0.16, Vector3(0.0, 0.0, 0.0)}, std::pair{0.18, Vector3(-0.08, 0.01, 0.005)}};
  for (const auto& [mass_kg, at_m] : parts) {
    const Vector3 weight_n = base_from_tool.inverse() * Vector3(0.0, 0.0, -g * mass_kg);
    sum.force_n += weight_n;
    sum.torque_nm += at_m.cross(weight_n);
  }
  return sum;
}

const Wrench some_offset = {.force_n = {12.0, -3.0, 40.0}, .torque_nm = {0.3, -0.2, 0.1}};
constexpr double true_mass_kg = 0.34;
const Vector3 true_com_m = Vector3(-0.08, 0.01, 0.005) * (0.18 / 0.34);

/// Tilted to all sides by so much.
std::vector<WristPose> tilted(int count, double tilt_rad, double noise_n, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0.0, 1.0);
  const auto three = [&] { return Vector3(normal(random), normal(random), normal(random)); };
  std::vector<WristPose> poses;
  for (int i = 0; i < count; ++i) {
    const double around = 2.0 * pi * i / count;
    const double tilt = i % 3 == 0 ? 0.3 * tilt_rad : tilt_rad;
    const Matrix3 turn = Eigen::AngleAxisd(tilt, Vector3(std::cos(around), std::sin(around), 0.0))
                             .toRotationMatrix() *
                         Eigen::AngleAxisd(0.7 * i, Vector3::UnitZ()).toRotationMatrix();
    Wrench seen = said(turn, some_offset);
    seen.force_n += noise_n * three();
    seen.torque_nm += 0.02 * noise_n * three();
    poses.push_back({.base_from_tool = turn, .in_tool = seen});
  }
  return poses;
}

std::string refusal(const std::vector<WristPose>& poses) {
  const auto fit = fit_wrist(poses);
  if (fit) return "fitted";
  CHECK(fit.error().fault == Fault::bad_input);
  return fit.error().message;
}

bool has(const std::string& text, const char* part) {
  return text.find(part) != std::string::npos;
}

}  // namespace

TEST_CASE("twelve poses without noise give mass, centre and offset exactly") {
  const auto fit = fit_wrist(tilted(12, 75.0_deg, 0.0, 1));
  REQUIRE_MESSAGE(fit.has_value(), reason(fit));
  CHECK(fit->found.mass_kg == doctest::Approx(true_mass_kg).epsilon(1e-9));
  CHECK((fit->found.com_in_tool_m - true_com_m).norm() < 1e-9);
  CHECK((fit->found.offset_in_tool.force_n - some_offset.force_n).norm() < 1e-9);
  CHECK((fit->found.offset_in_tool.torque_nm - some_offset.torque_nm).norm() < 1e-9);
  CHECK(fit->force_rms_n < 1e-9);
  CHECK(fit->condition < 6.0);
}

TEST_CASE("what the fit says of its error is true of two hundred noisy sets") {
  double mass2 = 0.0, com2 = 0.0, offset2 = 0.0, told_mass2 = 0.0, told_com2 = 0.0;
  constexpr int sets = 200;
  for (unsigned seed = 1; seed <= sets; ++seed) {
    const auto fit = fit_wrist(tilted(12, 60.0_deg, 0.05, seed));
    REQUIRE_MESSAGE(fit.has_value(), reason(fit));
    mass2 += std::pow(fit->found.mass_kg - true_mass_kg, 2);
    com2 += (fit->found.com_in_tool_m - true_com_m).squaredNorm();
    offset2 += (fit->found.offset_in_tool.force_n - some_offset.force_n).squaredNorm();
    told_mass2 += fit->mass_sd_kg * fit->mass_sd_kg;
    told_com2 += fit->com_sd_m * fit->com_sd_m;
  }
  const auto rms = [](double sum2) { return std::sqrt(sum2 / sets); };
  MESSAGE("of 0.05 N of noise: mass " << 1e3 * rms(mass2) << " g, told " << 1e3 * rms(told_mass2)
                                      << " g; centre " << 1e3 * rms(com2) << " mm, told "
                                      << 1e3 * rms(told_com2) << " mm; offset " << rms(offset2)
                                      << " N");
  CHECK(rms(told_mass2) == doctest::Approx(rms(mass2)).epsilon(0.2).scale(0.0));
  CHECK(rms(told_com2) == doctest::Approx(rms(com2)).epsilon(0.2).scale(0.0));
  CHECK(rms(offset2) < 0.1);
}

TEST_CASE("poses that do not determine it, and readings that contradict it, are refused by name") {
  CHECK(has(refusal(tilted(5, 60.0_deg, 0.0, 1)), "5 poses; at least 6 are needed"));
  CHECK(has(refusal(tilted(12, 1.0_deg, 0.0, 1)), "do not tell weight from offset"));
  CHECK(has(refusal(tilted(12, 0.0_deg, 0.0, 1)), "do not tell weight from offset"));
  CHECK(has(refusal(tilted(12, 60.0_deg, 2.0, 1)), "fit a weight to"));
  const std::string unsure = refusal(tilted(6, 40.0_deg, 0.3, 3));
  CHECK_MESSAGE(has(unsure, "the noise leaves the mass uncertain"), unsure);
  auto poses = tilted(12, 60.0_deg, 0.02, 1);
  poses[6].in_tool.force_n.y() += 8.0;
  CHECK(has(refusal(poses), "line 8: the force is"));
  poses = tilted(12, 60.0_deg, 0.02, 1);
  for (WristPose& pose : poses) {
    pose.in_tool.force_n *= -1.0;
    pose.in_tool.torque_nm *= -1.0;
  }
  CHECK(has(refusal(poses), "`reversed`"));
  for (WristPose& pose : poses) pose.in_tool.force_n = some_offset.force_n;
  CHECK(has(refusal(poses), "do not turn with the tool"));
  for (std::size_t i = 0; i < poses.size(); ++i)
    poses[i].in_tool.force_n =
        1000.0 * (poses[i].base_from_tool.transpose() * Vector3(0.0, 0.0, -1.0));
  CHECK(has(refusal(poses), "is none; are forces in N"));
}

TEST_CASE("rotations the wrong way round are not taken for a tool") {
  auto poses = tilted(12, 75.0_deg, 0.01, 1);
  for (WristPose& pose : poses) pose.base_from_tool.transposeInPlace();
  CHECK(refusal(poses) != "fitted");
}

TEST_CASE("a calibration is read as it was written, beside the device file that names it") {
  const WristCalibration one = {
      .mass_kg = 0.1603, .com_in_tool_m = {-0.0123, 0.004, 0.1}, .offset_in_tool = some_offset};
  const auto again = parse_wrist_calibration(to_toml(one), "wrist.toml");
  REQUIRE_MESSAGE(again.has_value(), reason(again));
  CHECK(again->mass_kg == one.mass_kg);
  CHECK((again->com_in_tool_m - one.com_in_tool_m).norm() < 1e-15);
  CHECK(again->offset_in_tool.force_n == some_offset.force_n);
  CHECK(again->offset_in_tool.torque_nm == some_offset.torque_nm);
  const auto wrong =
      parse_wrist_calibration("[wrist]\nmass_kg = -1\noffset_n = [1, 2]\n", "w.toml");
  REQUIRE_FALSE(wrong.has_value());
  for (const char* part :
       {"w.toml:2: wrist.mass_kg = -1", "wrist.offset_n", "com_mm, wrist.offset_nm are missing"})
    CHECK_MESSAGE(has(wrong.error().message, part), wrong.error().message);
  const test::Folder folder;
  const std::string section =
      "kind = \"ati_udp\"\naddress = \"192.168.1.1:49152\"\ncounts_per_n = [1e6, 1e6, 1e6]\n"
      "counts_per_nm = [1e6, 1e6, 1e6]\nx = [0, 0, 1]\nz = [1, 0, 0]\nat_mm = [-60, 0, 0]\n";
  (void)folder.with("left.toml", to_toml(one));
  const std::string file = folder.with(
      "device.toml", "[wrist_sensor.left]\n" + section + "calibration = \"left.toml\"\n");
  const auto devices = read_device_file(file);
  REQUIRE_MESSAGE(devices.has_value(), reason(devices));
  const auto& wrist = devices->wrists[Arm::left];
  REQUIRE(wrist.has_value());
  REQUIRE(wrist->calibration.has_value());
  CHECK(wrist->calibration->mass_kg == one.mass_kg);
  CHECK_FALSE(devices->wrists[Arm::right].has_value());
  // Its z is the tool's x, so its y is z cross x of both: the tool's y turned over.
  CHECK(wrist->tool_from_sensor_turn.col(1).isApprox(Vector3(0, -1, 0), 1e-12));
  CHECK(wrist->tool_from_sensor_turn.determinant() == doctest::Approx(1.0));
  const std::string gone = folder.with(
      "gone.toml", "[wrist_sensor.left]\n" + section + "calibration = \"nowhere.toml\"\n");
  CHECK(has(read_device_file(gone).error().message, "nowhere.toml"));
}

TEST_CASE("what is wrong with a wrist sensor's section is said with line, key and value") {
  const auto file = parse_device_file(
      "[wrist_sensor.left]\nkind = \"hex_serial\"\naddress = \"ttyACM1\"\nrate_hz = 500\n"
      "counts_per_n = [10, 0, 10]\nx = [1, 0, 0]\nz = [1, 0, 0]\nat_mm = [0, 0, 0]\n"
      "[wrist_sensor.right]\nkind = \"ati_udp\"\naddress = \"192.168.1.1\"\nfilter = \"50Hz\"\n"
      "counts_per_n = [1, 1]\ncounts_per_nm = [1, 1, 1]\nx = [1, 0, 0]\nz = [0, 0, 1]\n",
      "device.toml");
  REQUIRE_FALSE(file.has_value());
  for (const char* part :
       {"device.toml:3: wrist_sensor.left.address = 'ttyACM1' is no path of a serial line",
        "rate_hz = 500 is not 1000", "counts_per_nm is missing", "wrist_sensor.left.counts_per_n",
        "not two directions of length 1", "filter is missing",
        "wrist_sensor.right.address = '192.168.1.1' is no IPv4 address and port",
        "wrist_sensor.right.filter = '50Hz' is set on the page", "wrist_sensor.right.counts_per_n",
        "at_mm is missing"})
    CHECK_MESSAGE(has(file.error().message, part), file.error().message);
}
