// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>

#include "tuina/core/image.hpp"
#include "tuina/core/result.hpp"

namespace tuina::scanner {

/// Reads a picture with all its channels, 16 bits rounded to 8. Fails, with the file, for what is
/// no PNG; so do the others.
[[nodiscard]] Result<Image> read_colours(const std::filesystem::path& path);

/// Reads a picture as 8-bit grey: red of colour pictures, 16 bits rounded to 8.
[[nodiscard]] Result<Image> read_picture(const std::filesystem::path& path);

/// What a colour picture shows of a scene that a red laser shines on: the scene without it, by
/// green, or the laser, by the red that the scene's green does not explain.
enum class Part : std::uint8_t { scene, laser };
/// Reads a part of a colour picture as 8-bit grey. Fails besides (Fault::bad_input) for a grey one.
[[nodiscard]] Result<Image> read_part(const std::filesystem::path& path, Part part);

}  // namespace tuina::scanner
