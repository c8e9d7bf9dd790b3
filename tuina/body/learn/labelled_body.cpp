// SPDX-License-Identifier: Apache-2.0
#include "tuina/body/learn/labelled_body.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "tuina/core/io/file.hpp"
#include "tuina/core/io/surface_file.hpp"

namespace tuina::body {
namespace {

using nlohmann::json;

constexpr double max_landmark_m = 3.0;

Vector3 vector_of(const json& numbers) {
  if (!numbers.is_array() || numbers.size() != 3) throw std::invalid_argument("[x, y, z] expected");
  const Vector3 vector(numbers[0].get<double>(), numbers[1].get<double>(),
                       numbers[2].get<double>());
  if (!vector.allFinite()) throw std::invalid_argument("a coordinate is not finite");
  return vector;
}

void add_acupoints(const json& object, std::vector<Acupoint>& acupoints) {
  for (const auto& [name, point] : object.items()) {
    acupoints.push_back({.name = name,
                         .at_in_couch = vector_of(point.at("position")),
                         .normal_in_couch = vector_of(point.at("normal")),
                         .uncertainty_m = 0.0});
  }
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
      return fail(Fault::bad_input, "{}: position is '{}', sitting or prone is known",
                  labels.string(), position);
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
        // A landmark may lie a little outside the cropped skin, but one far from it is wrong.
        const Vector3 at = vector_of(place);
        if (at.cwiseAbs().maxCoeff() < max_landmark_m) body.landmarks.push_back({name, at});
      }
    }
  } catch (const std::exception& fault) {
    return fail(Fault::bad_input, "{}: not the labels of a body: {}", labels.string(),
                fault.what());
  }
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
  if (auto written = write_file(ply, to_ply(body.skin_in_couch)); !written) return written;
  return write_file(std::filesystem::path(ply).replace_extension(".json"), labels.dump(1) + "\n");
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

PointCloud sample(const Mesh& skin, double spacing_m) {
  PointCloud cloud;
  cloud.points = skin.vertices;
  for (const auto& triangle : skin.triangles) {
    const Vector3& a = skin.vertices[static_cast<std::size_t>(triangle[0])];
    const Vector3& b = skin.vertices[static_cast<std::size_t>(triangle[1])];
    const Vector3& c = skin.vertices[static_cast<std::size_t>(triangle[2])];
    const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
    const int steps = std::clamp(static_cast<int>(std::ceil(longest / spacing_m)), 1, 200);
    for (int i = 0; i < steps; ++i) {
      for (int j = 0; i + j < steps; ++j) {
        const double u = (i + 1.0 / 3.0) / steps;
        const double v = (j + 1.0 / 3.0) / steps;
        cloud.points.push_back(a + u * (b - a) + v * (c - a));
      }
    }
  }
  return cloud;
}

}  // namespace tuina::body
