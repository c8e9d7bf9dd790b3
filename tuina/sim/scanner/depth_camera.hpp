// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "tuina/core/acupoint.hpp"
#include "tuina/core/surface.hpp"

namespace tuina::sim {

struct DepthCameraOptions {
  int points = 300'000;   ///< about so many, of everything in view
  double noise_m = 3e-3;  ///< standard deviation along the line of sight
  double holes = 0.01;    ///< share of the picture without an answer, in patches
  double flying = 0.002;  ///< share of the points that hang anywhere on their line of sight
};

/// What one picture of a depth camera shows from behind (sitting) or above (prone), in `couch`: the
/// person, the couch, the floor, and where the picture crosses an edge, points that hang between
/// what is before it and behind it. Points come row by row.
[[nodiscard]] PointCloud depth_picture(const Mesh& skin_in_couch, Position position,
                                       std::uint64_t seed, const DepthCameraOptions& options = {});

}  // namespace tuina::sim
