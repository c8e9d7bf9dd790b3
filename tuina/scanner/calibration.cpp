// SPDX-License-Identifier: Apache-2.0
#include "tuina/scanner/calibration.hpp"

#include <toml++/toml.h>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <vector>

#include "tuina/core/file.hpp"

namespace tuina::scanner {
namespace {

// Directions and rotations typed with four digits are taken and made exact; worse ones are a
// mistake.
constexpr double typed_tolerance = 2e-3;
constexpr double exact = 1e-12;
constexpr std::size_t most_listed = 100;

// Reads one section and collects every fault, so that a user corrects the file once and not ten
// times.
class Reader {
 public:
  Reader(const toml::table& file, std::string_view name) : file_(file), name_(name) {}

  void only_sections(std::initializer_list<std::string_view> known) {
    for (const auto& [key, node] : file_) refuse_unknown(key, node, known, "section");
  }

  void section(std::string_view section, std::initializer_list<std::string_view> known) {
    section_ = section;
    const toml::node* node = file_.get(section);
    table_ = node != nullptr ? node->as_table() : nullptr;
    if (table_ == nullptr) {
      missing_ += fmt::format("{}[{}]", missing_.empty() ? "" : ", ", section);
      return;
    }
    for (const auto& [key, value] : *table_) refuse_unknown(key, value, known, "key");
  }

  void number(std::string_view key, double low, double high, double& value) {
    const toml::node* node = find(key);
    if (node == nullptr) return;
    const auto found = number_in(*node);
    if (!found || *found < low || *found > high) {
      refuse(*node, key, fmt::format("is not a number from {} to {}", low, high));
      return;
    }
    value = *found;
  }

  void count(std::string_view key, int low, int high, int& value) {
    const toml::node* node = find(key);
    if (node == nullptr) return;
    const auto* found = node->as_integer();
    if (found == nullptr || found->get() < low || found->get() > high) {
      refuse(*node, key, fmt::format("is not a whole number from {} to {}", low, high));
      return;
    }
    value = static_cast<int>(found->get());
  }

  template <typename Vector>
  bool numbers(std::string_view key, double limit, Vector&& value) {
    const toml::node* node = find(key);
    return node != nullptr && numbers_in(*node, key, limit, value);
  }

  void direction(std::string_view key, Vector3& value) {
    Vector3 found = Vector3::Zero();
    if (!numbers(key, 10.0, found)) return;
    const double length = found.norm();
    if (std::abs(length - 1.0) > typed_tolerance) {
      refuse(*find(key), key, fmt::format("has length {:.4f}, a unit vector is needed", length));
      return;
    }
    value = std::abs(length - 1.0) > exact ? Vector3(found / length) : found;
  }

  [[nodiscard]] bool has(std::string_view section) const { return file_.contains(section); }

  // As many numbers as there are, in rising order or not.
  void list(std::string_view key, double high, std::vector<double>& value) {
    const toml::node* node = find(key);
    if (node == nullptr) return;
    const auto* array = node->as_array();
    std::vector<double> found;
    for (std::size_t i = 0; array != nullptr && i < std::min(array->size(), most_listed); ++i) {
      const auto number = number_in(*array->get(i));
      if (number && *number > 0.0 && *number <= high) found.push_back(*number);
    }
    if (array == nullptr || found.empty() || found.size() != array->size()) {
      refuse(*node, key, fmt::format("is not 1 to {} numbers up to {}", most_listed, high));
      return;
    }
    value = found;
  }

  void rotation(std::string_view key, Matrix3& value) {
    const toml::node* node = find(key);
    if (node == nullptr) return;
    const auto* rows = node->as_array();
    Matrix3 found = Matrix3::Zero();
    if (rows == nullptr || rows->size() != 3)
      return refuse(*node, key, "is not three rows of three numbers");
    for (std::size_t i = 0; i < 3; ++i) {
      Vector3 row = Vector3::Zero();
      if (!numbers_in(*rows->get(i), key, 10.0, row)) return;
      found.row(static_cast<Eigen::Index>(i)) = row.transpose();
    }
    const double off = (found * found.transpose() - Matrix3::Identity()).cwiseAbs().maxCoeff();
    if (off > typed_tolerance || found.determinant() < 0.0) {
      refuse(*node, key,
             fmt::format("is no rotation: its rows are off from unit and upright by {:.4f}, its "
                         "determinant is {:.4f}",
                         off, found.determinant()));
      return;
    }
    if (off > exact) {
      const Eigen::JacobiSVD<Matrix3> svd(found, Eigen::ComputeFullU | Eigen::ComputeFullV);
      found = svd.matrixU() * svd.matrixV().transpose();
    }
    value = found;
  }

  void refuse(std::string_view key, const std::string& why) {
    if (const toml::node* node = table_ != nullptr ? table_->get(key) : nullptr)
      refuse(*node, key, why);
  }

  [[nodiscard]] std::vector<std::string> faults() const {
    auto all = faults_;
    if (!missing_.empty()) all.push_back(fmt::format("{}: missing: {}", name_, missing_));
    return all;
  }

 private:
  const toml::node* find(std::string_view key) {
    if (table_ == nullptr) return nullptr;
    const toml::node* node = table_->get(key);
    if (node == nullptr) {
      const auto fault = fmt::format("{}: {}.{} is missing", name_, section_, key);
      if (faults_.empty() || faults_.back() != fault) faults_.push_back(fault);
    }
    return node;
  }

  static std::optional<double> number_in(const toml::node& node) {
    const auto value = node.is_number() ? node.value<double>() : std::nullopt;
    return value && std::isfinite(*value) ? value : std::nullopt;
  }

