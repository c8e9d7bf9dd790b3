// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "tuina/core/acupoint.hpp"
#include "tuina/core/result.hpp"
#include "tuina/core/surface.hpp"

namespace tuina::body {

/// A back with known points, for learning or evaluation: `<id>.ply` and `<id>.json`, in the `couch`
/// frame of its position (docs/bodies.md).
struct LabelledBody {
  std::string id;
  std::string body_type;  ///< slim, medium or hefty
  BodyPosture position = BodyPosture::sitting;
  Mesh skin_in_couch;
  PointCloud scan_in_couch;         ///< scan of the same person; empty: the skin is used
  std::vector<Acupoint> acupoints;  ///< the seven first, then the others, each group sorted by name
  std::vector<Landmark> landmarks;
};

/// Refuses a skin that is not in metres, an acupoint more than 30 mm or a landmark more than 50 mm
/// off the skin, a normal whose length is not 1 or that points into the body, and labels whose
/// sides or order along the spine are swapped, with file, label and value.
[[nodiscard]] Result<LabelledBody> read_labelled_body(const std::filesystem::path& ply);

/// Writes `ply` and the .json beside it.
[[nodiscard]] Result<void> write_labelled_body(const LabelledBody& body,
                                               const std::filesystem::path& ply);

/// One body, or all `*.ply` of a folder with a .json beside them, sorted by name.
[[nodiscard]] Result<std::vector<std::filesystem::path>> list_labelled_bodies(
    const std::filesystem::path& folder_or_ply);

/// Samples the skin like a scanner without errors: points at most `spacing_m` apart; in the largest
/// triangles, which are no skin, farther where all would be more than `max_points`.
[[nodiscard]] PointCloud sample(const Mesh& skin, double spacing_m,
                                std::size_t max_points = std::numeric_limits<std::size_t>::max());

/// Limit for a mesh that nobody has looked at: one in millimetres, or of a room, must not fill the
/// memory before it is refused.
inline constexpr std::size_t max_mesh_points = 3'000'000;

}  // namespace tuina::body
