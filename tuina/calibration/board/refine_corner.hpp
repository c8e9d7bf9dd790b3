// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>

#include "tuina/core/geometry.hpp"
#include "tuina/core/image.hpp"

namespace tuina::calibration {

/// Refines a corner where two black squares meet to a few hundredths of a pixel, from the gradients
/// within `window` pixels that `counts` accepts (empty: all). Nothing at the image border or on
/// divergence.
[[nodiscard]] std::optional<Vector2> refine_corner(
    ImageView image, Vector2 corner, int window,
    const std::function<bool(int x, int y)>& counts = {});

}  // namespace tuina::calibration
