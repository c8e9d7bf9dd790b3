// SPDX-License-Identifier: Apache-2.0
#include "tuina/sim/person/polygonise.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>

namespace tuina::sim {
namespace {

using Field = std::function<double(const Vector3&)>;
using Cell = std::array<int, 3>;

constexpr int coarse = 8;  // cells per side of a block that is rejected by its centre alone
constexpr int fine = 4;

/// Field values at the corners of the cells near the zero surface.
class Lattice {
 public:
  Lattice(const Field& field, const Box& box, double cell_m)
      : field_(field), low_(box.low), cell_m_(cell_m) {
    const Vector3 cells = ((box.high - box.low) / (cell_m * coarse)).array().ceil();
    for (std::size_t axis = 0; axis < 3; ++axis)
      size_[axis] = coarse * static_cast<int>(cells[static_cast<Eigen::Index>(axis)]) + 1;
    value_.assign(static_cast<std::size_t>(size_[0]) * static_cast<std::size_t>(size_[1]) *
                      static_cast<std::size_t>(size_[2]),
                  unknown);
    visit({0, 0, 0}, {size_[0] - 1, size_[1] - 1, size_[2] - 1}, coarse);
  }

  [[nodiscard]] std::size_t index(const Cell& at) const {
    return (static_cast<std::size_t>(at[2]) * static_cast<std::size_t>(size_[1]) +
            static_cast<std::size_t>(at[1])) *
               static_cast<std::size_t>(size_[0]) +
           static_cast<std::size_t>(at[0]);
  }
  [[nodiscard]] Vector3 place(const Cell& at) const {
    return low_ + cell_m_ * Vector3(at[0], at[1], at[2]);
  }
  [[nodiscard]] float value(const Cell& at) const { return value_[index(at)]; }
  [[nodiscard]] const std::vector<Cell>& blocks() const { return blocks_; }
  [[nodiscard]] std::size_t corners() const { return value_.size(); }

  static constexpr float unknown = 1e9F;

 private:
  void visit(const Cell& low, const Cell& high, int step) {
    // Half a diagonal, and a margin since the field is only roughly a distance.
    const double reach_m = 1.3 * std::sqrt(3.0) / 2.0 * step * cell_m_;
    for (int z = low[2]; z < high[2]; z += step) {
      for (int y = low[1]; y < high[1]; y += step) {
        for (int x = low[0]; x < high[0]; x += step) {
          const Vector3 middle =
              place({x, y, z}) + Vector3::Constant(0.5 * static_cast<double>(step) * cell_m_);
          if (std::abs(field_(middle)) > reach_m) continue;
          if (step == coarse) {
            visit({x, y, z}, {x + coarse, y + coarse, z + coarse}, fine);
          } else {
            sample({x, y, z});
          }
        }
      }
    }
  }

  void sample(const Cell& block) {
    blocks_.push_back(block);
    for (int z = block[2]; z <= block[2] + fine; ++z) {
      for (int y = block[1]; y <= block[1] + fine; ++y) {
        for (int x = block[0]; x <= block[0] + fine; ++x) {
          float& value = value_[index({x, y, z})];
          if (value == unknown) value = static_cast<float>(field_(place({x, y, z})));
        }
      }
    }
  }

  const Field& field_;
  Vector3 low_;
  double cell_m_;
  Cell size_ = {};
  std::vector<float> value_;
  std::vector<Cell> blocks_;
};

constexpr std::array<Cell, 8> corner_offsets = {
    {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {1, 1, 1}}};
constexpr std::array<std::array<std::size_t, 2>, 12> edges = {{{0, 1},
                                                               {2, 3},
                                                               {4, 5},
                                                               {6, 7},
                                                               {0, 2},
                                                               {1, 3},
                                                               {4, 6},
                                                               {5, 7},
                                                               {0, 4},
                                                               {1, 5},
                                                               {2, 6},
                                                               {3, 7}}};

Cell plus(const Cell& a, const Cell& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}

/// Mean of the surface's crossings with the edges of a cell; false without any.
bool crossing(const Lattice& lattice, const Cell& cell, Vector3& mean) {
  std::array<float, 8> value = {};
  int inside = 0;
  for (std::size_t i = 0; i < 8; ++i) {
    value[i] = lattice.value(plus(cell, corner_offsets[i]));
    inside += value[i] < 0.0F ? 1 : 0;
  }
  if (inside == 0 || inside == 8) return false;
  mean.setZero();
  int crossings = 0;
  for (const auto& [a, b] : edges) {
    if ((value[a] < 0.0F) == (value[b] < 0.0F)) continue;
    const double t = static_cast<double>(value[a] / (value[a] - value[b]));
    mean += (1.0 - t) * lattice.place(plus(cell, corner_offsets[a])) +
            t * lattice.place(plus(cell, corner_offsets[b]));
    ++crossings;
  }
  mean /= crossings;
  return true;
}

}  // namespace

Vector3 gradient_of(const Field& field, const Vector3& at) {
  constexpr double h = 5e-4;
  Vector3 gradient;
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3 step = h * Vector3::Unit(axis);
    gradient[axis] = (field(at + step) - field(at - step)) / (2.0 * h);
  }
  return gradient;
}

