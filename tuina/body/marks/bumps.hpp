// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "tuina/body/back_surface.hpp"

namespace tuina::body {

/// A small marker on the skin that can be seen by its shape: a ball, half a ball, a button.
struct Bump {
  Vector3 at_in_couch = Vector3::Zero();  ///< on the skin below its middle
  double height_m = 0.0;                  ///< mean over its inner 8 mm
  double width_m = 0.0;                   ///< at half its height, of a round one of the same area
};

/// Round bumps that stand out of the skin by 1.2 mm or more and are 4 to 16 mm wide, in no order:
/// balls and half balls of 8 to 14 mm. Flat, smaller and larger ones may be missed.
/// The skin around each is taken for a quadric over 26 mm, seen along the mean normal of `back`;
/// the clouds of six real people with balls of 10 mm show them 2 to 4 mm high and 6 mm wide.
/// `scan_in_couch`: the cloud that `back` was fitted to. Fails (Fault::bad_input) when its points
/// lie too far apart to show one.
[[nodiscard]] Result<std::vector<Bump>> find_bumps(const PointCloud& scan_in_couch,
                                                   const BackSurface& back);

/// The cloud without what lies on bumps that were found in it.
[[nodiscard]] PointCloud without_bumps(const PointCloud& scan_in_couch,
                                       const std::vector<Bump>& bumps, const BackSurface& back);

}  // namespace tuina::body
