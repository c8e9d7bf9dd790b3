// SPDX-License-Identifier: Apache-2.0
#include "tuina/body/voxels.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace tuina::body {
namespace {

constexpr int bits = 21;
constexpr int half = 1 << (bits - 1);

std::uint64_t key_of(const std::array<int, 3>& place) {
  std::uint64_t key = 0;
  for (const int number : place) key = key << bits | static_cast<std::uint64_t>(number + half);
  return key;
}

std::array<int, 3> place_of(const Vector3& point, double size_m) {
  const auto whole = [&](double x) { return static_cast<int>(std::floor(x / size_m)); };
  return {whole(point.x()), whole(point.y()), whole(point.z())};
}

}  // namespace

int Voxels::at(const std::array<int, 3>& where) const {
  const std::uint64_t wanted = key_of(where);
  const auto column = static_cast<std::int64_t>(wanted >> bits);
  const auto first = std::lower_bound(row.begin(), row.end(), std::pair{column, -1});
  if (first == row.end() || first->first != column) return -1;
  const auto end = std::next(first) == row.end()
                       ? key.size()
                       : static_cast<std::size_t>(std::next(first)->second);
  const auto from = key.begin() + first->second;
  const auto to = key.begin() + static_cast<std::ptrdiff_t>(end);
  const auto found = std::lower_bound(from, to, wanted);
  return found != to && *found == wanted ? static_cast<int>(found - key.begin()) : -1;
}

int Voxels::around(const Vector3& point) const {
  return at(place_of(point, size_m));
}

Voxels gather(const std::vector<Vector3>& points, double size_m) {
  std::vector<std::pair<std::uint64_t, std::uint32_t>> order(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    order[i] = {key_of(place_of(points[i], size_m)), static_cast<std::uint32_t>(i)};
  }
  std::sort(order.begin(), order.end());
  Voxels voxels;
  voxels.size_m = size_m;
  for (std::size_t begin = 0; begin < order.size();) {
    std::size_t end = begin;
    Vector3 sum = Vector3::Zero();
    for (; end < order.size() && order[end].first == order[begin].first; ++end) {
      sum += points[order[end].second];
    }
    const Vector3 mean = sum / static_cast<double>(end - begin);
    Matrix3 scatter = Matrix3::Zero();
    for (std::size_t i = begin; i < end; ++i) {
      const Vector3 offset = points[order[i].second] - mean;
      scatter.noalias() += offset * offset.transpose();
    }
    const auto column = static_cast<std::int64_t>(order[begin].first >> bits);
    if (voxels.row.empty() || voxels.row.back().first != column) {
      voxels.row.emplace_back(column, static_cast<int>(voxels.key.size()));
    }
    voxels.key.push_back(order[begin].first);
    voxels.place.push_back(place_of(points[order[begin].second], size_m));
    voxels.count.push_back(static_cast<int>(end - begin));
    voxels.mean.push_back(mean);
    voxels.scatter.push_back(scatter);
    begin = end;
  }
  return voxels;
}

Components connect(const Voxels& voxels) {
  constexpr int none = -1;
  std::vector<int> found(voxels.size(), none);
  std::vector<int> points;
  std::vector<int> frontier;
  for (std::size_t seed = 0; seed < voxels.size(); ++seed) {
    if (found[seed] != none) continue;
    const int number = static_cast<int>(points.size());
    points.push_back(0);
    found[seed] = number;
    frontier.assign(1, static_cast<int>(seed));
    while (!frontier.empty()) {
      const auto here = static_cast<std::size_t>(frontier.back());
      frontier.pop_back();
      points.back() += voxels.count[here];
      for (int k = 0; k < 27; ++k) {
        const auto& p = voxels.place[here];
        const int next = voxels.at({p[0] + k / 9 - 1, p[1] + k / 3 % 3 - 1, p[2] + k % 3 - 1});
        if (next < 0 || found[static_cast<std::size_t>(next)] != none) continue;
        found[static_cast<std::size_t>(next)] = number;
        frontier.push_back(next);
      }
    }
  }
  std::vector<int> by_size(points.size());
  std::iota(by_size.begin(), by_size.end(), 0);
  std::stable_sort(by_size.begin(), by_size.end(), [&](int a, int b) {
    return points[static_cast<std::size_t>(a)] > points[static_cast<std::size_t>(b)];
  });
  std::vector<int> rank(points.size());
  Components components;
  for (std::size_t i = 0; i < by_size.size(); ++i) {
    rank[static_cast<std::size_t>(by_size[i])] = static_cast<int>(i);
    components.points.push_back(points[static_cast<std::size_t>(by_size[i])]);
  }
  for (const int number : found)
    components.of_voxel.push_back(rank[static_cast<std::size_t>(number)]);
  return components;
}

}  // namespace tuina::body
