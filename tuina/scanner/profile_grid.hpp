// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "tuina/core/geometry.hpp"

namespace tuina::scanner {

/// Points of a sweep kept where they were seen, profile by profile and row by row, so that the
/// neighbours of a point are known without a search. All points are in one frame, to a tenth of a
/// micrometre.
class ProfileGrid {
 public:
  struct Node {
    Vector3 point = Vector3::Zero();
    float amplitude_dn = 0.0F;
    float deviation_m = 0.0F;
    float reach_rows_m = 0.0F;      ///< how far the next row may lie on one surface
    float reach_profiles_m = 0.0F;  ///< the same for the next profile
    bool unsure = false;            ///< to be kept only where its surface goes on on both sides
  };

  ProfileGrid(std::size_t profiles, std::size_t rows);
  void light(std::size_t profile, std::size_t row, const Node& node);

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

 private:
  friend class NeighbourJudge;
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
  // Around the grid there is a margin of unlit places, so that nobody asks where it ends.
  static constexpr std::size_t margin_profiles = 2;
  static constexpr std::size_t margin_rows = 8;
  static constexpr float unlit_m = 1e6F;  // so far off that it is nobody's neighbour

  [[nodiscard]] std::size_t place(std::size_t profile, std::size_t row) const {
    return (profile + margin_profiles) * stride_ + margin_rows + row;
  }

  // Whether this profile or one beside it has an unsure point.
  [[nodiscard]] bool unsure_near(std::size_t profile) const {
    return has_unsure_[profile] || has_unsure_[profile + 1] || has_unsure_[profile + 2];
  }

  std::size_t profiles_;
  std::size_t rows_;
  std::size_t stride_;
  std::vector<bool> has_unsure_;  ///< by profile, after one that stands before the first
  std::array<std::vector<float>, planes> plane_;
};

/// What the neighbours of each point say of it, one profile after the other.
class NeighbourJudge {
 public:
  explicit NeighbourJudge(const ProfileGrid& grid);

  struct Verdict {
    /// Not zero where the point is to be trusted. It is not where the line fell on two surfaces at
    /// once, or past an edge: such a point lies between them, dimmer than its neighbours, or has
    /// none. Nor is it where too few neighbours give a normal.
    std::vector<float> trusted;
    std::array<std::vector<float>, 3> normal;  ///< unit, of either sign
  };
  /// The verdict on the rows of the next profile, the first one first.
  const Verdict& next();

 private:
  // Of the points of one profile near each of its rows: how many, and sums over their row numbers j
  // and places p, both seen from that row's own point.
  enum Sum : std::size_t { n, j1, jj, px, py, pz, jx, jy, jz, sums };
  using Sums = std::array<std::vector<float>, sums>;
  static constexpr std::ptrdiff_t profiles_near = 2;  // to either side
  static constexpr std::size_t window = 2 * profiles_near + 1;

  void add_up_rows(std::ptrdiff_t profile);
  void fit_planes();
  void compare_amplitudes();

  const ProfileGrid& grid_;
  std::ptrdiff_t profile_ = -1;
  std::array<Sums, window> near_;  // of the profile p in place p modulo the window
  Verdict verdict_;
};

}  // namespace tuina::scanner
