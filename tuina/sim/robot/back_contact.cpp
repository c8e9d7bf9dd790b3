// SPDX-License-Identifier: Apache-2.0
#include "tuina/sim/robot/back_contact.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <map>
#include <utility>

#include "tuina/core/random.hpp"
#include "tuina/sim/person/tissue_map.hpp"
#include "tuina/tissue/tangent_model.hpp"

namespace tuina::sim {
namespace {

Vector3 area_vector(const Mesh& mesh, const std::array<int, 3>& triangle) {
  const Vector3& a = mesh.vertices[static_cast<std::size_t>(triangle[0])];
  const Vector3& b = mesh.vertices[static_cast<std::size_t>(triangle[1])];
  const Vector3& c = mesh.vertices[static_cast<std::size_t>(triangle[2])];
  return (b - a).cross(c - a);
}

std::vector<Vector3> normals_of(const Mesh& mesh) {
  std::vector<Vector3> normals(mesh.vertices.size(), Vector3::Zero());
  for (const auto& triangle : mesh.triangles) {
    for (const int corner : triangle) {
      normals[static_cast<std::size_t>(corner)] += area_vector(mesh, triangle);
    }
  }
  for (Vector3& normal : normals) normal = normal.stableNormalized();
  return normals;
}

/// True for vertices of edges with only one triangle.
std::vector<bool> rim_of(const Mesh& mesh) {
  std::map<std::pair<int, int>, int> uses;
  for (const auto& t : mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i) ++uses[std::minmax(t[i], t[(i + 1) % 3])];
  }
  std::vector<bool> rim(mesh.vertices.size(), false);
  for (const auto& [edge, count] : uses) {
    if (count != 1) continue;
    rim[static_cast<std::size_t>(edge.first)] = true;
    rim[static_cast<std::size_t>(edge.second)] = true;
  }
  return rim;
}

struct Way {
  double at_m = 0.0, speed_m_per_s = 0.0;
};

Way way_of(const Shift& shift, double time_s) {
  const double since_s = time_s - shift.start_s, length_m = shift.by_in_couch.norm();
  if (since_s <= 0.0 || length_m == 0.0) return {};
  const double v = shift.speed_m_per_s, a = shift.acceleration_m_per_s2;
  const double starting_s = v / a;  // zero where the speed jumps
  const Way way = since_s < starting_s ? Way{0.5 * a * since_s * since_s, a * since_s}
                                       : Way{v * (since_s - 0.5 * starting_s), v};
  return way.at_m < length_m ? way : Way{length_m, 0.0};
}

}  // namespace

BackContact::BackContact(Mesh skin_in_couch, std::vector<TangentTissue> per_vertex,
                         ContactOptions options)
    : skin_(std::move(skin_in_couch)),
      tissue_(std::move(per_vertex)),
      options_(std::move(options)),
      breath_(options_.breathing, options_.seed),
      vertex_normals_(normals_of(skin_.mesh())),
      on_rim_(rim_of(skin_.mesh())) {
  assert(tissue_.size() == skin_.mesh().vertices.size());
  Vector3 sum = Vector3::Zero();
  for (const auto& triangle : skin_.mesh().triangles) sum += area_vector(skin_.mesh(), triangle);
  mean_normal_ = sum.stableNormalized();
  if (options_.living == LivingBack{}) return;
  worked_.assign(tissue_.size(), 0.0);
  roughen(tissue_, skin_.mesh(), options_.living.grain_share, options_.seed);
  for (const Arm arm : both_arms) {
    sides_[arm].living.emplace(options_.living, options_.torso_n_per_m, options_.friction,
                               make_random(options_.seed, "living back"),
                               make_random(options_.seed, name_of(arm)));
  }
}

Vector3 BackContact::moved_in_couch(double time_s) const noexcept {
  Vector3 moved = mean_normal_ * breath_.at(time_s).at_m;
  for (const Shift& shift : options_.shifts) {
    moved += way_of(shift, time_s).at_m * shift.by_in_couch.stableNormalized();
  }
  return moved;
}

TangentTissue BackContact::first_loading(const TangentTissue& place, const Vector3& at_in_couch,
                                         double to_n) const noexcept {
  // Both tools meet the same person.
  const std::optional<LivingContact>& living = sides_[Arm::left].living;
  return living ? living->first_loading(place, at_in_couch, to_n) : place;
}

