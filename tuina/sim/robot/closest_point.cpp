// SPDX-License-Identifier: Apache-2.0
#include "tuina/sim/robot/closest_point.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

namespace tuina::sim {
namespace {

constexpr int leaf_triangles = 4;
// Depth limit; the tree is balanced, so this suffices for 2^64 triangles.
constexpr int deepest = 64;

}  // namespace

ClosestPoint::ClosestPoint(Mesh mesh) : mesh_(std::move(mesh)) {
  assert(!mesh_.triangles.empty());
  std::vector<Vector3> centres;
  centres.reserve(mesh_.triangles.size());
  for (const auto& [a, b, c] : mesh_.triangles) {
    const auto& v = mesh_.vertices;
    centres.emplace_back((v[static_cast<std::size_t>(a)] + v[static_cast<std::size_t>(b)] +
                          v[static_cast<std::size_t>(c)]) /
                         3.0);
  }
  order_.resize(mesh_.triangles.size());
  for (std::size_t i = 0; i < order_.size(); ++i) order_[i] = static_cast<int>(i);
  nodes_.reserve(2 * order_.size());
  nodes_.emplace_back();
  split(0, 0, static_cast<int>(order_.size()), centres);
}

void ClosestPoint::split(int node, int first, int last, const std::vector<Vector3>& centres) {
  Eigen::AlignedBox3d box, of_centres;
  for (int i = first; i < last; ++i) {
    const auto triangle = static_cast<std::size_t>(order_[static_cast<std::size_t>(i)]);
    for (const int corner : mesh_.triangles[triangle]) {
      box.extend(mesh_.vertices[static_cast<std::size_t>(corner)]);
    }
    of_centres.extend(centres[triangle]);
  }
  nodes_[static_cast<std::size_t>(node)] = {box.min(), box.max(), first, last - first};
  if (last - first <= leaf_triangles) return;

  int axis = 0;
  of_centres.sizes().maxCoeff(&axis);
  const int middle = first + (last - first) / 2;
  // Ties are broken by index, so that the tree does not depend on the library's nth_element.
  std::nth_element(order_.begin() + first, order_.begin() + middle, order_.begin() + last,
                   [&](int a, int b) {
                     const double at_a = centres[static_cast<std::size_t>(a)][axis];
                     const double at_b = centres[static_cast<std::size_t>(b)][axis];
                     return at_a != at_b ? at_a < at_b : a < b;
                   });
  const int left = static_cast<int>(nodes_.size());
  nodes_[static_cast<std::size_t>(node)].first = left;
  nodes_[static_cast<std::size_t>(node)].count = 0;
  nodes_.emplace_back();
  nodes_.emplace_back();
  split(left, first, middle, centres);
  split(left + 1, middle, last, centres);
}

// Closest point by Voronoi regions, [ericson2005] 5.1.5.
ClosestPoint::Place ClosestPoint::on_triangle(int triangle, const Vector3& p) const noexcept {
  const auto& corners = mesh_.triangles[static_cast<std::size_t>(triangle)];
  const Vector3& a = mesh_.vertices[static_cast<std::size_t>(corners[0])];
  const Vector3& b = mesh_.vertices[static_cast<std::size_t>(corners[1])];
  const Vector3& c = mesh_.vertices[static_cast<std::size_t>(corners[2])];
  const auto place = [&](double wa, double wb, double wc) {
    const Vector3 at = wa * a + wb * b + wc * c;
    return Place{triangle, at, {wa, wb, wc}, (p - at).norm()};
  };
  const Vector3 ab = b - a, ac = c - a, ap = p - a;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0.0 && d2 <= 0.0) return place(1, 0, 0);
  const Vector3 bp = p - b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0.0 && d4 <= d3) return place(0, 1, 0);
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return place(1 - d1 / (d1 - d3), d1 / (d1 - d3), 0);
  const Vector3 cp = p - c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0.0 && d5 <= d6) return place(0, 0, 1);
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return place(1 - d2 / (d2 - d6), 0, d2 / (d2 - d6));
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0) {
    const double w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return place(0, 1 - w, w);
  }
  const double sum = va + vb + vc;
  if (!(sum > 0.0)) return place(1, 0, 0);  // degenerate triangle
  return place(va / sum, vb / sum, vc / sum);
}

ClosestPoint::Place ClosestPoint::find(const Vector3& point, int hint_triangle) const noexcept {
  const auto square_to = [&point](const Node& node) {
    return (node.low - point).cwiseMax(point - node.high).cwiseMax(0.0).squaredNorm();
  };
  Place best = on_triangle(hint_triangle, point);
  double best_square = best.distance_m * best.distance_m;
  std::array<int, deepest> waiting;
  std::size_t count = 0;
  waiting[count++] = 0;
  while (count > 0) {
    const Node& node = nodes_[static_cast<std::size_t>(waiting[--count])];
    if (square_to(node) >= best_square) continue;
    if (node.count == 0) {
      const int left = node.first;
      const auto at = static_cast<std::size_t>(left);
      const bool left_is_closer = square_to(nodes_[at]) < square_to(nodes_[at + 1]);
      waiting[count++] = left_is_closer ? left + 1 : left;
      waiting[count++] = left_is_closer ? left : left + 1;
      continue;
    }
    for (int i = node.first; i < node.first + node.count; ++i) {
      const Place place = on_triangle(order_[static_cast<std::size_t>(i)], point);
      if (place.distance_m < best.distance_m) {
        best = place;
        best_square = best.distance_m * best.distance_m;
      }
    }
  }
  return best;
}

}  // namespace tuina::sim
