// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "tuina/core/image.hpp"
#include "tuina/core/result.hpp"

namespace tuina {

/// Any PNG (8 or 16 bit, grey, colour, palette, interlaced) as 16-bit samples scaled by nothing:
/// `bits` says whether the values end at 255 or 65535. Alpha is dropped. A wrong checksum is
/// refused.
struct PngFile {
  Image16 image;
  int bits = 8;
};

[[nodiscard]] Result<PngFile> read_png(const std::filesystem::path& path);
[[nodiscard]] Result<PngFile> parse_png(std::string_view content, std::string_view name);

/// 8-bit grey (one channel) or RGB (three channels).
[[nodiscard]] std::string to_png(const Image& image);

}  // namespace tuina