Vector3 BackContact::moving_m_per_s(double time_s) const noexcept {
  Vector3 moving = mean_normal_ * breath_.at(time_s).speed_m_per_s;
  for (const Shift& shift : options_.shifts) {
    moving += way_of(shift, time_s).speed_m_per_s * shift.by_in_couch.stableNormalized();
  }
  return moving;
}

Vector3 BackContact::normal_at(const ClosestPoint::Place& place) const noexcept {
  Vector3 normal = Vector3::Zero();
  const auto& corners = skin_.mesh().triangles[static_cast<std::size_t>(place.triangle)];
  for (std::size_t i = 0; i < 3; ++i) {
    normal += place.weights[i] * vertex_normals_[static_cast<std::size_t>(corners[i])];
  }
  return normal.stableNormalized();
}

TangentTissue BackContact::tissue_at(const ClosestPoint::Place& place) const noexcept {
  TangentTissue mean;
  const auto& corners = skin_.mesh().triangles[static_cast<std::size_t>(place.triangle)];
  for (std::size_t i = 0; i < 3; ++i) {
    const TangentTissue& corner = tissue_[static_cast<std::size_t>(corners[i])];
    mean.alpha_n += place.weights[i] * corner.alpha_n;
    mean.beta_per_m += place.weights[i] * corner.beta_per_m;
  }
  return mean;
}

bool BackContact::on_the_rim(const ClosestPoint::Place& place) const noexcept {
  const auto& corners = skin_.mesh().triangles[static_cast<std::size_t>(place.triangle)];
  for (std::size_t i = 0; i < 3; ++i) {
    if (place.weights[i] > 1e-9 && !on_rim_[static_cast<std::size_t>(corners[i])]) return false;
  }
  return true;
}

const ContactTruth& BackContact::touch(Arm arm, double time_s, const Vector3& centre_in_couch,
                                       const Vector3& velocity_in_couch) noexcept {
  Side& side = sides_[arm];
  ContactTruth& truth = side.truth;
  // The skin moves as one piece, so the tool is moved into the mesh's rest frame instead.
  const Vector3 centre = centre_in_couch - moved_in_couch(time_s);
  truth.on_tool_in_couch = {};
  truth.force_n = 0.0;
  truth.depth_m = 0.0;
  constexpr double max_step_s = 2e-3;
  const double step_s = std::clamp(time_s - side.time_s, 0.0, max_step_s);
  side.time_s = time_s;
  // Far from the skin, contact is impossible until the tool has moved the last free distance.
  if (const double way_m = (centre - side.last_on_mesh).norm(); way_m < side.free_way_m) {
    truth.gap_m = side.free_way_m - way_m;
    if (side.living) side.living->rest(step_s);
    return truth;
  }

  const double radius_m = options_.tool_radius_m;
  const ClosestPoint::Place place = skin_.find(centre, side.triangle);
  side.triangle = place.triangle;
  side.last_on_mesh = centre;
  side.free_way_m = std::max(0.0, place.distance_m - radius_m - 1_mm);
  truth.at_in_couch = place.at;
  truth.tissue = tissue_at(place);

  // The force acts along the line from the closest point to the sphere's centre. When the centre is
  // near the skin that direction is undefined, and the skin's normal replaces it.
  const Vector3 skin_normal = normal_at(place);
  const Vector3 apart = centre - place.at;
  const bool inside = apart.dot(skin_normal) < 0.0;
  const bool near_centre = place.distance_m < 1_mm;
  const Vector3 normal =
      near_centre ? skin_normal : Vector3(apart / (inside ? -place.distance_m : place.distance_m));
  const double height_m = inside ? -place.distance_m : place.distance_m;
  truth.normal_in_couch = normal;
  truth.gap_m = height_m - radius_m;
  // Beyond the rim of an open mesh there is no skin.
  if (inside && on_the_rim(place)) truth.gap_m = place.distance_m;
  if (truth.gap_m < 0.0) {
    press(side, place, normal, height_m, velocity_in_couch - moving_m_per_s(time_s), step_s);
  } else if (side.living) {
    side.living->rest(step_s);
  }
  return truth;
}

