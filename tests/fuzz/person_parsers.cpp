// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstdint>
#include <cstring>

#include "tests/folder.hpp"
#include "tests/fuzz/parsers.hpp"
#include "tuina/body/atlas.hpp"
#include "tuina/body/learn/labelled_body.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/record/acupoint_file.hpp"

namespace tuina::test {
namespace {

std::vector<Acupoint> some_acupoints() {
  std::vector<Acupoint> points;
  for (const char* name : seven_acupoints) {
    const double x_m = 0.05 * static_cast<double>(points.size());
    points.push_back({name, Vector3(x_m, 0.1, 0.4), Vector3::UnitY(), 0.008});
  }
  return points;
}

void demand_points(const std::vector<Acupoint>& points) {
  demand(points.size() >= seven_acupoints.size(), "the seven points are there");
  for (const Acupoint& point : points) {
    demand(point.at_in_couch.allFinite(), "a point is somewhere");
    demand(point.normal_in_couch.allFinite(), "a normal points somewhere");
    demand(point.uncertainty_m >= 0.0 && point.uncertainty_m <= 1.0, "a radius is a length");
  }
}

bool accepts_map(std::string_view content) {
  const auto read = record::parse_acupoints(content, "acupoints.json");
  if (!read) return false;
  demand_points(read->acupoints);
  for (const Acupoint& point : read->acupoints) {
    demand(std::abs(point.normal_in_couch.norm() - 1.0) < 1e-9, "a normal is unit");
  }
  return true;
}

/// An atlas of one small position, as large as the reader wants it at least.
body::Atlas little_atlas() {
  body::PositionAtlas atlas;
  body::ShapeModel& shape = atlas.shape;
  constexpr Eigen::Index skin = 60;
  shape.bodies = 2;
  shape.acupoints = static_cast<int>(seven_acupoints.size());
  for (const char* name : seven_acupoints) shape.labels.emplace_back(name);
  const auto labels = static_cast<Eigen::Index>(shape.labels.size());
  shape.mean = body::Places::Constant(3, skin + labels, 0.25);
  shape.normals = body::Places::Constant(3, skin, 0.5);
  shape.modes = Eigen::MatrixXd::Constant(3 * (skin + labels), 2, 0.01);
  shape.correction = Eigen::MatrixXd::Constant(3 * labels, 3, 0.5);
  shape.radius95_m = Eigen::VectorXd::Constant(labels, 0.01);
  shape.nominal_var_m2 = Eigen::VectorXd::Constant(labels, 1e-6);
  shape.usual_residual_m = 1e-3;
  atlas.standard.lines = {{Vector2(0.0, 0.1), Vector2(0.0, 0.5)}};
  atlas.standard.marks.assign(shape.labels.size(), Vector2(0.1, 0.2));
  return {.made = "by hand", .positions = {atlas}};
}

/// With the length and the checksum made right, or faults would never come past them.
std::string sealed(std::string_view content) {
  constexpr std::size_t length_at = 12;
  constexpr std::size_t sum_at = 20;
  constexpr std::size_t header = 28;
  std::string atlas(content);
  if (atlas.size() < header) return atlas;
  const std::uint64_t length = atlas.size() - header;
  std::uint64_t sum = 0xcbf29ce484222325;
  for (std::size_t i = header; i < atlas.size(); ++i) {
    sum = (sum ^ static_cast<unsigned char>(atlas[i])) * 0x100000001b3;
  }
  std::memcpy(atlas.data() + length_at, &length, sizeof(length));
  std::memcpy(atlas.data() + sum_at, &sum, sizeof(sum));
  return atlas;
}

bool accepts_atlas(std::string_view content) {
  const auto as_it_is = body::parse_atlas(content, "f.tuina");
  const auto atlas = as_it_is ? as_it_is : body::parse_atlas(sealed(content), "f.tuina");
  if (!atlas) return false;
  demand(!atlas->positions.empty(), "an atlas knows a position");
  for (const auto& position : atlas->positions) {
    const body::ShapeModel& shape = position.shape;
    const auto labels = static_cast<Eigen::Index>(shape.labels.size());
    demand(shape.modes.rows() == 3 * shape.mean.cols(), "modes move every point");
    demand(shape.radius95_m.size() == labels, "every label has a radius");
    demand(shape.mean.allFinite() && shape.modes.allFinite() && shape.correction.allFinite(),
           "numbers are finite");
  }
  return true;
}

bool accepts_labels(std::string_view content) {
  static const Folder folder;
  static const std::string ply = folder.with(
      "anna.ply",
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
      "property float z\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n"
      "0 0.1 0.4\n0.3 0.1 0.4\n0.3 0.1 0.7\n0 0.1 0.7\n3 0 1 2\n3 0 2 3\n");
  (void)folder.with("anna.json", std::string(content));
  const auto body = body::read_labelled_body(ply);
  if (!body) return false;
  demand_points(body->acupoints);
  for (const Landmark& landmark : body->landmarks) {
    demand(landmark.at_in_couch.allFinite(), "a landmark is somewhere");
  }
  return true;
}

std::string some_labels() {
  const Folder folder;
  // In the order that seven_acupoints has: pairs from the shoulders to the loins, then GV4.
  std::vector<Acupoint> seven = some_acupoints();
  for (std::size_t i = 0; i < seven.size(); ++i) {
    const double side = i == 6 ? 0.5 : seven[i].name.ends_with("_L") ? 0.9 : 0.1;
    seven[i].at_in_couch = {0.3 * side, 0.1, 0.68 - 0.08 * static_cast<double>(i / 2)};
    seven[i].normal_in_couch = Vector3::UnitY();
  }
  const body::LabelledBody body{
      .id = "anna", .acupoints = seven, .landmarks = {{"C7", Vector3(0.0, 0.1, 0.7)}}};
  if (!body::write_labelled_body(body, folder / "anna.ply")) return {};
  return read_file(folder / "anna.json").value_or("");
}

}  // namespace

std::vector<Parser> person_parsers() {
  const record::MapFile map{
      .mapping = {.acupoints = some_acupoints(), .landmarks = {{"C7", Vector3(0.0, 0.1, 0.7)}}}};
  return {{"acupoints.json", {record::to_json(map)}, accepts_map},
          {"atlas", {body::to_bytes(little_atlas())}, accepts_atlas},
          {"labels.json", {some_labels()}, accepts_labels}};
}

}  // namespace tuina::test
