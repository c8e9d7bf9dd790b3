// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "tuina/body/shape_model.hpp"

namespace tuina::body {

/// The deepest place of the hollow of the loins, on the skin over the spine.
struct LumbarHollow {
  Vector3 at_in_couch = Vector3::Zero();
  double depth_m = 0.0;  ///< under the straight line from the upper back to sacrum or buttocks
};

/// Finds it in the skin along the midline, a column for each place from neck to sacrum. `axes`: x
/// to the left, y out of the back, z towards the head. Nothing where the loins are flat or out of
/// view.
[[nodiscard]] std::optional<LumbarHollow> find_lumbar_hollow(const BackSurface& back,
                                                             const Places& midline_in_couch,
                                                             const Matrix3& axes_in_couch);

}  // namespace tuina::body
