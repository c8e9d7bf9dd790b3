// SPDX-License-Identifier: Apache-2.0
#include "tuina/scanner/calibration.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "tuina/core/decompositions.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/core/io/toml_reader.hpp"

namespace tuina::scanner {
namespace {

// Directions and rotations with four digits are accepted and normalised; larger errors are
// mistakes.
constexpr double typed_tolerance = 2e-3;
constexpr double exact = 1e-12;
constexpr std::size_t max_listed = 100;

Vector3 vector_of(const std::vector<double>& numbers) {
  return {numbers[0], numbers[1], numbers[2]};
}

void read_number(const TomlTable& table, const char* key, double low, double high, double& value) {
  value = table.number(key, low, high).value_or(value);
}

void read_vector(const TomlTable& table, const char* key, double limit, Vector3& value) {
  if (const auto numbers = table.numbers(key, 3, limit)) value = vector_of(*numbers);
}

void read_direction(const TomlTable& table, const char* key, Vector3& value) {
  const auto numbers = table.numbers(key, 3, 10.0);
  if (!numbers) return;
  const Vector3 found = vector_of(*numbers);
  const double length = found.norm();
  if (std::abs(length - 1.0) > typed_tolerance) {
    return table.wrong(key, fmt::format("has length {:.4f}, a unit vector is needed", length));
  }
  value = std::abs(length - 1.0) > exact ? Vector3(found / length) : found;
}

// A list of numbers of any length.
std::vector<double> read_list(const TomlTable& table, const char* key, double high) {
  const auto list = table.list(key).value_or(std::vector<TomlValue>{});
  std::vector<double> found;
  for (const TomlValue& entry : list) {
    const auto number = entry.number();
    if (number && *number > 0.0 && *number <= high) found.push_back(*number);
  }
  if (table.has(key) && (found.empty() || found.size() != list.size() || found.size() > max_listed))
    table.wrong(key, fmt::format("is not 1 to {} numbers up to {}", max_listed, high));
  return found;
}

void read_rotation(const TomlTable& table, const char* key, Matrix3& value) {
  if (!table.has(key)) return;
  const auto rows = table.list(key).value_or(std::vector<TomlValue>{});
  Matrix3 found = Matrix3::Zero();
  bool good = rows.size() == 3;
  for (std::size_t i = 0; good && i < 3; ++i) {
    const auto row = rows[i].numbers(3);
    good = row.has_value();
    if (good) found.row(static_cast<Eigen::Index>(i)) = vector_of(*row).transpose();
  }
  // Written so that an overflowing product is no rotation.
  const double off = (found * found.transpose() - Matrix3::Identity()).cwiseAbs().maxCoeff();
  if (!good) return table.wrong(key, "is not three rows of three numbers");
  if (!(off <= typed_tolerance && found.determinant() > 0.0)) {
    return table.wrong(key, fmt::format("is no rotation: its rows are off from unit and upright by "
                                        "{:.4f}, its determinant is {:.4f}",
                                        off, found.determinant()));
  }
  if (off > exact) found = nearest_rotation(found);
  value = found;
}

// TOML floats need a point or an exponent, and no point directly before the exponent.
std::string float_of(double number) {
  std::string text = fmt::format("{}", number);
  if (text.find_first_of(".e") == std::string::npos) text += ".0";
  return text;
}

template <typename Numbers>
std::string list_of(const Numbers& numbers) {
  std::string text;
  for (const double number : numbers) text += fmt::format("{}{}", text.empty() ? "" : ", ", number);
  return "[" + text + "]";
}

}  // namespace

Transform ScannerCalibration::couch_from_camera_at(double yaw_rad) const {
  const Eigen::AngleAxisd turn(yaw_rad, axis_direction_in_camera);
  Transform turned = Transform::Identity();
  turned.linear() = turn.toRotationMatrix();
  turned.translation() = axis_point_in_camera - turned.linear() * axis_point_in_camera;
  return couch_from_camera * turned;
}

double CalibrationErrors::range_at_m(double at_m) const {
  if (depth_m.size() < 2) return range_m.front() * std::pow(at_m / depth_m.front(), 2);
  // Log-log interpolation and extrapolation: errors grow like a power of depth.
  std::size_t i = 1;
  while (i + 1 < depth_m.size() && depth_m[i] < at_m) ++i;
  const double power =
      std::log(range_m[i] / range_m[i - 1]) / std::log(depth_m[i] / depth_m[i - 1]);
  return range_m[i] * std::pow(std::max(at_m, 1e-3) / depth_m[i], power);
}

namespace {

CalibrationErrors read_errors(const TomlTable& table) {
  CalibrationErrors errors;
  table.only({}, {"depth_m", "range_m", "axis_direction_rad", "axis_point_m", "latency_s"});
  errors.depth_m = read_list(table, "depth_m", 100.0);
  errors.range_m = read_list(table, "range_m", 10.0);
  const bool rising = std::is_sorted(errors.depth_m.begin(), errors.depth_m.end(),
                                     [](double a, double b) { return a <= b; });
  if (!rising) table.wrong("depth_m", "does not rise from number to number");
  if (errors.depth_m.size() != errors.range_m.size()) {
    table.wrong("range_m", "does not have one number for each of depth_m");
  }
  read_number(table, "axis_direction_rad", 0.0, 10.0, errors.axis_direction_rad);
  read_number(table, "axis_point_m", 0.0, 10.0, errors.axis_point_m);
  read_number(table, "latency_s", 0.0, 5.0, errors.latency_s);
  return errors;
}

void read_camera(const TomlTable& table, CameraModel& camera) {
  table.only({}, {"width_px", "height_px", "fx_px", "fy_px", "cx_px", "cy_px", "distortion"});
  camera.width_px = table.whole("width_px", 16, 16384).value_or(camera.width_px);
  camera.height_px = table.whole("height_px", 16, 16384).value_or(camera.height_px);
  read_number(table, "fx_px", 10.0, 1e6, camera.fx_px);
  read_number(table, "fy_px", 10.0, 1e6, camera.fy_px);
  read_number(table, "cx_px", -1e5, 1e5, camera.cx_px);
  read_number(table, "cy_px", -1e5, 1e5, camera.cy_px);
  if (const auto numbers = table.numbers("distortion", camera.distortion.size(), 100.0)) {
    std::copy(numbers->begin(), numbers->end(), camera.distortion.begin());
  }
}

void read_laser(const TomlTable& table, ScannerCalibration& calibration) {
  table.only({}, {"normal", "distance_m"});
  read_direction(table, "normal", calibration.laser_normal_in_camera);
  read_number(table, "distance_m", -10.0, 10.0, calibration.laser_distance_m);
  if (std::abs(calibration.laser_distance_m) < 1e-3) {
    table.wrong("distance_m", "puts the light plane through the camera; no range can be told then");
  }
}

void read_pose(const TomlTable& table, Transform& couch_from_camera) {
  table.only({}, {"rotation", "translation_m"});
  Matrix3 rotation = Matrix3::Identity();
  Vector3 translation = Vector3::Zero();
  read_rotation(table, "rotation", rotation);
  read_vector(table, "translation_m", 100.0, translation);
  couch_from_camera.linear() = rotation;
  couch_from_camera.translation() = translation;
}

std::string to_toml(const CalibrationErrors& errors) {
  return fmt::format(
      "\n[standard_deviations]\n"
      "depth_m = {}\nrange_m = {}  # of the range at these depths, RMS over the image\n"
      "axis_direction_rad = {}\naxis_point_m = {}\nlatency_s = {}\n",
      list_of(errors.depth_m), list_of(errors.range_m), float_of(errors.axis_direction_rad),
      float_of(errors.axis_point_m), float_of(errors.latency_s));
}

}  // namespace

Result<ScannerCalibration> parse_calibration(std::string_view text, std::string_view name) {
  ScannerCalibration result;
  const auto read = read_toml(text, name, Fault::bad_input, [&](const TomlTable& root) {
    root.only({"standard_deviations"}, {"camera", "laser", "yaw_axis", "couch_from_camera"});
    if (const auto table = root.table("camera")) read_camera(*table, result.camera);
    if (const auto table = root.table("laser")) read_laser(*table, result);
    if (const auto table = root.table("yaw_axis")) {
      table->only({}, {"point_in_camera_m", "direction_in_camera", "latency_s"});
      read_vector(*table, "point_in_camera_m", 10.0, result.axis_point_in_camera);
      read_direction(*table, "direction_in_camera", result.axis_direction_in_camera);
      read_number(*table, "latency_s", -5.0, 5.0, result.latency_s);
    }
    if (const auto table = root.table("couch_from_camera")) {
      read_pose(*table, result.couch_from_camera);
    }
    if (const auto table = root.table("standard_deviations")) result.errors = read_errors(*table);
  });
  if (!read) return tl::unexpected(read.error());
  return result;
}

Result<ScannerCalibration> read_calibration(const std::filesystem::path& path) {
  constexpr std::size_t max_bytes = 1 << 20;
  const auto text = read_file(path, max_bytes);
  if (!text) return tl::unexpected(text.error());
  return parse_calibration(*text, path.string());
}

std::string to_toml(const ScannerCalibration& calibration) {
  const CameraModel& camera = calibration.camera;
  const Matrix3 rotation = calibration.couch_from_camera.linear();
  const Vector3 translation = calibration.couch_from_camera.translation();
  return fmt::format(
             "[camera]\nwidth_px = {}\nheight_px = {}\nfx_px = {}\nfy_px = {}\ncx_px = "
             "{}\ncy_px = "
             "{}\n"
             "distortion = {}\n\n"
             "[laser]  # points X of the light plane in the camera frame satisfy normal . X = "
             "distance_m\n"
             "normal = {}\ndistance_m = {}\n\n"
             "[yaw_axis]\npoint_in_camera_m = {}\ndirection_in_camera = {}\n"
             "latency_s = {}  # added to a yaw time to compare it with a frame time\n\n"
             "[couch_from_camera]  # at yaw 0\nrotation = [{}, {}, {}]\ntranslation_m = {}\n",
             camera.width_px, camera.height_px, float_of(camera.fx_px), float_of(camera.fy_px),
             float_of(camera.cx_px), float_of(camera.cy_px), list_of(camera.distortion),
             list_of(calibration.laser_normal_in_camera), float_of(calibration.laser_distance_m),
             list_of(calibration.axis_point_in_camera),
             list_of(calibration.axis_direction_in_camera), float_of(calibration.latency_s),
             list_of(Vector3(rotation.row(0))), list_of(Vector3(rotation.row(1))),
             list_of(Vector3(rotation.row(2))), list_of(translation)) +
         (calibration.errors ? to_toml(*calibration.errors) : std::string());
}

}  // namespace tuina::scanner
