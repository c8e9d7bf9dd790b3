// SPDX-License-Identifier: Apache-2.0
#include "tuina/telemetry/picture/scan_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tuina/core/grid.hpp"

namespace tuina::telemetry {
namespace {

constexpr float nothing = -std::numeric_limits<float>::infinity();
constexpr float layer_m = 0.008F;  // points this far behind the foremost one are another layer
constexpr float step_m = 0.025F;   // neighbours further apart than this are not one surface
constexpr float steepest = 4.0F;   // beyond 76 degrees a grazing view has more noise than shape

/// Heights over a rectangle of cells; `nothing` where none is known.
struct Grid {
  int width = 0;
  int height = 0;
  std::vector<float> at;

  [[nodiscard]] std::size_t index(int column, int row) const {
    return grid_index(row, width, column);
  }
  [[nodiscard]] bool known(int column, int row) const {
    return column >= 0 && row >= 0 && column < width && row < height &&
           at[index(column, row)] != nothing;
  }
};

/// Each unknown cell with enough known neighbours becomes their mean.
void grow(Grid& grid, int neighbours_needed) {
  const Grid before = grid;
  for (int row = 0; row < grid.height; ++row) {
    for (int column = 0; column < grid.width; ++column) {
      if (before.known(column, row)) continue;
      float sum = 0.F;
      int count = 0;
      for (int k = 0; k < 9; ++k) {
        if (!before.known(column + k % 3 - 1, row + k / 3 - 1)) continue;
        sum += before.at[before.index(column + k % 3 - 1, row + k / 3 - 1)];
        ++count;
      }
      if (count >= neighbours_needed)
        grid.at[grid.index(column, row)] = sum / static_cast<float>(count);
    }
  }
}

/// A cell becomes the mean of itself and of those neighbours that lie on the same surface.
void smooth(Grid& grid) {
  const Grid before = grid;
  for (int row = 0; row < grid.height; ++row) {
    for (int column = 0; column < grid.width; ++column) {
      if (!before.known(column, row)) continue;
      const float here = before.at[before.index(column, row)];
      float sum = 0.F;
      float weights = 0.F;
      for (int k = 0; k < 9; ++k) {
        const int c = column + k % 3 - 1;
        const int r = row + k / 3 - 1;
        if (!before.known(c, r)) continue;
        const float there = before.at[before.index(c, r)];
        if (std::abs(there - here) > 2.F * layer_m) continue;
        const float weight = k == 4 ? 4.F : k % 2 == 1 ? 2.F : 1.F;
        sum += weight * there;
        weights += weight;
      }
      grid.at[grid.index(column, row)] = sum / weights;
    }
  }
}

/// Leaves only the largest connected piece and those at least a tenth of it: specks are not a
/// person.
void drop_specks(Grid& grid) {
  std::vector<int> piece(grid.at.size(), -1);
  std::vector<std::size_t> sizes;
  std::vector<std::pair<int, int>> open;
  for (int row = 0; row < grid.height; ++row) {
    for (int column = 0; column < grid.width; ++column) {
      if (!grid.known(column, row) || piece[grid.index(column, row)] >= 0) continue;
      const int number = static_cast<int>(sizes.size());
      sizes.push_back(0);
      piece[grid.index(column, row)] = number;
      open.emplace_back(column, row);
      while (!open.empty()) {
        const auto [c, r] = open.back();
        open.pop_back();
        ++sizes.back();
        for (int k = 1; k < 9; k += 2) {
          const int nc = c + k % 3 - 1;
          const int nr = r + k / 3 - 1;
          if (!grid.known(nc, nr) || piece[grid.index(nc, nr)] >= 0) continue;
          piece[grid.index(nc, nr)] = number;
          open.emplace_back(nc, nr);
        }
      }
    }
  }
  if (sizes.empty()) return;
  const std::size_t largest = *std::max_element(sizes.begin(), sizes.end());
  for (std::size_t k = 0; k < piece.size(); ++k) {
    if (piece[k] >= 0 && sizes[static_cast<std::size_t>(piece[k])] * 10 < largest)
      grid.at[k] = nothing;
  }
}

/// Forgets cells where the surface turns away from the eye.
void drop_steep(Grid& grid, float cell_m) {
  const Grid before = grid;
  const auto slope = [&](int column, int row, int right, int down) {
    const bool ahead = before.known(column + right, row + down);
    const bool behind = before.known(column - right, row - down);
    if (!ahead && !behind) return 0.F;
    const float here = before.at[before.index(column, row)];
    const float next = ahead ? before.at[before.index(column + right, row + down)] : here;
    const float last = behind ? before.at[before.index(column - right, row - down)] : here;
    return (next - last) / (cell_m * static_cast<float>(int{ahead} + int{behind}));
  };
  for (int row = 0; row < grid.height; ++row) {
    for (int column = 0; column < grid.width; ++column) {
      if (!before.known(column, row)) continue;
      const float steep = std::hypot(slope(column, row, 1, 0), slope(column, row, 0, 1));
      if (steep > steepest) grid.at[grid.index(column, row)] = nothing;
    }
  }
}

/// 1 inside the known region, 0 outside, blurred over a few cells so that its middle value is a
/// smooth line.
std::vector<float> soft_mask(const Grid& grid) {
  std::vector<float> mask(grid.at.size());
  for (std::size_t k = 0; k < mask.size(); ++k) mask[k] = grid.at[k] == nothing ? 0.F : 1.F;
  std::vector<float> other(mask.size());
  for (int pass = 0; pass < 6; ++pass) {
    const bool across = pass % 2 == 0;
    for (int row = 0; row < grid.height; ++row) {
      for (int column = 0; column < grid.width; ++column) {
        float sum = 0.F;
        for (int k = -1; k <= 1; ++k) {
          const int c = std::clamp(column + (across ? k : 0), 0, grid.width - 1);
          const int r = std::clamp(row + (across ? 0 : k), 0, grid.height - 1);
          sum += mask[grid.index(c, r)];
        }
        other[grid.index(column, row)] = sum / 3.F;
      }
    }
    mask.swap(other);
  }
  return mask;
}

void add_normals(PictureMesh& picture) {
  picture.normals.assign(picture.mesh.vertices.size(), Vector3::Zero());
  const auto& vertices = picture.mesh.vertices;
  for (const auto& triangle : picture.mesh.triangles) {
    const auto a = static_cast<std::size_t>(triangle[0]);
    const auto b = static_cast<std::size_t>(triangle[1]);
    const auto c = static_cast<std::size_t>(triangle[2]);
    const Vector3 area = (vertices[b] - vertices[a]).cross(vertices[c] - vertices[a]);
    for (const std::size_t corner : {a, b, c}) picture.normals[corner] += area;
  }
  for (Vector3& normal : picture.normals) normal.normalize();
}

/// Where a grid lies: its axes, the place of its first cell, and the size of a cell.
struct Place {
  Matrix3 grid_from_couch;
  Vector3 low;
  double cell_m;

