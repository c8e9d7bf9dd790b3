// SPDX-License-Identifier: Apache-2.0
#include "tuina/scanner/picture.hpp"

#include <algorithm>

#include "tuina/core/io/png.hpp"

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
  auto image = read_colours(path);
  if (!image || image->channels == 1) return image;
  const auto channels = static_cast<std::size_t>(image->channels);
  Image red(image->width, image->height);
  for (std::size_t i = 0; i < red.data.size(); ++i) red.data[i] = image->data[i * channels];
  return red;
}

Result<Image> read_part(const fs::path& path, Part part) {
  const auto image = read_colours(path);
  if (!image) return image;
  if (image->channels < 3)
    return fail(Fault::bad_input,
                "{}: is grey; board and laser are told apart in a colour picture only",
                path.string());
  const auto channels = static_cast<std::size_t>(image->channels);
  Image grey(image->width, image->height);
  for (std::size_t i = 0; i < grey.data.size(); ++i) {
    const std::uint8_t red = image->data[i * channels], green = image->data[i * channels + 1];
    const int beyond = red - green;
    grey.data[i] = part == Part::scene ? green : static_cast<std::uint8_t>(std::max(0, beyond));
  }
  return grey;
}

}  // namespace tuina::scanner
