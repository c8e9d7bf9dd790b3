// SPDX-License-Identifier: Apache-2.0
#include "tuina/scanner/picture.hpp"

#include <algorithm>
#include <vector>

#include "tuina/core/io/png.hpp"

namespace tuina::scanner {

namespace fs = std::filesystem;

namespace {

// How much of red a scene has for its green, by the lamp and the camera's white balance: the median
// over pixels that are neither dark nor clipped, of which a laser line lights few.
double red_to_green(const Image& image) {
  const auto channels = static_cast<std::size_t>(image.channels);
  std::vector<float> ratios;
  for (std::size_t i = 0; i + 1 < image.data.size(); i += channels) {
    const std::uint8_t red = image.data[i], green = image.data[i + 1];
    if (red > 30 && green > 30 && red < 250 && green < 250)
      ratios.push_back(static_cast<float>(red) / static_cast<float>(green));
  }
  if (ratios.empty()) return 1.0;
  const auto middle = ratios.begin() + static_cast<std::ptrdiff_t>(ratios.size() / 2);
  std::nth_element(ratios.begin(), middle, ratios.end());
  return *middle;
}

}  // namespace

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
  const double warmth = part == Part::laser ? red_to_green(*image) : 0.0;
  Image grey(image->width, image->height);
  for (std::size_t i = 0; i < grey.data.size(); ++i) {
    const std::uint8_t red = image->data[i * channels], green = image->data[i * channels + 1];
    const double beyond = red - warmth * green;
    grey.data[i] = part == Part::scene
                       ? green
                       : static_cast<std::uint8_t>(std::clamp(beyond + 0.5, 0.0, 255.0));
  }
  return grey;
}

}  // namespace tuina::scanner
