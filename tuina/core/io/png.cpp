// SPDX-License-Identifier: Apache-2.0
#include "tuina/core/io/png.hpp"

#include <png.h>
#include <zlib.h>

#include <cassert>
#include <csetjmp>
#include <cstring>

#include "tuina/core/io/file.hpp"
#include "tuina/core/io/text_lines.hpp"

namespace tuina {
namespace {

constexpr std::string_view signature = "\x89PNG\r\n\x1a\n";
constexpr std::size_t max_png_bytes = std::size_t{128} << 20;
constexpr std::uint64_t max_pixels = 32'000'000;
constexpr std::uint64_t best_deflate_ratio = 1032;  // RFC 1951: 258 bytes from two bits

std::uint32_t big_endian(std::string_view bytes) {
  std::uint32_t value = 0;
  for (int k = 0; k < 4; ++k)
    value = value << 8 | static_cast<unsigned char>(bytes[static_cast<std::size_t>(k)]);
  return value;
}

/// Checks the chunks before decoding: lengths, checksums, order, end, and whether the compressed
/// data can hold the picture that the header claims. libpng alone skips some of these with a
/// warning.
Result<void> check_chunks(std::string_view content, std::string_view name) {
  if (!content.starts_with(signature))
    return fail(Fault::bad_input, "{}: is not a PNG picture", name);
  std::size_t at = signature.size();
  std::uint64_t pixels = 0;
  std::uint64_t compressed = 0;
  while (true) {
    const std::string_view rest = content.substr(at);
    if (rest.size() < 12)
      return fail(Fault::bad_input, "{}: byte {}: the file ends before IEND", name, at);
    const std::uint32_t length = big_endian(rest);
    const std::string_view type = rest.substr(4, 4);
    if (length > rest.size() - 12) {
      return fail(Fault::bad_input, "{}: byte {}: chunk {} claims {} bytes, {} are left", name, at,
                  in_quotes(type), length, rest.size() - 12);
    }
    const std::string_view covered = rest.substr(4, std::size_t{4} + length);
    const auto sum = ::crc32(0, reinterpret_cast<const Bytef*>(covered.data()),
                             static_cast<uInt>(covered.size()));
    if (sum != big_endian(rest.substr(8 + length))) {
      return fail(Fault::bad_input, "{}: byte {}: the checksum of chunk {} is wrong", name, at,
                  in_quotes(type));
    }
    if ((at == signature.size()) != (type == "IHDR")) {
      return fail(Fault::bad_input, "{}: byte {}: IHDR must be the first chunk and the only one",
                  name, at);
    }
    if (type == "IHDR") {
      if (length != 13)
        return fail(Fault::bad_input, "{}: byte {}: IHDR has {} bytes, not 13", name, at, length);
      const std::uint64_t width = big_endian(rest.substr(8));
      const std::uint64_t height = big_endian(rest.substr(12));
      pixels = width * height;
      if (pixels == 0 || width > max_pixels || height > max_pixels || pixels > max_pixels) {
        return fail(Fault::bad_input, "{}: {} x {} pixels; from 1 to {} are read", name, width,
                    height, max_pixels);
      }
    }
    if (type == "IDAT") compressed += length;
    at += std::size_t{12} + length;
    if (type == "IEND") break;
  }
  if (!only_white_space(content.substr(at))) {
    return fail(Fault::bad_input, "{}: byte {}: {} bytes follow the end of the picture", name, at,
                content.size() - at);
  }
  // A pixel takes at least one bit before compression.
  if (pixels / 8 > compressed * best_deflate_ratio) {
    return fail(Fault::bad_input, "{}: {} pixels cannot be in {} bytes of data", name, pixels,
                compressed);
  }
  return {};
}

struct Decoder {
  png_structp png = nullptr;
  png_infop info = nullptr;
  std::string_view content;
  std::size_t at = 0;
  char message[120] = {};

