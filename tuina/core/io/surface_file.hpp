// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "tuina/core/result.hpp"
#include "tuina/core/surface.hpp"

namespace tuina {

/// Content of a cloud or mesh file; a cloud has no triangles. Triangles that meet fewer than half
/// of the points are left out: the points, not they, show the surface.
struct SurfaceFile {
  PointCloud cloud;  ///< vertices, with the properties that tuina knows
  std::vector<std::array<int, 3>> triangles;
  /// Non-finite points, left out together with the triangles that used them.
  std::size_t dropped_points = 0;
};

/// Reads PLY (ascii, binary of either endianness) or PCD (ascii, binary, binary_compressed),
/// recognised by content. Fails on malformed files with file, line or byte, and the remedy. Memory
/// is bounded by the size of the file, never by the counts in its header.
[[nodiscard]] Result<SurfaceFile> read_surface(const std::filesystem::path& path);
/// The same of a text; `name` stands for the file in what is wrong.
[[nodiscard]] Result<SurfaceFile> parse_surface(std::string_view content, std::string_view name);

/// Binary little-endian PLY in metres, with normals, amplitude and deviation if the cloud has them.
[[nodiscard]] std::string to_ply(const PointCloud& cloud);
/// Binary little-endian PLY in metres, with triangles.
[[nodiscard]] std::string to_ply(const Mesh& mesh);

/// The formats of clouds that are written.
enum class CloudFormat { ply_ascii, ply_binary, ply_big_endian, pcd_ascii, pcd_binary };
/// "ply", "ply-ascii", "ply-big-endian", "pcd", "pcd-ascii".
[[nodiscard]] std::optional<CloudFormat> cloud_format(std::string_view name);

/// Writes a cloud in pieces, so that memory does not grow with the number of points.
[[nodiscard]] Result<void> write_cloud(const std::filesystem::path& path, const PointCloud& cloud,
                                       CloudFormat format = CloudFormat::ply_binary);

}  // namespace tuina
