// SPDX-License-Identifier: Apache-2.0
#include "tuina/scanner/profile_grid.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

namespace tuina::scanner {

// The lit neighbour so many profiles and rows on, if it lies near enough to be on the same surface.
const ProfileGrid::Node* ProfileGrid::neighbour(std::size_t profile, std::size_t row,
                                                int profiles_on, int rows_on) const {
  const auto i = static_cast<std::ptrdiff_t>(profile) + profiles_on;
  const auto j = static_cast<std::ptrdiff_t>(row) + rows_on;
  if (i < 0 || j < 0 || i >= static_cast<std::ptrdiff_t>(profiles_) ||
      j >= static_cast<std::ptrdiff_t>(rows_)) {
    return nullptr;
  }
  const Node& here = at(profile, row);
  const Node& there = at(static_cast<std::size_t>(i), static_cast<std::size_t>(j));
  if (!there.lit) return nullptr;
  const float reach = here.reach_profiles_m * static_cast<float>(std::abs(profiles_on)) +
                      here.reach_rows_m * static_cast<float>(std::abs(rows_on));
  const double distance2 = (there.point - here.point).squaredNorm();
  return distance2 <= static_cast<double>(reach) * static_cast<double>(reach) ? &there : nullptr;
}

bool ProfileGrid::trustworthy(std::size_t profile, std::size_t row) const {
  const Node& here = at(profile, row);
  std::array<float, 12> amplitudes;
  std::size_t near = 0;
  int in_rows = 0;
  int in_profiles = 0;
  for (const int rows_on : {-3, -2, -1, 1, 2, 3}) {
    if (const Node* node = neighbour(profile, row, 0, rows_on)) {
      amplitudes[near++] = node->amplitude_dn;
      ++in_rows;
    }
  }
  for (const int profiles_on : {-1, 1}) {
    for (const int rows_on : {-1, 0, 1}) {
      if (const Node* node = neighbour(profile, row, profiles_on, rows_on)) {
        amplitudes[near++] = node->amplitude_dn;
        ++in_profiles;
      }
    }
  }
  if (in_rows < 3 || (in_profiles < 2 && profiles_ > 2)) return false;
  const auto middle = amplitudes.begin() + static_cast<std::ptrdiff_t>(near / 2);
  std::nth_element(amplitudes.begin(), middle,
                   amplitudes.begin() + static_cast<std::ptrdiff_t>(near));
  return here.amplitude_dn > 0.6F * *middle;
}

std::optional<Vector3> ProfileGrid::normal(std::size_t profile, std::size_t row) const {
  // Least squares of point = origin + a i + b j over a 5 x 5 pattern, six rows up and down because
  // rows lie closer than profiles; the normal is upright to a and b.
  const Vector3& origin = at(profile, row).point;
  double n = 0.0, i1 = 0.0, j1 = 0.0, ii = 0.0, ij = 0.0, jj = 0.0;
  Vector3 p = Vector3::Zero();
  Vector3 ip = Vector3::Zero();
  Vector3 jp = Vector3::Zero();
  for (int i = -2; i <= 2; ++i) {
    for (int j = -6; j <= 6; j += 3) {
      const Node* node = i == 0 && j == 0 ? &at(profile, row) : neighbour(profile, row, i, j);
      if (node == nullptr) continue;
      const Vector3 from_origin = node->point - origin;
      n += 1.0;
      i1 += i;
      j1 += j;
      ii += i * i;
      ij += i * j;
      jj += j * j;
      p += from_origin;
      ip += i * from_origin;
      jp += j * from_origin;
    }
  }
  if (n < 6.0) return {};
  const double c_ii = ii - i1 * i1 / n;
  const double c_ij = ij - i1 * j1 / n;
  const double c_jj = jj - j1 * j1 / n;
  const double spread = c_ii * c_jj - c_ij * c_ij;
  if (spread < 1.0) return {};
  // The common factor 1 / spread of a and b does not turn the normal.
  const Vector3 along_i = ip - i1 / n * p;
  const Vector3 along_j = jp - j1 / n * p;
  const Vector3 normal = (c_jj * along_i - c_ij * along_j).cross(c_ii * along_j - c_ij * along_i);
  const double length = normal.norm();
  if (!(length > 0.0) || !std::isfinite(length)) return {};
  return Vector3(normal / length);
}

}  // namespace tuina::scanner
