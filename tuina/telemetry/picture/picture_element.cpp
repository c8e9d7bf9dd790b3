// SPDX-License-Identifier: Apache-2.0
#include "tuina/telemetry/picture/picture_element.hpp"

#include <fmt/format.h>

#include "tuina/core/io/png.hpp"

namespace tuina::telemetry {
namespace {

std::string base64(const std::string& bytes) {
  constexpr const char* letters =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve(bytes.size() * 4 / 3 + 4);
  for (std::size_t k = 0; k < bytes.size(); k += 3) {
    unsigned int three = 0;
    for (std::size_t j = 0; j < 3; ++j)
      three = three << 8 | (k + j < bytes.size() ? static_cast<unsigned char>(bytes[k + j]) : 0U);
    for (std::size_t j = 0; j < 4; ++j)
      text += k + j <= bytes.size() ? letters[three >> (18 - 6 * j) & 63] : '=';
  }
  return text;
}

}  // namespace

std::string picture_element(const Image& image, double x, double width, double height) {
  return fmt::format(
      "<image x=\"{:.0f}\" width=\"{:.1f}\" height=\"{:.1f}\" href=\"data:image/png;base64,{}\"/>",
      x, width, height, base64(to_png(image)));
}

std::string picture_element(const ShadedPicture& picture, double x) {
  return picture_element(picture.image, x, picture.image.width / 2.0, picture.image.height / 2.0);
}

}  // namespace tuina::telemetry
