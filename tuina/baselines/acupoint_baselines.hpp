// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tuina/body/acupoints.hpp"

namespace tuina::baselines {

/// What simpler ways give, to judge the methods by. They give the labels of the atlas on this
/// person.

/// The atlas' mean back laid onto the scan as a rigid body (iterated closest points), from the pose
/// that `surface` found.
[[nodiscard]] Result<body::Mapping> rigid_icp(const body::BackSurface& back,
                                              const body::Atlas& atlas);

/// The standard's marks scaled by the width of the shoulders and the length of the midline.
[[nodiscard]] Result<body::Mapping> scale_axes(const body::BackSurface& back,
                                               const body::Atlas& atlas);

/// The rules of the textbook on landmarks that `surface` found: shares of the spine, and 3 cun from
/// the midline to the border of the scapula. Only the seven points.
[[nodiscard]] Result<body::Mapping> cun_rule(const body::BackSurface& back,
                                             const body::Atlas& atlas);

}  // namespace tuina::baselines
