// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "tuina/core/geometry.hpp"

namespace tuina::scanner {

/// Points of a sweep in a grid of profiles and rows, so that neighbours need no search. One frame
/// for all points, resolution 0.1 um.
class ProfileGrid {
 public:
  /// One point of the grid, and how far its neighbours may be.
  struct Node {
    Vector3 point = Vector3::Zero();
    float amplitude_dn = 0.0F;
    float deviation_m = 0.0F;
    float reach_rows_m = 0.0F;      ///< maximum distance of the next row on one surface
    float reach_profiles_m = 0.0F;  ///< maximum distance of the next profile on one surface
    bool unsure = false;            ///< keep only if the surface continues on both sides
  };

  /// Unlit, of so many profiles with so many rows.
  ProfileGrid(std::size_t profiles, std::size_t rows);
  /// Puts a point into the grid; both indices count from 0.
  void light(std::size_t profile, std::size_t row, const Node& node);

  /// @{
  /// Size of the grid, whether a point is there, and what it is; unlit points have no value.
  [[nodiscard]] std::size_t profiles() const { return profiles_; }
  [[nodiscard]] std::size_t rows() const { return rows_; }
  [[nodiscard]] bool lit(std::size_t profile, std::size_t row) const {
    return plane_[x][place(profile, row)] != unlit_m;
  }
  [[nodiscard]] Vector3 point(std::size_t profile, std::size_t row) const {
    const std::size_t i = place(profile, row);
    return Eigen::Vector3f(plane_[x][i], plane_[y][i], plane_[z][i]).cast<double>();
  }
  [[nodiscard]] float amplitude_dn(std::size_t profile, std::size_t row) const {
    return plane_[amplitude][place(profile, row)];
  }
  [[nodiscard]] float deviation_m(std::size_t profile, std::size_t row) const {
    return plane_[deviation][place(profile, row)];
  }
  /// @}

 private:
  friend class NeighbourFilter;
  enum Plane : std::size_t {
    x,
    y,
    z,
    amplitude,
    deviation,
    reach_rows,
    reach_profiles,
    unsure,
    planes
  };
  // A margin of unlit nodes around the grid avoids border checks.
  static constexpr std::size_t margin_profiles = 2;
  static constexpr std::size_t margin_rows = 8;
  static constexpr float unlit_m = 1e6F;  // too far away to be a neighbour

  [[nodiscard]] std::size_t place(std::size_t profile, std::size_t row) const {
    return (profile + margin_profiles) * stride_ + margin_rows + row;
  }

  // True when this profile or one beside it has an unsure point.
  [[nodiscard]] bool unsure_near(std::size_t profile) const {
    return has_unsure_[profile] || has_unsure_[profile + 1] || has_unsure_[profile + 2];
  }

  std::size_t profiles_;
  std::size_t rows_;
  std::size_t stride_;
  std::vector<bool> has_unsure_;  ///< by profile, with one before the first
  std::array<std::vector<float>, planes> plane_;
};

/// Classifies points by their neighbours and estimates normals, profile by profile.
class NeighbourFilter {
 public:
  /// The grid must outlive it.
  explicit NeighbourFilter(const ProfileGrid& grid);

  /// What is thought of the rows of one profile.
  struct Verdict {
    /// Zero for mixed points and for points with too few neighbours for a normal. A mixed point
    /// arises where the line covers two surfaces or an edge: it floats between them, dimmer than
    /// its neighbours or without any.
    std::vector<float> trusted;
    std::array<std::vector<float>, 3> normal;  ///< unit, of either sign
    /// How many of the nearest points, up to three rows up and down and one in the profiles on both
    /// sides, lie on the point's surface, and how far along the normal these lie in the mean.
    std::vector<float> neighbours, offset_m;
  };
  /// Verdict on the rows of the next profile, beginning with the first.
  const Verdict& next();

 private:
  // Per row: number of points of one profile near it, and sums over their row offsets j and
  // positions p relative to that row's point.
  enum Sum : std::size_t { n, j1, jj, px, py, pz, jx, jy, jz, sums };
  using Sums = std::array<std::vector<float>, sums>;
  static constexpr std::ptrdiff_t profiles_near = 2;  // profiles to either side
  static constexpr std::size_t window = 2 * profiles_near + 1;

  void add_up_rows(std::ptrdiff_t profile);
  void fit_planes();
  void compare_amplitudes();

  const ProfileGrid& grid_;
  std::ptrdiff_t profile_ = -1;
  std::array<Sums, window> near_;  // profile p is at p modulo the window
  Verdict verdict_;
};

}  // namespace tuina::scanner
