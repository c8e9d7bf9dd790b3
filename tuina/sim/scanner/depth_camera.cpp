// SPDX-License-Identifier: Apache-2.0
#include "tuina/sim/scanner/depth_camera.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "tuina/core/grid.hpp"
#include "tuina/core/random.hpp"
#include "tuina/core/units.hpp"
#include "tuina/sim/scanner/laser_scanner.hpp"
#include "tuina/sim/scanner/ray_scene.hpp"

namespace tuina::sim {
namespace {

constexpr double camera_m = 1.3;       // distance to the middle of the person
constexpr double half_width_m = 0.45;  // half width of the view at the middle of the person
constexpr double half_height_m = 0.60;
constexpr double floor_m = -0.45;
// Maximum radius of a hole, share of the picture's width.
constexpr double patch_share = 1.0 / 60.0;
constexpr double edge_m = 40_mm;  // depth step across which pixels mix

/// Person, couch and floor in one mesh.
Mesh scene_of(const Mesh& skin, BodyPosture position) {
  Mesh scene = skin;
  const auto add = [&](const Mesh& more) {
    const auto first = static_cast<int>(scene.vertices.size());
    scene.vertices.insert(scene.vertices.end(), more.vertices.begin(), more.vertices.end());
    for (const auto& t : more.triangles) {
      scene.triangles.push_back({first + t[0], first + t[1], first + t[2]});
    }
  };
  add(couch_mesh(position));
  add({.vertices = {{-3, -3, floor_m}, {3, -3, floor_m}, {3, 3, floor_m}, {-3, 3, floor_m}},
       .triangles = {{0, 1, 2}, {0, 2, 3}}});
  return scene;
}

struct View {
  Vector3 eye, forward, right, up;
};

View view_of(const Mesh& skin, BodyPosture position) {
  Vector3 low = skin.vertices.front();
  Vector3 high = low;
  for (const Vector3& p : skin.vertices) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const bool sitting = position == BodyPosture::sitting;
  const Vector3 out = sitting ? Vector3(Vector3::UnitY()) : Vector3(Vector3::UnitZ());
  return {.eye = 0.5 * (low + high) + camera_m * out,
          .forward = -out,
          .right = -Vector3::UnitX(),
          .up = sitting ? Vector3(Vector3::UnitZ()) : Vector3(-Vector3::UnitY())};
}

/// Ray of a pixel, counted from the upper left.
Vector3 sight_of(const View& view, int x, int y, int width, int height) {
  const double u = half_width_m * (2.0 * (x + 0.5) / width - 1.0);
  const double v = half_height_m * (1.0 - 2.0 * (y + 0.5) / height);
  return (camera_m * view.forward + u * view.right + v * view.up).normalized();
}

/// Share of the picture with an answer.
double share_seen(const RayScene& scene, const View& view) {
  constexpr int size = 60;
  int seen = 0;
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      if (scene.first_hit(view.eye, sight_of(view, x, y, size, size))) ++seen;
    }
  }
  return std::max(1, seen) / static_cast<double>(size * size);
}

/// Holes that cover a share of the picture.
std::vector<bool> holes_of(int width, int height, double share, Random& random) {
  std::vector<bool> lost(grid_cells(height, width), false);
  double area = share * width * height;
  while (area > 0.0) {
    const double radius = uniform(random, 0.2, 1.0) * patch_share * width;
    const double u = uniform(random, 0.0, width);
    const double v = uniform(random, 0.0, height);
    const auto in_picture = [](double at, int size) {
      return static_cast<int>(std::clamp(at, 0.0, static_cast<double>(size - 1)));
    };
    for (int y = in_picture(v - radius, height); y <= in_picture(v + radius, height); ++y) {
      for (int x = in_picture(u - radius, width); x <= in_picture(u + radius, width); ++x) {
        if (std::hypot(x - u, y - v) > radius) continue;
        lost[grid_index(y, width, x)] = true;
      }
    }
    area -= pi * radius * radius;
  }
  return lost;
}

}  // namespace

PointCloud depth_picture(const Mesh& skin_in_couch, BodyPosture position, std::uint64_t seed,
                         const DepthCameraOptions& options) {
  const RayScene scene(scene_of(skin_in_couch, position));
  const View view = view_of(skin_in_couch, position);
  Random random = make_random(seed, "depth camera");
  const double pixels = options.points / share_seen(scene, view);
  const int width = std::max(2, static_cast<int>(std::sqrt(pixels * half_width_m / half_height_m)));
  const int height = std::max(2, static_cast<int>(width * half_height_m / half_width_m));
  const std::vector<bool> lost = holes_of(width, height, options.holes, random);
  PointCloud cloud;
  cloud.points.reserve(lost.size());
  for (int y = 0; y < height; ++y) {
    double before_m = std::numeric_limits<double>::quiet_NaN();
    for (int x = 0; x < width; ++x) {
      const Vector3 sight = sight_of(view, x, y, width, height);
      const auto hit = scene.first_hit(view.eye, sight);
      if (!hit) continue;
      double range_m = hit->distance_m;
      // A pixel on an edge mixes both sides.
      const bool on_edge = std::abs(range_m - before_m) > edge_m;
      const double mixed_m = before_m + uniform(random, 0.0, 1.0) * (range_m - before_m);
      before_m = range_m;
      if (on_edge) range_m = mixed_m;
      if (uniform(random, 0.0, 1.0) < options.flying) range_m *= uniform(random, 0.5, 1.0);
      range_m += gaussian(random, options.noise_m);
      if (lost[grid_index(y, width, x)]) {
        continue;
      }
      cloud.points.emplace_back(view.eye + range_m * sight);
    }
  }
  return cloud;
}

}  // namespace tuina::sim
