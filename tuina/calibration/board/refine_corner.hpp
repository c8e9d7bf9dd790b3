// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>

#include "tuina/core/geometry.hpp"
#include "tuina/core/image.hpp"

namespace tuina::calibration {

/// A corner where two black squares meet, to a few hundredths of a pixel, from the gradients within
/// `window` pixels of it for which `counts` says so, all when it is empty. Nothing when it is at
/// the border of the image or runs away, being none.
[[nodiscard]] std::optional<Vector2> refine_corner(
    ImageView image, Vector2 corner, int window,
    const std::function<bool(int x, int y)>& counts = {});

}  // namespace tuina::calibration
