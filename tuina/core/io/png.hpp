// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "tuina/core/image.hpp"
#include "tuina/core/result.hpp"

namespace tuina {

/// Reads any PNG (8 or 16 bit, grey, colour, palette, interlaced) into 16-bit samples without
/// scaling: `bits` says whether 255 or 65535 is full scale. Alpha is dropped, a wrong checksum
/// refused.
struct PngFile {
  Image16 image;
  int bits = 8;
};

/// @{
/// A picture with its depth. Fails on what is no PNG of 8 or 16 bits, with its name.
[[nodiscard]] Result<PngFile> read_png(const std::filesystem::path& path);
[[nodiscard]] Result<PngFile> parse_png(std::string_view content, std::string_view name);
/// @}

/// Encodes 8-bit grey (one channel) or RGB (three channels).
[[nodiscard]] std::string to_png(const Image& image);

}  // namespace tuina
