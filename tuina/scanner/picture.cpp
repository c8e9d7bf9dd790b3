// SPDX-License-Identifier: Apache-2.0
#include "tuina/scanner/picture.hpp"

#include <algorithm>

#include "tuina/core/io/png.hpp"
#include "tuina/scanner/line/colours.hpp"

namespace tuina::scanner {

namespace fs = std::filesystem;

Result<Image> read_colours(const fs::path& path) {
  const auto png = read_png(path);
  if (!png) return tl::unexpected(png.error());
  const int shift = png->bits > 8 ? 257 : 1;
  Image image(png->image.width, png->image.height, png->image.channels);
  for (std::size_t i = 0; i < image.data.size(); ++i) {
    image.data[i] = static_cast<std::uint8_t>((png->image.data[i] + shift / 2) / shift);
  }
  return image;
}

Result<Image> read_picture(const fs::path& path) {
  const auto image = read_colours(path);
  if (!image) return image;
  return red_of(*image);
}

Result<Image> read_part(const fs::path& path, Part part) {
  const auto image = read_colours(path);
  if (!image) return image;
  if (image->channels < 3)
    return fail(Fault::bad_input,
                "{}: is grey; board and laser are told apart in a colour picture only",
                path.string());
  if (part == Part::scene) return green_of(*image);
  Image beyond = red_of(*image);
  const Image scene = red_without_laser(*image);
  for (std::size_t i = 0; i < beyond.data.size(); ++i)
    beyond.data[i] = static_cast<std::uint8_t>(std::max(0, beyond.data[i] - scene.data[i]));
  return beyond;
}

}  // namespace tuina::scanner
