// SPDX-License-Identifier: Apache-2.0
#include "apps/serve/shown_back.hpp"

#include "apps/serve/shown_sentence.hpp"

#include <bit>
#include <cstring>
#include <nlohmann/json.hpp>

#include "tuina/core/units.hpp"
#include "tuina/massage/zones.hpp"
#include "tuina/telemetry/picture/scan_mesh.hpp"

namespace tuina::app {
namespace {

using nlohmann::json;

static_assert(std::endian::native == std::endian::little);

template <typename Number>
void append(std::string& bytes, Number value) {
  std::array<char, sizeof value> raw{};
  std::memcpy(raw.data(), &value, sizeof value);
  bytes.append(raw.data(), raw.size());
}

void append(std::string& bytes, const Vector3& vector) {
  for (int i = 0; i < 3; ++i) append(bytes, static_cast<float>(vector[i]));
}

json numbers(const Vector3& vector) {
  return {vector.x(), vector.y(), vector.z()};
}

}  // namespace

std::string back_bytes(const PointCloud& cloud_in_couch, std::span<const Acupoint> acupoints,
                       std::span<const Landmark> landmarks) {
  constexpr double cell_m = 5e-3;  // a page needs no finer one
  Vector3 toward_eye = Vector3::Zero();
  for (const Vector3& normal : cloud_in_couch.normals) toward_eye += normal;
  const telemetry::PictureMesh drawn =
      telemetry::mesh_scan(cloud_in_couch, toward_eye.normalized(), cell_m);
  const auto& places = drawn.mesh.vertices;
  std::string bytes;
  append(bytes, static_cast<std::uint32_t>(places.size()));
  append(bytes, static_cast<std::uint32_t>(drawn.mesh.triangles.size()));
  for (const Vector3& place : places) append(bytes, place);
  for (const Vector3& normal : drawn.normals) append(bytes, normal);
  for (const auto& triangle : drawn.mesh.triangles) {
    for (const int corner : triangle) append(bytes, static_cast<std::uint32_t>(corner));
  }
  const auto chart = massage::BackChart::from(acupoints, landmarks);
  std::optional<massage::ZoneMap> zones;
  if (chart) zones.emplace(*chart, acupoints, landmarks);
  for (const Vector3& place : places)
    append(bytes, static_cast<std::uint8_t>(zones ? zones->at(place) : massage::Zone::outside));
  return bytes;
}

std::string map_json(BodyPosture position, std::span<const Acupoint> acupoints) {
  json points = json::array();
  for (const Acupoint& point : acupoints) {
    points.push_back({{"name", point.name},
                      {"at", numbers(point.at_in_couch)},
                      {"normal", numbers(point.normal_in_couch)},
                      {"uncertainty_mm", to_mm(point.uncertainty_m)}});
  }
  return json{{"position", name_of(position)}, {"acupoints", points}}.dump();
}

std::string plan_json(const massage::Plan& plan) {
  constexpr std::size_t max_places = 60;
  json paths = json::array();
  for (const massage::PlannedPath& planned : plan.paths) {
    const auto& points = planned.path.points;
    const std::size_t stride = 1 + points.size() / max_places;
    json places = json::array();
    for (std::size_t i = 0; i < points.size(); i += stride)
      places.push_back(numbers(points[i].at_in_couch));
    paths.push_back({{"name", planned.path.name},
                     {"technique", row_of(planned.path.technique).name},
                     {"acupoints", planned.path.acupoints},
                     {"arm", name_of(planned.arm)},
                     {"step", planned.step},
                     {"start_s", planned.start_s},
                     {"duration_s", planned.path.duration_s()},
                     {"zone", name_of(planned.zone)},
                     {"ordered_n", planned.ordered_n()},
                     {"cap_n", planned.cap_n},
                     {"programme_n", planned.programme_n},
                     {"places", places}});
  }
  return json{{"programme", plan.programme},
              {"duration_s", plan.duration_s},
              {"zones_touched", plan.zones_touched},
              {"notes", shown_sentence(plan.notes)},
              {"paths", paths}}
      .dump();
}

}  // namespace tuina::app
