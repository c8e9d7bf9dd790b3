// SPDX-License-Identifier: Apache-2.0
#include "tuina/scanner/profile_grid.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
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
  Matrix3 sums = Matrix3::Zero();
  Matrix3 moments = Matrix3::Zero();
  const Vector3& origin = at(profile, row).point;
  int used = 0;
  for (int i = -2; i <= 2; ++i) {
    for (int j = -6; j <= 6; j += 3) {
      const Node* node = i == 0 && j == 0 ? &at(profile, row) : neighbour(profile, row, i, j);
      if (node == nullptr) continue;
      const Vector3 place(1.0, i, j);
      sums += place * place.transpose();
      moments += place * (node->point - origin).transpose();
      ++used;
    }
  }
  if (used < 6) return {};
  const double spread = sums(1, 1) * sums(2, 2) - sums(1, 2) * sums(1, 2);
  if (spread < 1.0) return {};
  const Matrix3 plane = sums.inverse() * moments;
  const Vector3 normal = plane.row(1).cross(plane.row(2)).transpose();
  const double length = normal.norm();
  if (!(length > 0.0) || !std::isfinite(length)) return {};
  return Vector3(normal / length);
}

}  // namespace tuina::scanner
