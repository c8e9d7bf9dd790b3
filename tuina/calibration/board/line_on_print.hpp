// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "tuina/core/geometry.hpp"
#include "tuina/core/image.hpp"
#include "tuina/scanner/line/laser_line.hpp"

namespace tuina::calibration {

/// The laser line on a printed board, where black squares send back little of its light and pull
/// its centroid to the white side by up to its width. The picture of the same board without laser
/// tells how bright each place is, so the line is fitted as what it would be on white paper.
/// `outline` has the corners of the paper; `found` is where `find_laser_line` saw it; rows that
/// fall on the board are fitted anew, others are left out.
[[nodiscard]] std::vector<scanner::LinePoint> line_on_print(ImageView laser, ImageView board,
                                                            const std::array<Vector2, 4>& outline,
                                                            const scanner::LaserLine& found);

}  // namespace tuina::calibration