Mesh polygonise(const Field& field, const Box& box, double cell_m) {
  const Lattice lattice(field, box, cell_m);
  Mesh mesh;
  std::vector<int> vertex_of(lattice.corners(), -1);
  std::vector<Cell> cells;
  for (const Cell& block : lattice.blocks()) {
    for (int i = 0; i < fine * fine * fine; ++i) {
      const Cell cell = plus(block, {i % fine, i / fine % fine, i / (fine * fine)});
      Vector3 place;
      if (!crossing(lattice, cell, place)) continue;
      vertex_of[lattice.index(cell)] = static_cast<int>(mesh.vertices.size());
      mesh.vertices.push_back(place);
      cells.push_back(cell);
    }
  }
  // One quadrilateral per lattice edge that the surface crosses, from the four cells at that edge.
  for (const Cell& cell : cells) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::size_t u = (axis + 1) % 3;
      const std::size_t v = (axis + 2) % 3;
      if (cell[u] == 0 || cell[v] == 0) continue;
      Cell end = cell;
      ++end[axis];
      const bool starts_inside = lattice.value(cell) < 0.0F;
      if (starts_inside == (lattice.value(end) < 0.0F)) continue;
      Cell beside_u = cell;
      --beside_u[u];
      Cell beside_v = cell;
      --beside_v[v];
      Cell across = beside_u;
      --across[v];
      std::array<int, 4> ring = {vertex_of[lattice.index(cell)], vertex_of[lattice.index(beside_u)],
                                 vertex_of[lattice.index(across)],
                                 vertex_of[lattice.index(beside_v)]};
      if (*std::min_element(ring.begin(), ring.end()) < 0) continue;
      if (!starts_inside) std::reverse(ring.begin(), ring.end());
      mesh.triangles.push_back({ring[0], ring[1], ring[2]});
      mesh.triangles.push_back({ring[0], ring[2], ring[3]});
    }
  }
  for (Vector3& vertex : mesh.vertices) {
    const Vector3 slope = gradient_of(field, vertex);
    vertex -=
        slope * std::clamp(field(vertex), -cell_m, cell_m) / std::max(slope.squaredNorm(), 0.1);
  }
  return mesh;
}

namespace {

/// Largest connected set of triangles, with only the vertices it uses.
Mesh largest_piece(const Mesh& mesh) {
  std::vector<int> root(mesh.vertices.size());
  std::iota(root.begin(), root.end(), 0);
  const auto find = [&](int i) {
    while (root[static_cast<std::size_t>(i)] != i) {
      auto& parent = root[static_cast<std::size_t>(i)];
      parent = root[static_cast<std::size_t>(parent)];
      i = parent;
    }
    return i;
  };
  for (const auto& triangle : mesh.triangles) {
    for (const std::size_t corner : {1U, 2U}) {
      root[static_cast<std::size_t>(find(triangle[corner]))] = find(triangle[0]);
    }
  }
  std::vector<int> size(mesh.vertices.size(), 0);
  for (const auto& triangle : mesh.triangles) ++size[static_cast<std::size_t>(find(triangle[0]))];
  const auto largest = static_cast<int>(std::max_element(size.begin(), size.end()) - size.begin());

  Mesh piece;
  std::vector<int> renamed(mesh.vertices.size(), -1);
  for (const auto& triangle : mesh.triangles) {
    if (find(triangle[0]) != largest) continue;
    std::array<int, 3> kept = {};
    for (std::size_t i = 0; i < 3; ++i) {
      int& name = renamed[static_cast<std::size_t>(triangle[i])];
      if (name < 0) {
        name = static_cast<int>(piece.vertices.size());
        piece.vertices.push_back(mesh.vertices[static_cast<std::size_t>(triangle[i])]);
      }
      kept[i] = name;
    }
    piece.triangles.push_back(kept);
  }
  return piece;
}

}  // namespace

Mesh cut(const Mesh& mesh, const std::vector<double>& keep) {
  Mesh rest;
  rest.vertices = mesh.vertices;
  std::map<std::pair<int, int>, int> cut_edges;
  const auto kept = [&](int i) { return keep[static_cast<std::size_t>(i)] > 0.0; };
  const auto cut_at = [&](int a, int b) {
    const auto [entry, fresh] =
        cut_edges.try_emplace(std::minmax(a, b), static_cast<int>(rest.vertices.size()));
    if (fresh) {
      const double ka = keep[static_cast<std::size_t>(a)];
      const double t = ka / (ka - keep[static_cast<std::size_t>(b)]);
      rest.vertices.emplace_back((1.0 - t) * mesh.vertices[static_cast<std::size_t>(a)] +
                                 t * mesh.vertices[static_cast<std::size_t>(b)]);
    }
    return entry->second;
  };
  for (auto triangle : mesh.triangles) {
    const int inside = kept(triangle[0]) + kept(triangle[1]) + kept(triangle[2]);
    if (inside == 0) continue;
    if (inside == 3) {
      rest.triangles.push_back(triangle);
      continue;
    }
    // Rotated so that the corner alone on its side of the cut comes first.
    while (kept(triangle[0]) != (inside == 1) || kept(triangle[1]) == (inside == 1)) {
      std::rotate(triangle.begin(), triangle.begin() + 1, triangle.end());
    }
    const int ab = cut_at(triangle[0], triangle[1]);
    const int ac = cut_at(triangle[0], triangle[2]);
    if (inside == 1) {
      rest.triangles.push_back({triangle[0], ab, ac});
    } else {
      rest.triangles.push_back({ab, triangle[1], triangle[2]});
      rest.triangles.push_back({ab, triangle[2], ac});
    }
  }
  return largest_piece(rest);
}

}  // namespace tuina::sim
