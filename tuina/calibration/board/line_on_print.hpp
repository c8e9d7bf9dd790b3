// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "tuina/core/geometry.hpp"
#include "tuina/core/image.hpp"
#include "tuina/scanner/line/laser_line.hpp"

namespace tuina::calibration {

/// Refits the laser line on a printed board. Black squares reflect little of its light and pull the
/// centroid to the white side by up to the line's width, so the picture without laser is used as
/// reflectance map. `outline`: corners of the paper; `found`: result of `find_laser_line`; rows off
/// the board are dropped.
[[nodiscard]] std::vector<scanner::LinePoint> line_on_print(ImageView laser, ImageView board,
                                                            const std::array<Vector2, 4>& outline,
                                                            const scanner::LaserLine& found);

}  // namespace tuina::calibration
