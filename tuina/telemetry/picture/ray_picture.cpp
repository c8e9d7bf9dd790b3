// SPDX-License-Identifier: Apache-2.0
#include "tuina/telemetry/picture/ray_picture.hpp"

#include <embree3/rtcore.h>

#include <algorithm>
#include <array>
#include <limits>

namespace tuina::telemetry {
namespace {

using Eigen::Vector3f;

constexpr float infinite = std::numeric_limits<float>::infinity();

Vector3f light_of(Colour colour) {
  const auto light = to_light(colour);
  return {light[0], light[1], light[2]};
}

/// The edge of what was seen is where the mask passes its middle; a narrow ramp there is a pixel or
/// two.
float cover_of(float mask) {
  return std::clamp((mask - 0.46F) / 0.08F, 0.F, 1.F);
}

RTCRay ray_from(const Vector3f& origin, const Vector3f& direction, float begin) {
  RTCRay ray{};
  ray.org_x = origin.x();
  ray.org_y = origin.y();
  ray.org_z = origin.z();
  ray.dir_x = direction.x();
  ray.dir_y = direction.y();
  ray.dir_z = direction.z();
  ray.tnear = begin;
  ray.tfar = infinite;
  ray.mask = ~0U;
  return ray;
}

struct Corner {
  Vector3f normal, albedo;
  float inside;
};

}  // namespace

struct RayPicture::Geometry {
  Projection projection;
  const Mesh& mesh;
  std::vector<Corner> corners;
  std::vector<std::vector<Vector3f>> albedo;  // of what is not skin, by geometry and piece
  RTCDevice device;
  RTCScene scene;

  Geometry(const Projection& from, const Mesh& skin)
      : projection(from),
        mesh(skin),
        // One thread builds the tree, so it is the same tree every time.
        device(rtcNewDevice("threads=1,set_affinity=0")),
        scene(rtcNewScene(device)) {}
  Geometry(const Geometry&) = delete;
  Geometry& operator=(const Geometry&) = delete;
  ~Geometry() {
    rtcReleaseScene(scene);
    rtcReleaseDevice(device);
  }