  Decoder() = default;
  Decoder(const Decoder&) = delete;
  Decoder& operator=(const Decoder&) = delete;
  ~Decoder() { png_destroy_read_struct(&png, &info, nullptr); }
};

[[noreturn]] void on_fault(png_structp png, png_const_charp text) {
  auto* decoder = static_cast<Decoder*>(png_get_error_ptr(png));
  std::strncpy(decoder->message, text, sizeof decoder->message - 1);
  png_longjmp(png, 1);
}

void feed(png_structp png, png_bytep to, std::size_t count) {
  auto* decoder = static_cast<Decoder*>(png_get_io_ptr(png));
  if (count > decoder->content.size() - decoder->at) png_error(png, "the data end early");
  std::memcpy(to, decoder->content.data() + decoder->at, count);
  decoder->at += count;
}

// libpng reports faults by longjmp, which must not skip destructors. The two functions it may leave
// hold plain values only; objects with destructors live in their caller.
bool read_header(Decoder& decoder) {
  if (setjmp(png_jmpbuf(decoder.png)) != 0) return false;
  png_set_read_fn(decoder.png, &decoder, feed);
  // Ancillary chunks (colour profiles, comments) do not affect the samples, so malformed ones are
  // ignored.
  png_set_keep_unknown_chunks(decoder.png, PNG_HANDLE_CHUNK_NEVER, nullptr, -1);
  png_read_info(decoder.png, decoder.info);
  if (png_get_bit_depth(decoder.png, decoder.info) < 8) png_set_expand_gray_1_2_4_to_8(decoder.png);
  png_set_palette_to_rgb(decoder.png);
  png_set_strip_alpha(decoder.png);
  png_set_swap(decoder.png);
  png_set_interlace_handling(decoder.png);
  png_read_update_info(decoder.png, decoder.info);
  return true;
}

bool read_rows(Decoder& decoder, png_bytepp rows) {
  if (setjmp(png_jmpbuf(decoder.png)) != 0) return false;
  png_read_image(decoder.png, rows);
  png_read_end(decoder.png, nullptr);
  return true;
}

}  // namespace

Result<PngFile> parse_png(std::string_view content, std::string_view name) {
  if (const auto sound = check_chunks(content, name); !sound) return tl::unexpected(sound.error());
  Decoder decoder;
  decoder.content = content;
  // libpng's warnings (excess data, a colour outside the palette) count as faults.
  decoder.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &decoder, on_fault, on_fault);
  decoder.info = decoder.png == nullptr ? nullptr : png_create_info_struct(decoder.png);
  if (decoder.info == nullptr) return fail(Fault::bad_input, "{}: libpng does not start", name);
  if (!read_header(decoder))
    return fail(Fault::bad_input, "{}: {}", name, in_quotes(decoder.message));

  PngFile file;
  const auto width = png_get_image_width(decoder.png, decoder.info);
  const auto height = png_get_image_height(decoder.png, decoder.info);
  const int channels = png_get_channels(decoder.png, decoder.info);
  const std::size_t row_bytes = png_get_rowbytes(decoder.png, decoder.info);
  file.bits = png_get_bit_depth(decoder.png, decoder.info);
  std::vector<png_byte> bytes(row_bytes * height);
  std::vector<png_bytep> rows(height);
  for (std::size_t y = 0; y < height; ++y) rows[y] = bytes.data() + y * row_bytes;
  if (!read_rows(decoder, rows.data()))
    return fail(Fault::bad_input, "{}: {}", name, in_quotes(decoder.message));

  file.image = Image16(static_cast<int>(width), static_cast<int>(height), channels);
  if (file.bits == 16) {
    std::memcpy(file.image.data.data(), bytes.data(), bytes.size());
  } else {
    std::copy(bytes.begin(), bytes.end(), file.image.data.begin());
  }
  return file;
}

Result<PngFile> read_png(const std::filesystem::path& path) {
  const auto content = read_file(path, max_png_bytes);
  if (!content) return tl::unexpected(content.error());
  return parse_png(*content, path.string());
}

std::string to_png(const Image& image) {
  assert(image.channels == 1 || image.channels == 3);
  png_image header = {};
  header.version = PNG_IMAGE_VERSION;
  header.width = static_cast<png_uint_32>(image.width);
  header.height = static_cast<png_uint_32>(image.height);
  header.format = image.channels == 1 ? PNG_FORMAT_GRAY : PNG_FORMAT_RGB;
  std::string content(PNG_IMAGE_PNG_SIZE_MAX(header), '\0');
  png_alloc_size_t size = content.size();
  png_image_write_to_memory(&header, content.data(), &size, 0, image.data.data(), 0, nullptr);
  content.resize(size);
  return content;
}

}  // namespace tuina
