// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace tuina {

/// A colour as screens and paper show it (sRGB).
struct Colour {
  std::uint8_t red = 0;
  std::uint8_t green = 0;
  std::uint8_t blue = 0;
};

}  // namespace tuina