  /// Geometries are numbered in the order in which they come; the skin is the first.
  template <std::size_t floats, std::size_t per_piece>
  void add(RTCGeometryType type, const std::vector<std::array<float, floats>>& places,
           const std::vector<std::array<unsigned, per_piece>>& pieces,
           std::vector<Vector3f> colours) {
    if (places.empty()) return;
    RTCGeometry geometry = rtcNewGeometry(device, type);
    std::copy(places.begin(), places.end(),
              static_cast<std::array<float, floats>*>(
                  rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0,
                                          floats == 3 ? RTC_FORMAT_FLOAT3 : RTC_FORMAT_FLOAT4,
                                          floats * sizeof(float), places.size())));
    if (!pieces.empty())
      std::copy(pieces.begin(), pieces.end(),
                static_cast<std::array<unsigned, per_piece>*>(
                    rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0,
                                            per_piece == 3 ? RTC_FORMAT_UINT3 : RTC_FORMAT_UINT,
                                            per_piece * sizeof(unsigned), pieces.size())));
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
    albedo.push_back(std::move(colours));
  }

  void add_skin(const Scene& shown) {
    std::vector<std::array<float, 3>> places;
    std::vector<std::array<unsigned, 3>> triangles;
    for (std::size_t k = 0; k < mesh.vertices.size(); ++k) {
      const Vector3f at = projection.in_view(mesh.vertices[k]).cast<float>();
      places.push_back({at.x(), at.y(), at.z()});
      corners.push_back({projection.turned(shown.surface.normals[k]).cast<float>(),
                         light_of(shown.colours.empty() ? shown.colour : shown.colours[k]),
                         shown.surface.inside[k]});
    }
    for (const auto& [a, b, c] : mesh.triangles)
      triangles.push_back(
          {static_cast<unsigned>(a), static_cast<unsigned>(b), static_cast<unsigned>(c)});
    add(RTC_GEOMETRY_TYPE_TRIANGLE, places, triangles, {});
  }

  [[nodiscard]] std::array<float, 4> ball(const Vector3& at, double radius_m) const {
    const Vector3f p = projection.in_view(at).cast<float>();
    return {p.x(), p.y(), p.z(), static_cast<float>(radius_m)};
  }

  /// Threads are chains of round rods, beads are balls.
  void add_threads_and_beads(const Scene& shown) {
    std::vector<std::array<float, 4>> knots, balls;
    std::vector<std::array<unsigned, 1>> rods;
    std::vector<Vector3f> rod_colours, ball_colours;
    for (const Thread& thread : shown.threads) {
      for (std::size_t k = 0; k < thread.points.size(); ++k) {
        if (k > 0) {
          rods.push_back({static_cast<unsigned>(knots.size() - 1)});
          rod_colours.push_back(light_of(thread.colour));
        }
        knots.push_back(ball(thread.points[k], thread.radius_m));
      }
    }
    if (!rods.empty()) add(RTC_GEOMETRY_TYPE_ROUND_LINEAR_CURVE, knots, rods, rod_colours);
    for (const Bead& bead : shown.beads) {
      balls.push_back(ball(bead.at, bead.radius_m));
      ball_colours.push_back(light_of(bead.colour));
    }
    add<4, 1>(RTC_GEOMETRY_TYPE_SPHERE_POINT, balls, {}, ball_colours);
  }

  /// The hit on the skin, or nothing where the ray passes beyond its edge.
  [[nodiscard]] std::optional<Sample> on_skin(const RTCHit& hit, const Vector3f& at) const {
    std::array<const Corner*, 3> of = {};
    for (std::size_t i = 0; i < 3; ++i)
      of[i] = &corners[static_cast<std::size_t>(mesh.triangles[hit.primID][i])];
    const auto between = [&]<typename Value>(Value Corner::*member) -> Value {
      return (1.F - hit.u - hit.v) * (of[0]->*member) + hit.u * (of[1]->*member) +
             hit.v * (of[2]->*member);
    };
    const float cover = cover_of(between(&Corner::inside));
    if (cover <= 0.F) return {};
    return Sample{.at = at,
                  .normal = between(&Corner::normal).normalized(),
                  .albedo = between(&Corner::albedo),
                  .cover = cover,
                  .skin = true};
  }
};

RayPicture::RayPicture(const Scene& scene, const Projection& projection)
    : geometry_(std::make_unique<Geometry>(projection, scene.surface.mesh)) {
  geometry_->add_skin(scene);
  geometry_->add_threads_and_beads(scene);
  rtcCommitScene(geometry_->scene);
}

RayPicture::~RayPicture() = default;

std::optional<Sample> RayPicture::seen_through(float column, float row) const {
  constexpr float beyond_m = 1e-4F;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  const Projection& projection = geometry_->projection;
  const Vector3f eye(0.F, 0.F, static_cast<float>(projection.distance_m()));
  const Vector3f direction = projection.ray(column, row).cast<float>();
  for (float begin = 0.F;;) {
    RTCRayHit query{.ray = ray_from(eye, direction, begin), .hit = {}};
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(geometry_->scene, &context, &query);
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
    const Vector3f at = eye + query.ray.tfar * direction;
    if (query.hit.geomID > 0) {
      const Vector3f normal(query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z);
      return Sample{.at = at,
                    .normal = normal.normalized(),
                    .albedo = geometry_->albedo[query.hit.geomID][query.hit.primID]};
    }
    if (auto sample = geometry_->on_skin(query.hit, at)) return sample;
    begin = query.ray.tfar + beyond_m;
  }
}

bool RayPicture::in_shadow(const Vector3f& at, const Vector3f& to_light) const {
  // A surface that is known to a millimetre or two must not shade itself.
  constexpr float slack_m = 0.0035F;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRay ray = ray_from(at, to_light, slack_m);
  rtcOccluded1(geometry_->scene, &context, &ray);
  return ray.tfar < 0.F;
}

}  // namespace tuina::telemetry
