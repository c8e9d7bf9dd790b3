// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "tuina/telemetry/picture/shaded_picture.hpp"

namespace tuina::telemetry {

/// The picture as an `<image>` element, two of its pixels to one unit of the drawing around it.
[[nodiscard]] std::string picture_element(const ShadedPicture& picture, double x = 0.0);

/// Any picture, with its place and size in the drawing around it.
[[nodiscard]] std::string picture_element(const Image& image, double x, double width,
                                          double height);

}  // namespace tuina::telemetry
