// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tuina/core/acupoint.hpp"
#include "tuina/core/result.hpp"
#include "tuina/core/surface.hpp"

namespace tuina::body {

/// A back with known points, to learn from or to judge by: `<id>.ply` with `<id>.json` beside it,
/// in the `couch` frame of its position (docs/bodies.md).
struct LabelledBody {
  std::string id;
  std::string body_type;  ///< slim, medium or hefty
  Position position = Position::sitting;
  Mesh skin_in_couch;
  PointCloud scan_in_couch;  ///< the same person as a scanner sees them; empty: as the skin is
  std::vector<Acupoint> acupoints;  ///< the seven first, then the further ones, each group by name
  std::vector<Landmark> landmarks;
};

[[nodiscard]] Result<LabelledBody> read_labelled_body(const std::filesystem::path& ply);

/// Writes both files; the .json of `ply` gets its name.
[[nodiscard]] Result<void> write_labelled_body(const LabelledBody& body,
                                               const std::filesystem::path& ply);

/// One body, or all `*.ply` of a folder that have a .json beside them, by name.
[[nodiscard]] Result<std::vector<std::filesystem::path>> list_labelled_bodies(
    const std::filesystem::path& folder_or_ply);

/// A cloud that a scanner without fault would see: points of the skin at most `spacing_m` apart.
[[nodiscard]] PointCloud sample(const Mesh& skin, double spacing_m);

}  // namespace tuina::body
