// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "tuina/core/image.hpp"
#include "tuina/core/result.hpp"
#include "tuina/hardware/device_file.hpp"

namespace tuina::hardware {

/// One frame of a camera as an 8-bit grey picture of its brightness, `width` x `height` pixels. The
/// colour of YUYV and JPEG has half of the columns only, so the laser line is looked for in the
/// brightness. Fault::bad_input when the bytes are too few, too many or no such picture.
[[nodiscard]] Result<Image> grey_picture(PixelFormat format, std::span<const std::uint8_t> bytes,
                                         int width, int height);

/// The picture turned to the right by 0, 90, 180 or 270 degrees.
[[nodiscard]] Image turned(Image picture, int degrees);

}  // namespace tuina::hardware