void BackContact::press(Side& side, const ClosestPoint::Place& place, const Vector3& normal,
                        double height_m, const Vector3& sliding_m_per_s, double step_s) noexcept {
  ContactTruth& truth = side.truth;
  Vector3 drag_n;
  if (side.living) {
    LivingContact& living = *side.living;
    living.press({.place = truth.tissue,
                  .at = truth.at_in_couch,
                  .worked = worked(side, place, step_s),
                  .travel_m = -truth.gap_m,
                  .normal = normal,
                  .velocity_m_per_s = sliding_m_per_s},
                 step_s);
    truth.depth_m = living.depth_m;
    truth.force_n = living.force_n;
    drag_n = living.drag_n;
  } else {
    truth.depth_m = depth_in_series(truth.tissue, options_.torso_n_per_m, -truth.gap_m);
    truth.force_n = tissue::force_at_depth(truth.tissue, truth.depth_m);
    const Vector3 tangential = sliding_m_per_s - sliding_m_per_s.dot(normal) * normal;
    const double speed = tangential.norm();
    drag_n =
        -options_.friction * truth.force_n * tangential / std::max(speed, options_.creep_m_per_s);
  }
  const Vector3 lever = -height_m * normal;  // from the centre to the skin
  truth.on_tool_in_couch.force_n = truth.force_n * normal + drag_n;
  truth.on_tool_in_couch.torque_nm = lever.cross(drag_n);
}

double BackContact::worked(const Side& side, const ClosestPoint::Place& place,
                           double step_s) noexcept {
  constexpr double work_n_s = 30.0;  // about one press of the programmes
  const auto& corners = skin_.mesh().triangles[static_cast<std::size_t>(place.triangle)];
  double mean = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    double& corner = worked_[static_cast<std::size_t>(corners[i])];
    mean += place.weights[i] * corner;
    corner += place.weights[i] * step_s * side.living->force_n / work_n_s * (1.0 - corner);
  }
  return mean;
}

double depth_in_series(const TangentTissue& tissue, double torso_n_per_m,
                       double travel_m) noexcept {
  if (travel_m <= 0.0) return 0.0;
  const double softness = 1.0 / torso_n_per_m;  // zero for a rigid torso
  // Newton on depth + F(depth) / torso - travel, which is convex and increasing: from above (depth
  // = travel) it converges monotonically.
  double depth_m = travel_m;
  for (int i = 0; i < 60; ++i) {
    const double force = tissue::force_at_depth(tissue, depth_m);
    const double slope = tissue::stiffness_at_depth(tissue, depth_m);
    const double step = (depth_m + force * softness - travel_m) / (1.0 + slope * softness);
    depth_m -= step;
    if (std::abs(step) < 1e-13) break;
  }
  return depth_m;
}

Mesh make_patch(const Patch& patch) {
  const Vector3 normal = patch.normal_in_couch.normalized();
  const Vector3 upright =
      std::abs(normal.z()) < 0.7 ? Vector3(Vector3::UnitZ()) : Vector3(Vector3::UnitY());
  const Vector3 across = upright.cross(normal).normalized();
  const Vector3 along = normal.cross(across);
  const int cells = std::max(1, static_cast<int>(std::lround(patch.size_m / patch.edge_m)));
  Mesh mesh;
  for (int j = 0; j <= cells; ++j) {
    for (int i = 0; i <= cells; ++i) {
      const double u = (static_cast<double>(i) / cells - 0.5) * patch.size_m;
      const double v = (static_cast<double>(j) / cells - 0.5) * patch.size_m;
      double side = u;
      double drop = 0.0;
      if (std::isfinite(patch.bend_radius_m)) {
        side = patch.bend_radius_m * std::sin(u / patch.bend_radius_m);
        drop = patch.bend_radius_m * (1.0 - std::cos(u / patch.bend_radius_m));
      }
      mesh.vertices.emplace_back(patch.centre_in_couch + side * across + v * along - drop * normal);
    }
  }
  for (int j = 0; j < cells; ++j) {
    for (int i = 0; i < cells; ++i) {
      const int a = j * (cells + 1) + i;
      const int b = a + 1;
      const int c = a + cells + 1;
      const int d = c + 1;
      mesh.triangles.push_back({a, b, d});
      mesh.triangles.push_back({a, d, c});
    }
  }
  return mesh;
}

}  // namespace tuina::sim
