// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "tuina/core/acupoint.hpp"
#include "tuina/core/surface.hpp"

namespace tuina::sim {

struct DepthCameraOptions {
  int points = 300'000;   ///< approximate number of points, of everything in view
  double noise_m = 3e-3;  ///< standard deviation along the line of sight
  double holes = 0.01;    ///< share of the picture without an answer, in patches
  double flying = 0.002;  ///< share of points at random depth
};

/// Picture of a depth camera from behind (sitting) or above (prone), in `couch`, row by row:
/// person, couch and floor, with flying pixels at depth edges.
[[nodiscard]] PointCloud depth_picture(const Mesh& skin_in_couch, BodyPosture position,
                                       std::uint64_t seed, const DepthCameraOptions& options = {});

}  // namespace tuina::sim
