// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "tuina/body/outline.hpp"

namespace tuina::body {

/// What one look at the silhouette gives, in the coordinates of that look.
struct Look {
  Sides neck;
  Sides shoulder;
  Vector2 lower_trunk;
  Sides trunk;
  double bottom = 0.0;  ///< height of the lower end of the midline
  double head = 0.0;    ///< what lies above the shoulders
  Arms arms = Arms::unknown;
};

/// Looks once at a back whose points are given in a frame like `back`: neck, shoulders, trunk and
/// the ends of the midline. `couch_up_in_back` and `couch_height_of_origin` say how that frame
/// stands on the couch. Fails with what is missing.
[[nodiscard]] Result<Look> look(const std::vector<Vector3>& in_back, double spacing_m,
                                const Vector3& couch_up_in_back, double couch_height_of_origin,
                                Position position);

}  // namespace tuina::body