  template <typename Vector>
  bool numbers_in(const toml::node& node, std::string_view key, double limit, Vector&& value) {
    const auto* array = node.as_array();
    const auto size = static_cast<std::size_t>(value.size());
    bool good = array != nullptr && array->size() == size;
    for (std::size_t i = 0; good && i < size; ++i) {
      const auto found = number_in(*array->get(i));
      good = found && std::abs(*found) <= limit;
      if (good) value[static_cast<decltype(value.size())>(i)] = *found;
    }
    if (!good) {
      refuse(node, key, fmt::format("is not {} numbers between -{} and {}", size, limit, limit));
    }
    return good;
  }

  void refuse(const toml::node& node, std::string_view key, const std::string& why) {
    faults_.push_back(
        fmt::format("{}:{}: {}.{} {}", name_, node.source().begin.line, section_, key, why));
  }

  void refuse_unknown(const toml::key& key, const toml::node& node,
                      std::initializer_list<std::string_view> known, const char* what) {
    std::string names;
    for (const std::string_view name : known) {
      if (key.str() == name) return;
      names += names.empty() ? std::string(name) : fmt::format(", {}", name);
    }
    const auto line =
        key.source().begin.line != 0 ? key.source().begin.line : node.source().begin.line;
    faults_.push_back(
        fmt::format("{}:{}: unknown {} '{}'; known are {}", name_, line, what, key.str(), names));
  }

  const toml::table& file_;
  std::string_view name_;
  std::string_view section_;
  const toml::table* table_ = nullptr;
  std::vector<std::string> faults_;
  std::string missing_;  // sections
};

// A float of TOML has a point or an exponent, not a point before the exponent.
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
  // A straight line between logarithms, also beyond the ends: errors grow like a power of depth.
  std::size_t i = 1;
  while (i + 1 < depth_m.size() && depth_m[i] < at_m) ++i;
  const double power =
      std::log(range_m[i] / range_m[i - 1]) / std::log(depth_m[i] / depth_m[i - 1]);
  return range_m[i] * std::pow(std::max(at_m, 1e-3) / depth_m[i], power);
}

namespace {

CalibrationErrors read_errors(Reader& read) {
  CalibrationErrors errors;
  read.section("standard_deviations",
               {"depth_m", "range_m", "axis_direction_rad", "axis_point_m", "latency_s"});
  read.list("depth_m", 100.0, errors.depth_m);
  read.list("range_m", 10.0, errors.range_m);
  const bool rising = std::is_sorted(errors.depth_m.begin(), errors.depth_m.end(),
                                     [](double a, double b) { return a <= b; });
  if (!rising) read.refuse("depth_m", "does not rise from number to number");
  if (errors.depth_m.size() != errors.range_m.size()) {
    read.refuse("range_m", "does not have one number for each of depth_m");
  }
  read.number("axis_direction_rad", 0.0, 10.0, errors.axis_direction_rad);
  read.number("axis_point_m", 0.0, 10.0, errors.axis_point_m);
  read.number("latency_s", 0.0, 5.0, errors.latency_s);
  return errors;
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
  toml::table file;
  try {
    file = toml::parse(text, name);
  } catch (const toml::parse_error& error) {
    return fail(Fault::bad_input, "{}:{}: {}", name, error.source().begin.line,
                error.description());
  }
  ScannerCalibration result;
  CameraModel& camera = result.camera;
  Matrix3 rotation = Matrix3::Identity();
  Vector3 translation = Vector3::Zero();

  Reader read(file, name);
  read.only_sections({"camera", "laser", "yaw_axis", "couch_from_camera", "standard_deviations"});
  read.section("camera",
               {"width_px", "height_px", "fx_px", "fy_px", "cx_px", "cy_px", "distortion"});
  read.count("width_px", 16, 16384, camera.width_px);
  read.count("height_px", 16, 16384, camera.height_px);
  read.number("fx_px", 10.0, 1e6, camera.fx_px);
  read.number("fy_px", 10.0, 1e6, camera.fy_px);
  read.number("cx_px", -1e5, 1e5, camera.cx_px);
  read.number("cy_px", -1e5, 1e5, camera.cy_px);
  read.numbers("distortion", 100.0, camera.distortion);
  read.section("laser", {"normal", "distance_m"});
  read.direction("normal", result.laser_normal_in_camera);
  read.number("distance_m", -10.0, 10.0, result.laser_distance_m);
  if (std::abs(result.laser_distance_m) < 1e-3) {
    read.refuse("distance_m", "puts the light plane through the camera; no range can be told then");
  }
  read.section("yaw_axis", {"point_in_camera_m", "direction_in_camera", "latency_s"});
  read.numbers("point_in_camera_m", 10.0, result.axis_point_in_camera);
  read.direction("direction_in_camera", result.axis_direction_in_camera);
  read.number("latency_s", -5.0, 5.0, result.latency_s);
  read.section("couch_from_camera", {"rotation", "translation_m"});
  read.rotation("rotation", rotation);
  read.numbers("translation_m", 100.0, translation);
  if (read.has("standard_deviations")) result.errors = read_errors(read);
  if (!read.faults().empty()) {
    return fail(Fault::bad_input, "{}", fmt::join(read.faults(), "\n"));
  }
  result.couch_from_camera.linear() = rotation;
  result.couch_from_camera.translation() = translation;
  return result;
}

Result<ScannerCalibration> read_calibration(const std::filesystem::path& path) {
  constexpr std::size_t most_bytes = 1 << 20;
  const auto text = read_file(path, most_bytes);
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
