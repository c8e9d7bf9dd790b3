// SPDX-License-Identifier: Apache-2.0
#include "tuina/scanner/line/line_rows.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <limits>

#include "tuina/core/random.hpp"

using namespace tuina;
using namespace tuina::scanner;

namespace {

// Random light of which every tenth sample is clipped.
template <typename Pixel>
BasicImage<Pixel> random_picture(int channels, std::uint64_t seed) {
  constexpr double most = std::numeric_limits<Pixel>::max();
  Random random = make_random(seed, "rows");
  BasicImage<Pixel> picture(77, 3, channels);
  for (Pixel& value : picture.data)
    value = static_cast<Pixel>(std::min(uniform(random, 0.0, 1.1 * most), most));
  return picture;
}

// What a pixel tells of a line, as line_rows.hpp says it.
float told(float value, float off, float most) {
  return value >= most && off <= 0.75F * most ? most : value - off;
}

template <typename Pixel>
void check_rows() {
  constexpr auto most = static_cast<float>(std::numeric_limits<Pixel>::max());
  const auto picture = random_picture<Pixel>(1, 1);
  const auto dark = random_picture<Pixel>(1, 2);
  LineRows<Pixel> less_dark(picture, BasicImageView<Pixel>(dark), 0.0);
  for (int y = 0; y < picture.height; ++y) {
    const float* row = less_dark.row(y);
    for (int x = 0; x < picture.width; ++x)
      CHECK(row[x] == told(picture.row(y)[x], dark.row(y)[x], most));
  }
  for (const int channels : {3, 4}) {
    const auto colours = random_picture<Pixel>(channels, 3);
    LineRows<Pixel> less_scene(colours, 0.9F, 0.0);
    for (int y = 0; y < colours.height; ++y) {
      const float* row = less_scene.row(y);
      for (int x = 0; x < colours.width; ++x) {
        const auto* pixel = colours.row(y) + channels * x;
        const float scene = std::min(0.9F * static_cast<float>(pixel[1]), most);
        CHECK(row[x] == doctest::Approx(told(pixel[0], scene, most)).epsilon(1e-6));
      }
    }
  }
}

}  // namespace

TEST_CASE("rows with a dark frame or a scene taken off are those of each pixel, clipped or not") {
  check_rows<std::uint8_t>();
  check_rows<std::uint16_t>();
}
