// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

#include "tuina/body/acupoints.hpp"
#include "tuina/core/surface.hpp"
#include "tuina/massage/plan.hpp"

namespace tuina::app {

// What a page draws of a person. Places are in couch, in metres; binary numbers are little-endian.

/// The scanned skin as a mesh: counts of vertices and triangles (uint32), places and normals (three
/// float32 each), corners of the triangles (three uint32 each), and for each vertex the number of
/// its zone in `massage::zone_rules` (uint8).
[[nodiscard]] std::string back_bytes(const PointCloud& cloud_in_couch,
                                     std::span<const Acupoint> acupoints,
                                     std::span<const Landmark> landmarks);

/// JSON object of the acupoints and how well they are known.
[[nodiscard]] std::string map_json(BodyPosture position, std::span<const Acupoint> acupoints);

/// JSON object of what is to be done, its paths with at most 60 places each.
[[nodiscard]] std::string plan_json(const massage::Plan& plan);

}  // namespace tuina::app
