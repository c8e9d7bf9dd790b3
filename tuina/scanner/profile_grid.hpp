// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "tuina/core/geometry.hpp"

namespace tuina::scanner {

/// Points of a sweep kept where they were seen, profile by profile and row by row, so that the
/// neighbours of a point are known without a search. All points are in one frame.
class ProfileGrid {
 public:
  struct Node {
    Vector3 point = Vector3::Zero();
    float amplitude_dn = 0.0F;
    float deviation_m = 0.0F;
    float reach_rows_m = 0.0F;      ///< how far the next row may lie on one surface
    float reach_profiles_m = 0.0F;  ///< the same for the next profile
    bool lit = false;
  };

  ProfileGrid(std::size_t profiles, std::size_t rows)
      : profiles_(profiles), rows_(rows), nodes_(profiles * rows) {}

  [[nodiscard]] Node& at(std::size_t profile, std::size_t row) {
    return nodes_[profile * rows_ + row];
  }
  [[nodiscard]] const Node& at(std::size_t profile, std::size_t row) const {
    return nodes_[profile * rows_ + row];
  }
  [[nodiscard]] std::size_t profiles() const { return profiles_; }
  [[nodiscard]] std::size_t rows() const { return rows_; }

  /// False where the line fell on two surfaces at once, or past an edge: such a point lies between
  /// them, dimmer than its neighbours, or has none.
  [[nodiscard]] bool trustworthy(std::size_t profile, std::size_t row) const;

  /// The normal (unit, of either sign) of the plane through the neighbours; nothing when there are
  /// too few.
  [[nodiscard]] std::optional<Vector3> normal(std::size_t profile, std::size_t row) const;

 private:
  [[nodiscard]] const Node* neighbour(std::size_t profile, std::size_t row, int profiles_on,
                                      int rows_on) const;

  std::size_t profiles_;
  std::size_t rows_;
  std::vector<Node> nodes_;
};

}  // namespace tuina::scanner
