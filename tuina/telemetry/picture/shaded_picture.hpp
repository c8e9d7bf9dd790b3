// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "tuina/core/image.hpp"
#include "tuina/telemetry/picture/projection.hpp"
#include "tuina/telemetry/picture/scan_mesh.hpp"
#include "tuina/telemetry/plot/colours.hpp"

namespace tuina::telemetry {

/// A thread laid on the skin.
struct Thread {
  std::vector<Vector3> points = {};
  double radius_m = 0.0015;
  Colour colour;
};

/// A bead pinned to the skin.
struct Bead {
  Vector3 at = Vector3::Zero();
  double radius_m = 0.004;
  Colour colour;
};

/// A tint of everything on the skin within a radius, with a rim: an uncertainty.
struct Disc {
  Vector3 at = Vector3::Zero();
  double radius_m = 0.01;
  Colour colour;
};

/// Everything that a picture shows.
struct Scene {
  PictureMesh surface;
  std::vector<Colour> colours = {};  ///< one per vertex, or empty for `colour`
  Colour colour = palette::skin;
  std::vector<Thread> threads = {};
  std::vector<Bead> beads = {};
  std::vector<Disc> discs = {};
  std::vector<Vector3> in_frame = {};  ///< places that the picture shows besides the surface
};

/// A drawn scene, and where its places are.
struct ShadedPicture {
  Image image;  ///< RGB on white
  Projection projection;
};

/// Draws the scene with soft light from the upper left, shadows, and hollows a little darker. The
/// surface must have triangles.
[[nodiscard]] ShadedPicture shade(const Scene& scene, const View& view);

}  // namespace tuina::telemetry
