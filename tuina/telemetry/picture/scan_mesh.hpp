// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "tuina/core/surface.hpp"

namespace tuina::telemetry {

/// A mesh made to be looked at: with a normal per vertex, and how far inside the seen region the
/// vertex lies (0 beyond its edge, 1 inside; 0.5 is the edge), so that a picture can end in a
/// smooth line.
struct PictureMesh {
  Mesh mesh;
  std::vector<Vector3> normals;
  std::vector<float> inside;
};

/// Meshes a scan as a height field seen against `toward_eye`: the front layer of the points, small
/// holes closed, noise smoothed. For pictures only: it moves points by a fraction of the cell.
[[nodiscard]] PictureMesh mesh_scan(const PointCloud& scan, const Vector3& toward_eye,
                                    double cell_m = 0.003);

/// The same for a surface that is a mesh already.
[[nodiscard]] PictureMesh mesh_for_picture(const Mesh& surface);

}  // namespace tuina::telemetry
