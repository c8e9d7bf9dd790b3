// SPDX-License-Identifier: Apache-2.0
#include "tuina/body/learn/labelled_body.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>

#include "tuina/core/io/file.hpp"
#include "tuina/core/io/json_fault.hpp"
#include "tuina/core/io/surface_file.hpp"
#include "tuina/core/io/text_lines.hpp"
#include "tuina/core/units.hpp"

namespace tuina::body {
namespace {

using nlohmann::json;

constexpr double max_span_m = 12.0;  // a body in centimetres spans 60 and more
constexpr double max_label_off_skin_m = 30_mm;
// The acromion and the waist of people lie up to 36 mm outside a surface cropped beside the back.
constexpr double max_landmark_off_skin_m = 50_mm;
constexpr double max_length_error = 0.1;  // of a unit normal

Vector3 vector_of(const json& numbers, const std::string& what) {
  Vector3 vector = Vector3::Constant(std::nan(""));
  if (numbers.is_array() && numbers.size() == 3) {
    for (std::size_t k = 0; k < 3; ++k)
      if (numbers[k].is_number()) vector[static_cast<Eigen::Index>(k)] = numbers[k].get<double>();
  }
  if (!vector.allFinite()) throw std::invalid_argument(what + " is not three finite numbers");
  return vector;
}

void add_acupoints(const json& object, std::vector<Acupoint>& acupoints) {
  for (const auto& [name, point] : object.items()) {
    acupoints.push_back({.name = name,
                         .at_in_couch = vector_of(point.at("position"), name + ".position"),
                         .normal_in_couch = vector_of(point.at("normal"), name + ".normal"),
                         .uncertainty_m = 0.0});
  }
}

/// Distances of labels from the skin, to half of the spacing of its samples.
class SkinDistance {
 public:
  explicit SkinDistance(const Mesh& skin) : samples_(sample(skin, 5_mm)) {}
  [[nodiscard]] double operator()(const Vector3& at) const {
    double nearest2 = std::numeric_limits<double>::max();
    for (const Vector3& p : samples_.points) nearest2 = std::min(nearest2, (p - at).squaredNorm());
    return std::sqrt(nearest2);
  }

