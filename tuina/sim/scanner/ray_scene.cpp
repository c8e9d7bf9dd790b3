// SPDX-License-Identifier: Apache-2.0
#include "tuina/sim/scanner/ray_scene.hpp"

#include <embree3/rtcore.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace tuina::sim {
namespace {

// Single precision resolves 0.1 um at 1 m; rays start this far off the surface.
constexpr double off_surface_m = 1e-4;

struct NearestQuery {
  const Mesh* mesh;
  const Vector3* point;
  double best2;
  bool below = false;  // the triangle, by the right-hand rule
};

// [ericson2005] 5.1.5: closest point of a triangle by Voronoi regions.
double distance2_to_triangle(const Vector3& p, const Vector3& a, const Vector3& b,
                             const Vector3& c) {
  const Vector3 ab = b - a;
  const Vector3 ac = c - a;
  const Vector3 ap = p - a;
  const double d1 = ab.dot(ap);
  const double d2 = ac.dot(ap);
  if (d1 <= 0.0 && d2 <= 0.0) return ap.squaredNorm();
  const Vector3 bp = p - b;
  const double d3 = ab.dot(bp);
  const double d4 = ac.dot(bp);
  if (d3 >= 0.0 && d4 <= d3) return bp.squaredNorm();
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return (ap - d1 / (d1 - d3) * ab).squaredNorm();
  const Vector3 cp = p - c;
  const double d5 = ab.dot(cp);
  const double d6 = ac.dot(cp);
  if (d6 >= 0.0 && d5 <= d6) return cp.squaredNorm();
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return (ap - d2 / (d2 - d6) * ac).squaredNorm();
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0) {
    return (bp - (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b)).squaredNorm();
  }
  const double sum = va + vb + vc;
  return (ap - vb / sum * ab - vc / sum * ac).squaredNorm();
}

bool visit(RTCPointQueryFunctionArguments* arguments) {
  auto& query = *static_cast<NearestQuery*>(arguments->userPtr);
  const auto& triangle = query.mesh->triangles[arguments->primID];
  const auto corner = [&](std::size_t i) -> const Vector3& {
    return query.mesh->vertices[static_cast<std::size_t>(triangle[i])];
  };
  const double distance2 = distance2_to_triangle(*query.point, corner(0), corner(1), corner(2));
  if (distance2 >= query.best2) return false;
  query.best2 = distance2;
  const Vector3 normal = (corner(1) - corner(0)).cross(corner(2) - corner(0));
  query.below = normal.dot(*query.point - corner(0)) < 0.0;
  arguments->query->radius = static_cast<float>(std::sqrt(distance2));
  return true;  // the query radius has shrunk
}

RTCRay ray_from(const Vector3& origin, const Vector3& direction, double from_m, double to_m) {
  RTCRay ray{};
  ray.org_x = static_cast<float>(origin.x());
  ray.org_y = static_cast<float>(origin.y());
  ray.org_z = static_cast<float>(origin.z());
  ray.dir_x = static_cast<float>(direction.x());
  ray.dir_y = static_cast<float>(direction.y());
  ray.dir_z = static_cast<float>(direction.z());
  ray.tnear = static_cast<float>(from_m);
  ray.tfar = static_cast<float>(to_m);
  ray.mask = ~0U;
  return ray;
}

}  // namespace

struct RayScene::Scene {
  Mesh mesh;
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;

  ~Scene() {
    if (scene != nullptr) rtcReleaseScene(scene);
    if (device != nullptr) rtcReleaseDevice(device);
  }
};

RayScene::RayScene(const Mesh& mesh) : scene_(std::make_unique<Scene>()) {
  scene_->mesh = mesh;
  // A single thread builds the same tree every time.
  scene_->device = rtcNewDevice("threads=1,set_affinity=0");
  scene_->scene = rtcNewScene(scene_->device);
  rtcSetSceneFlags(scene_->scene, RTC_SCENE_FLAG_ROBUST);
  RTCGeometry geometry = rtcNewGeometry(scene_->device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* vertices = static_cast<float*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                              3 * sizeof(float), std::max<std::size_t>(1, mesh.vertices.size())));
  for (const Vector3& vertex : mesh.vertices) {
    for (int axis = 0; axis < 3; ++axis) *vertices++ = static_cast<float>(vertex[axis]);
  }
  auto* corners = static_cast<unsigned*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned),
      std::max<std::size_t>(1, mesh.triangles.size())));
  std::fill_n(corners, mesh.triangles.empty() ? 3 : 0, 0U);
  for (const auto& triangle : mesh.triangles) {
    for (const int corner : triangle) *corners++ = static_cast<unsigned>(corner);
  }
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene_->scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene_->scene);
}

RayScene::RayScene(RayScene&&) noexcept = default;
RayScene& RayScene::operator=(RayScene&&) noexcept = default;
RayScene::~RayScene() = default;

std::optional<RayScene::Hit> RayScene::first_hit(const Vector3& origin,
                                                 const Vector3& direction) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRayHit query{};
  query.ray = ray_from(origin, direction, 0.0, std::numeric_limits<float>::infinity());
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(scene_->scene, &context, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
  // The intersection with the triangle's plane is recomputed in double precision.
  const auto& triangle = scene_->mesh.triangles[query.hit.primID];
  const Vector3& a = scene_->mesh.vertices[static_cast<std::size_t>(triangle[0])];
  const Vector3& b = scene_->mesh.vertices[static_cast<std::size_t>(triangle[1])];
  const Vector3& c = scene_->mesh.vertices[static_cast<std::size_t>(triangle[2])];
  const Vector3 normal = (b - a).cross(c - a).normalized();
  const double across = normal.dot(direction);
  if (!(std::abs(across) > 1e-9)) return {};
  return Hit{.distance_m = normal.dot(a - origin) / across, .normal = normal};
}

bool RayScene::blocks(const Vector3& from, const Vector3& to) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  const Vector3 way = to - from;
  const double length_m = way.norm();
  RTCRay ray = ray_from(from, way / length_m, off_surface_m, length_m - off_surface_m);
  rtcOccluded1(scene_->scene, &context, &ray);
  return ray.tfar < 0.0F;
}

double RayScene::height_over(const Vector3& point) const {
  NearestQuery nearest{&scene_->mesh, &point, std::numeric_limits<double>::infinity()};
  RTCPointQuery query{};
  query.x = static_cast<float>(point.x());
  query.y = static_cast<float>(point.y());
  query.z = static_cast<float>(point.z());
  query.radius = std::numeric_limits<float>::infinity();
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  rtcPointQuery(scene_->scene, &query, &context, visit, &nearest);
  return nearest.below ? -std::sqrt(nearest.best2) : std::sqrt(nearest.best2);
}

}  // namespace tuina::sim