  [[nodiscard]] Vector3 in_couch(int column, int row, float height) const {
    const Vector3 at(low.x() + (column + 0.5) * cell_m, low.y() + (row + 0.5) * cell_m,
                     static_cast<double>(height));
    return grid_from_couch.transpose() * at;
  }
};

/// The mean height of the foremost layer in each cell; around it stay a few empty cells.
Grid front_layer(const PointCloud& scan, Place& place) {
  constexpr int margin = 5, max_cells = 1500;
  Eigen::AlignedBox3d box;
  for (const Vector3& point : scan.points) box.extend(place.grid_from_couch * point);
  // A cloud with a stray point far away would ask for an endless grid; it gets coarser cells
  // instead.
  place.cell_m =
      std::max(place.cell_m, box.sizes().head<2>().maxCoeff() / (max_cells - 2 * margin));
  place.low = box.min() - Vector3::Constant(margin * place.cell_m);
  const auto cells = [&](double length) {
    return static_cast<int>(length / place.cell_m) + 1 + 2 * margin;
  };
  Grid front{.width = cells(box.sizes().x()), .height = cells(box.sizes().y()), .at = {}};
  front.at.assign(front.index(0, front.height), nothing);
  const auto cell_of = [&](const Vector3& p) {
    return front.index(static_cast<int>((p.x() - box.min().x()) / place.cell_m) + margin,
                       static_cast<int>((p.y() - box.min().y()) / place.cell_m) + margin);
  };
  for (const Vector3& point : scan.points) {
    const Vector3 p = place.grid_from_couch * point;
    front.at[cell_of(p)] = std::max(front.at[cell_of(p)], static_cast<float>(p.z()));
  }
  std::vector<float> sum(front.at.size(), 0.F);
  std::vector<float> count(front.at.size(), 0.F);
  for (const Vector3& point : scan.points) {
    const Vector3 p = place.grid_from_couch * point;
    const std::size_t cell = cell_of(p);
    if (static_cast<float>(p.z()) < front.at[cell] - layer_m) continue;
    sum[cell] += static_cast<float>(p.z());
    count[cell] += 1.F;
  }
  for (std::size_t k = 0; k < count.size(); ++k) {
    if (count[k] > 0.F) front.at[k] = sum[k] / count[k];
  }
  return front;
}

/// Two triangles for every four neighbours that are known and lie on one surface.
void add_triangles(PictureMesh& picture, const Grid& grid, const std::vector<int>& vertex_of) {
  for (int row = 0; row + 1 < grid.height; ++row) {
    for (int column = 0; column + 1 < grid.width; ++column) {
      const std::array<std::size_t, 4> corner = {
          grid.index(column, row), grid.index(column + 1, row), grid.index(column + 1, row + 1),
          grid.index(column, row + 1)};
      for (const std::array<std::size_t, 3>& three :
           {std::array<std::size_t, 3>{0, 1, 2}, std::array<std::size_t, 3>{0, 2, 3}}) {
        float low = std::numeric_limits<float>::infinity();
        float high = nothing;
        std::array<int, 3> triangle = {};
        for (std::size_t k = 0; k < 3; ++k) {
          const std::size_t cell = corner[three[k]];
          triangle[k] = vertex_of[cell];
          low = std::min(low, grid.at[cell]);
          high = std::max(high, grid.at[cell]);
        }
        // An unknown corner is infinitely low.
        if (high - low < step_m) picture.mesh.triangles.push_back(triangle);
      }
    }
  }
}

}  // namespace

PictureMesh mesh_scan(const PointCloud& scan, const Vector3& toward_eye, double cell_m) {
  PictureMesh picture;
  if (scan.size() == 0) return picture;
  const Vector3 forward = toward_eye.normalized();
  const Vector3 right = forward.unitOrthogonal();
  Place place{.grid_from_couch = Matrix3(), .low = Vector3::Zero(), .cell_m = cell_m};
  place.grid_from_couch << right.transpose(), forward.cross(right).transpose(), forward.transpose();
  Grid grid = front_layer(scan, place);
  for (int k = 0; k < 4; ++k) grow(grid, 4);
  for (int k = 0; k < 4; ++k) smooth(grid);
  drop_steep(grid, static_cast<float>(place.cell_m));
  drop_specks(grid);
  for (int k = 0; k < 3; ++k) grow(grid, 5);
  for (int k = 0; k < 2; ++k) smooth(grid);
  const std::vector<float> mask = soft_mask(grid);
  // The surface goes on a little beyond what was seen; the mask says where the picture of it ends.
  for (int k = 0; k < 3; ++k) grow(grid, 2);
  for (int k = 0; k < 2; ++k) smooth(grid);

  std::vector<int> vertex_of(grid.at.size(), -1);
  for (int row = 0; row < grid.height; ++row) {
    for (int column = 0; column < grid.width; ++column) {
      if (!grid.known(column, row)) continue;
      const std::size_t cell = grid.index(column, row);
      vertex_of[cell] = static_cast<int>(picture.mesh.vertices.size());
      picture.mesh.vertices.push_back(place.in_couch(column, row, grid.at[cell]));
      picture.inside.push_back(mask[cell]);
    }
  }
  add_triangles(picture, grid, vertex_of);
  add_normals(picture);
  return picture;
}

PictureMesh mesh_for_picture(const Mesh& surface) {
  PictureMesh picture{.mesh = surface, .normals = {}, .inside = {}};
  picture.inside.assign(surface.vertices.size(), 1.F);
  add_normals(picture);
  return picture;
}

}  // namespace tuina::telemetry
