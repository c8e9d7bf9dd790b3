// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tuina/body/acupoints.hpp"

namespace tuina::body {

/// What simpler ways give, to judge the methods by. They give the labels of the atlas on this
/// person.

/// The atlas' mean back laid onto the scan as a rigid body (iterated closest points), from the pose
/// that `surface` found.
[[nodiscard]] Result<Mapping> rigid_icp(const BackSurface& back, const Atlas& atlas);

/// The standard's marks scaled by the width of the shoulders and the length of the midline.
[[nodiscard]] Result<Mapping> scale_axes(const BackSurface& back, const Atlas& atlas);

/// The rules of the textbook on landmarks that `surface` found: shares of the spine, and 3 cun from
/// the midline to the border of the scapula. Only the seven points.
[[nodiscard]] Result<Mapping> cun_rule(const BackSurface& back, const Atlas& atlas);

}  // namespace tuina::body