 private:
  PointCloud samples_;
};

Result<void> check_label(const std::string& name, double off_m, double max_m,
                         const std::string& file) {
  if (off_m <= max_m) return {};
  if (off_m > max_span_m) {
    return fail(Fault::bad_input,
                "{}: {} lies {:.0f} m off the skin: is it in millimetres? metres are needed", file,
                name, off_m);
  }
  return fail(
      Fault::bad_input,
      "{}: {} lies {:.0f} mm off the skin, at most {:.0f} mm are right; metres in the frame "
      "of the skin are needed",
      file, name, to_mm(off_m), to_mm(max_m));
}

/// Points that follow each other from the head to the feet.
constexpr std::array<std::array<const char*, 5>, 3> headward_first = {
    {{"GV14", "GV12", "GV9", "GV6", "GV4"},
     {"SI11_L", "BL47_L", "BL50_L", nullptr, nullptr},
     {"SI11_R", "BL47_R", "BL50_R", nullptr, nullptr}}};

/// Normals point out of the back; what is left lies left, and what is upper above. Axes of `couch`
/// as every file has them: x to the left of the person, the head at +z of one who sits and at -y of
/// one who lies.
Result<void> check_sense(const LabelledBody& body, const std::string& file) {
  const bool sits = body.position == BodyPosture::sitting;
  const Vector3 out = sits ? Vector3::UnitY() : Vector3::UnitZ();
  const Vector3 to_head = sits ? Vector3(0.0, 0.0, 1.0) : Vector3(0.0, -1.0, 0.0);
  std::map<std::string, Vector3> places;
  for (const Landmark& landmark : body.landmarks) places[landmark.name] = landmark.at_in_couch;
  for (const Acupoint& point : body.acupoints) {
    places[point.name] = point.at_in_couch;
    if (point.normal_in_couch.dot(out) < 0.0)
      return fail(Fault::bad_input, "{}: the normal of {} points into the body", file, point.name);
  }
  for (const auto& [name, place] : places) {
    if (!name.ends_with("_L")) continue;
    const std::string other = name.substr(0, name.size() - 1) + "R";
    const auto right = places.find(other);
    if (right != places.end() && place.x() <= right->second.x())
      return fail(Fault::bad_input, "{}: {} lies to the right of {}: are the sides swapped?", file,
                  name, other);
  }
  for (const auto& names : headward_first) {
    const char* upper = nullptr;
    for (const char* name : names) {
      if (name == nullptr || !places.contains(name)) continue;
      if (upper != nullptr && to_head.dot(places[upper] - places[name]) <= 0.0)
        return fail(Fault::bad_input, "{}: {} lies below {}: are the two swapped?", file, upper,
                    name);
      upper = name;
    }
  }
  return {};
}

/// Labels lie on the skin, which is in metres, and normals have a length.
Result<void> check_body(const LabelledBody& body, const std::string& ply, const std::string& file) {
  Eigen::AlignedBox3d box;
  for (const Vector3& p : body.skin_in_couch.vertices) box.extend(p);
  if (const double span_m = box.sizes().maxCoeff(); span_m > max_span_m) {
    return fail(Fault::bad_input,
                "{}: the skin spans {:.0f} m, a person at most 2: is it in {}? metres are needed",
                ply, span_m, span_m > 200.0 ? "millimetres" : "centimetres");
  }
  const SkinDistance off_skin(body.skin_in_couch);
  for (const Acupoint& point : body.acupoints) {
    auto near = check_label(point.name, off_skin(point.at_in_couch), max_label_off_skin_m, file);
    if (!near) return near;
    const double length = point.normal_in_couch.norm();
    if (std::abs(length - 1.0) > max_length_error) {
      return fail(Fault::bad_input, "{}: the normal of {} has length {:.2f}, 1 is needed", file,
                  point.name, length);
    }
  }
  for (const Landmark& landmark : body.landmarks) {
    const double off_m = off_skin(landmark.at_in_couch);
    if (auto near = check_label(landmark.name, off_m, max_landmark_off_skin_m, file); !near)
      return near;
  }
  return check_sense(body, file);
}

}  // namespace

Result<LabelledBody> read_labelled_body(const std::filesystem::path& ply) {
  auto surface = read_surface(ply);
  if (!surface) return tl::unexpected(surface.error());
  const auto labels = std::filesystem::path(ply).replace_extension(".json");
  const auto text = read_file(labels);
  if (!text) return tl::unexpected(text.error());
  LabelledBody body;
  body.id = ply.stem().string();
  body.skin_in_couch = {std::move(surface->cloud.points), std::move(surface->triangles)};
  try {
    const json object = json::parse(*text);
    const auto position = object.at("position").get<std::string>();
    if (position != "sitting" && position != "prone") {
      return fail(Fault::bad_input, "{}: position is {}, sitting or prone is known",
                  labels.string(), in_quotes(position));
    }
    body.position = position == "sitting" ? BodyPosture::sitting : BodyPosture::prone;
    body.body_type = object.value("body_type", "medium");
    const json& seven = object.at("acupoints");
    for (const char* name : seven_acupoints) {
      if (!seven.contains(name)) {
        return fail(Fault::bad_input, "{}: the acupoint {} is missing", labels.string(), name);
      }
      add_acupoints(json{{name, seven.at(name)}}, body.acupoints);
    }
    if (object.contains("more_acupoints"))
      add_acupoints(object.at("more_acupoints"), body.acupoints);
    if (object.contains("landmarks")) {
      for (const auto& [name, place] : object.at("landmarks").items()) {
        body.landmarks.push_back({name, vector_of(place, name)});
      }
    }
  } catch (const std::exception& fault) {
    return tl::unexpected(json_fault(fault, *text, labels.string(), "the labels of a body"));
  }
  if (auto sound = check_body(body, ply.string(), labels.string()); !sound)
    return tl::unexpected(sound.error());
  return body;
}

Result<void> write_labelled_body(const LabelledBody& body, const std::filesystem::path& ply) {
  const auto numbers = [](const Vector3& v) { return json{v.x(), v.y(), v.z()}; };
  json labels{{"id", body.id},
              {"body_type", body.body_type},
              {"position", name_of(body.position)},
              {"units", "m"},
              {"frame", body.position == BodyPosture::sitting
                            ? "z up; x to the left of the subject; y out of the back"
                            : "z up; x to the left of the subject; y towards the feet"},
              {"vertices", body.skin_in_couch.vertices.size()},
              {"triangles", body.skin_in_couch.triangles.size()},
              {"landmarks", json::object()}};
  for (const Landmark& landmark : body.landmarks) {
    labels["landmarks"][landmark.name] = numbers(landmark.at_in_couch);
  }
  for (const Acupoint& point : body.acupoints) {
    const bool seven = std::find(seven_acupoints.begin(), seven_acupoints.end(), point.name) !=
                       seven_acupoints.end();
    labels[seven ? "acupoints" : "more_acupoints"][point.name] = {
        {"position", numbers(point.at_in_couch)}, {"normal", numbers(point.normal_in_couch)}};
  }
  auto skin_file = FileWriter::open(ply);
  if (!skin_file) return tl::unexpected(skin_file.error());
  auto label_file = FileWriter::open(std::filesystem::path(ply).replace_extension(".json"));
  if (!label_file) return tl::unexpected(label_file.error());
  if (auto written = skin_file->append(to_ply(body.skin_in_couch)); !written) return written;
  if (auto written = label_file->append(labels.dump(1) + "\n"); !written) return written;
  // Skin without labels is nobody, so that they come first.
  if (auto written = label_file->finish(); !written) return written;
  return skin_file->finish();
}

Result<std::vector<std::filesystem::path>> list_labelled_bodies(
    const std::filesystem::path& folder_or_ply) {
  namespace fs = std::filesystem;
  std::error_code fault;
  if (fs::is_regular_file(folder_or_ply, fault)) return std::vector<fs::path>{folder_or_ply};
  if (!fs::is_directory(folder_or_ply, fault)) {
    return fail(Fault::file, "{}: neither a folder nor a .ply file", folder_or_ply.string());
  }
  std::vector<fs::path> bodies;
  for (const auto& entry : fs::directory_iterator(folder_or_ply, fault)) {
    fs::path path = entry.path();
    if (path.extension() == ".ply" &&
        fs::exists(fs::path(path).replace_extension(".json"), fault)) {
      bodies.push_back(std::move(path));
    }
  }
  if (bodies.empty()) {
    return fail(Fault::file, "{}: no labelled body (NAME.ply with NAME.json beside it)",
                folder_or_ply.string());
  }
  std::sort(bodies.begin(), bodies.end());
  return bodies;
}

PointCloud sample(const Mesh& skin, double spacing_m, std::size_t max_points) {
  const auto corner = [&](const std::array<int, 3>& triangle, std::size_t i) -> const Vector3& {
    return skin.vertices[static_cast<std::size_t>(triangle[i])];
  };
  const auto steps_of = [&](const std::array<int, 3>& triangle, int max_steps) {
    const Vector3 &a = corner(triangle, 0), &b = corner(triangle, 1), &c = corner(triangle, 2);
    const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
    return static_cast<int>(std::clamp(std::ceil(longest / spacing_m), 1.0, 1.0 * max_steps));
  };
  const auto count = [&](int max_steps) {
    std::size_t sum = 0;
    for (const auto& triangle : skin.triangles) {
      const auto steps = static_cast<std::size_t>(steps_of(triangle, max_steps));
      sum += steps * (steps + 1) / 2;
    }
    return sum;
  };
  int max_steps = 200;
  while (max_steps > 1 && count(max_steps) > max_points) max_steps /= 2;
  PointCloud cloud;
  cloud.points = skin.vertices;
  for (const auto& triangle : skin.triangles) {
    const Vector3 &a = corner(triangle, 0), &b = corner(triangle, 1), &c = corner(triangle, 2);
    const int steps = steps_of(triangle, max_steps);
    for (int i = 0; i < steps; ++i) {
      for (int j = 0; i + j < steps; ++j) {
        const double u = (i + 1.0 / 3.0) / steps;
        const double v = (j + 1.0 / 3.0) / steps;
        cloud.points.emplace_back(a + u * (b - a) + v * (c - a));
      }
    }
  }
  return cloud;
}

}  // namespace tuina::body
