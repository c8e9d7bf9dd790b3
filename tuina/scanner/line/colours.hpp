// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tuina/core/image.hpp"
#include "tuina/scanner/line/laser_line.hpp"

namespace tuina::scanner {

/// @{
/// The red of a picture with three or four channels, red first; a grey one as it is.
[[nodiscard]] Image red_of(const Image& colours);
[[nodiscard]] Image16 red_of(const Image16& colours);
/// @}

/// The green of a picture with three or four channels, which a red laser hardly lights.
[[nodiscard]] Image green_of(const Image& colours);

/// What red would be without a red laser: green, times the usual ratio of both in this picture,
/// which tells the lamp and the camera's white balance. Clipped and dark pixels have no part in the
/// ratio. `colours`: three or four channels, red first.
[[nodiscard]] Image red_without_laser(const Image& colours);

/// @{
/// `find_laser_line` in a picture with three or four channels, for a red laser: in what red has
/// beyond `red_without_laser`, which tells texture, lamps and white reflections for what they are;
/// in red alone where the room is dark, or the line so bright that all colours are clipped. A line
/// whose green rises as its red does is none.
[[nodiscard]] LaserLine find_red_line(const Image& colours, const LineOptions& options = {});
[[nodiscard]] LaserLine find_red_line(const Image16& colours, const LineOptions& options = {});
/// @}

}  // namespace tuina::scanner
