// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "tuina/body/outline.hpp"

namespace tuina::body {

/// Features of the silhouette, in the frame of the points.
struct SilhouetteFeatures {
  Sides neck;
  Sides shoulder;
  Vector2 lower_trunk;
  Sides trunk;
  double bottom = 0.0;  ///< height of the lower end of the midline
  double head = 0.0;    ///< height of the scan above the shoulders
  Arms arms = Arms::unknown;
};

/// Finds neck, shoulders, trunk and the ends of the midline in points in a frame like `back`.
/// `couch_up_in_back` and `couch_height_of_origin` place that frame on the couch. Fails with the
/// missing feature.
[[nodiscard]] Result<SilhouetteFeatures> find_features(const std::vector<Vector3>& in_back,
                                                       double spacing_m,
                                                       const Vector3& couch_up_in_back,
                                                       double couch_height_of_origin,
                                                       BodyPosture position);

}  // namespace tuina::body
