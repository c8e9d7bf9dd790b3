// SPDX-License-Identifier: Apache-2.0
#include "tuina/core/io/png.hpp"

#include <doctest/doctest.h>
#include <png.h>
#include <zlib.h>

#include "tests/core/mutation.hpp"

using namespace tuina;

namespace {

/// What the reference encoder makes of rows that are packed already as PNG packs them.
std::string encoded(int width, int height, int bits, int colour, bool interlaced,
                    std::vector<std::uint8_t> packed) {
  std::string content;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_set_write_fn(
      png, &content,
      [](png_structp to, png_bytep bytes, std::size_t n) {
        static_cast<std::string*>(png_get_io_ptr(to))
            ->append(reinterpret_cast<const char*>(bytes), n);
      },
      nullptr);
  png_set_IHDR(png, info, static_cast<png_uint_32>(width), static_cast<png_uint_32>(height), bits,
               colour, interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  const png_color palette[2] = {{10, 20, 30}, {200, 100, 50}};
  if (colour == PNG_COLOR_TYPE_PALETTE) png_set_PLTE(png, info, palette, 2);
  png_write_info(png, info);
  std::vector<png_bytep> rows;
  for (int y = 0; y < height; ++y) {
    rows.push_back(packed.data() + static_cast<std::size_t>(y) *
                                       (packed.size() / static_cast<std::size_t>(height)));
  }
  png_write_image(png, rows.data());
  png_write_end(png, nullptr);
  png_destroy_write_struct(&png, &info);
  return content;
}

std::string be32(std::uint32_t value) {
  return {static_cast<char>(value >> 24), static_cast<char>(value >> 16),
          static_cast<char>(value >> 8), static_cast<char>(value)};
}

std::string chunk(const std::string& type, const std::string& data) {
  const std::string covered = type + data;
  const auto sum =
      ::crc32(0, reinterpret_cast<const Bytef*>(covered.data()), static_cast<uInt>(covered.size()));
  return be32(static_cast<std::uint32_t>(data.size())) + covered +
         be32(static_cast<std::uint32_t>(sum));
}

Image striped(int width, int height, int channels) {
  Image image(width, height, channels);
  for (std::size_t k = 0; k < image.data.size(); ++k)
    image.data[k] = static_cast<std::uint8_t>(k * 7);
  return image;
}

std::string refusal(std::string_view content) {
  const auto file = parse_png(content, "f.png");
  REQUIRE_FALSE(file.has_value());
  CHECK(file.error().fault == Fault::bad_input);
  return file.error().message;
}

bool says(const std::string& message, std::string_view words) {
  INFO(message);
  return message.find(words) != std::string::npos;
}

}  // namespace

TEST_CASE("a picture written as PNG comes back sample by sample, grey and colour") {
  for (const int channels : {1, 3}) {
    const Image image = striped(13, 9, channels);
    const auto file = parse_png(to_png(image), "f.png");
    REQUIRE(file.has_value());
    CHECK(file->bits == 8);
    CHECK(file->image.width == 13);
    CHECK(file->image.height == 9);
    CHECK(file->image.channels == channels);
    CHECK(std::equal(image.data.begin(), image.data.end(), file->image.data.begin()));
  }
}

TEST_CASE("16 bits, palette, one bit, interlaced and alpha are all read") {
  const auto deep =
      parse_png(encoded(2, 1, 16, PNG_COLOR_TYPE_GRAY, false, {0x12, 0x34, 0xff, 0xff}), "f.png");
  REQUIRE(deep.has_value());
  CHECK(deep->bits == 16);
  CHECK(deep->image.data == std::vector<std::uint16_t>{0x1234, 0xffff});

  const auto palette = parse_png(encoded(2, 1, 8, PNG_COLOR_TYPE_PALETTE, false, {1, 0}), "f.png");
  REQUIRE(palette.has_value());
  CHECK(palette->image.data == std::vector<std::uint16_t>{200, 100, 50, 10, 20, 30});

  const auto bits = parse_png(encoded(8, 1, 1, PNG_COLOR_TYPE_GRAY, false, {0b10000001}), "f.png");
  REQUIRE(bits.has_value());
  CHECK(bits->image.data == std::vector<std::uint16_t>{255, 0, 0, 0, 0, 0, 0, 255});

  std::vector<std::uint8_t> ramp(17 * 11);
  for (std::size_t k = 0; k < ramp.size(); ++k) ramp[k] = static_cast<std::uint8_t>(k);
  const auto woven = parse_png(encoded(17, 11, 8, PNG_COLOR_TYPE_GRAY, true, ramp), "f.png");
  REQUIRE(woven.has_value());
  CHECK(std::equal(ramp.begin(), ramp.end(), woven->image.data.begin(), woven->image.data.end()));

  const auto clear =
      parse_png(encoded(1, 1, 8, PNG_COLOR_TYPE_RGB_ALPHA, false, {1, 2, 3, 4}), "f.png");
  REQUIRE(clear.has_value());
  CHECK(clear->image.data == std::vector<std::uint16_t>{1, 2, 3});
}

TEST_CASE("a PNG with a wrong checksum, cut short or with bytes after its end is refused") {
  const std::string good = to_png(striped(20, 20, 1));
  std::string bad = good;
  bad[bad.size() - 20] = static_cast<char>(bad[bad.size() - 20] ^ 1);
  CHECK(says(refusal(bad), "checksum of chunk `IDAT`"));
  CHECK(says(refusal(good.substr(0, good.size() - 12)), "ends before IEND"));
  CHECK(says(refusal(good + "xyz"), "3 bytes follow the end"));
  CHECK(parse_png(good + "\n", "f.png").has_value());
  CHECK(says(refusal("P5 1 1 255 x"), "is not a PNG"));
  CHECK(says(refusal(""), "is not a PNG"));
}

TEST_CASE(
    "a PNG that claims more pixels than its data can hold is refused before memory is taken") {
  const std::string shape = std::string("\x08\x00\x00\x00\x00", 5);
  const std::string start = "\x89PNG\r\n\x1a\n";
  const auto claim = [&](std::uint32_t width, std::uint32_t height) {
    return start + chunk("IHDR", be32(width) + be32(height) + shape) + chunk("IDAT", "abc") +
           chunk("IEND", "");
  };
  CHECK(says(refusal(claim(2'000'000'000, 2'000'000'000)), "from 1 to"));
  CHECK(says(refusal(claim(5000, 5000)), "cannot be in 3 bytes"));
  CHECK(says(refusal(claim(0, 5)), "from 1 to"));
  CHECK(says(refusal(claim(5, 5)), "f.png: `"));
}

TEST_CASE("a PNG with random faults is read or refused, also when its checksums were mended") {
  const std::string good =
      encoded(17, 11, 8, PNG_COLOR_TYPE_PALETTE, true, std::vector<std::uint8_t>(17 * 11, 1));
  Random random = make_random(1, "png faults");
  const std::size_t data_at = good.find("IDAT") + 4;
  const std::size_t data_end = good.find("IEND") - 8;
  int refused = 0;
  for (int k = 0; k < 3000; ++k) {
    std::string bad;
    if (k % 2 == 0) {
      bad = tests::mutated(good, random);
    } else {
      bad = good.substr(0, data_at - 8) +
            chunk("IDAT", tests::mutated(good.substr(data_at, data_end - data_at), random)) +
            chunk("IEND", "");
    }
    const auto file = parse_png(bad, "f.png");
    if (!file) ++refused;
    if (file)
      REQUIRE(file->image.data.size() ==
              static_cast<std::size_t>(file->image.width * file->image.height * 3));
  }
  CHECK(refused > 1500);
}
