// SPDX-License-Identifier: Apache-2.0
#include "tuina/hardware/camera_pixels.hpp"

#include <csetjmp>
#include <cstdio>
// It needs FILE and size_t from before it.
#include <jpeglib.h>
// It needs what is in there.
#include <jerror.h>

#include <algorithm>
#include <array>

namespace tuina::hardware {
namespace {

struct JpegFailure {
  jpeg_error_mgr manager = {};
  std::jmp_buf back = {};
  std::array<char, JMSG_LENGTH_MAX> message = {};
};

// Ends what libjpeg does at a fault, or at a warning: a picture that is made up in part is none.
void leave(j_common_ptr common) {
  auto* failure = reinterpret_cast<JpegFailure*>(common->err);
  common->err->format_message(common, failure->message.data());
  std::longjmp(failure->back, 1);  // NOLINT(cert-err52-cpp): libjpeg's own way
}
// Some bytes too many before a restart marker are borne, from which a picture begins anew: the
// Logitech C270 sends some in each picture. Elsewhere they are what a damaged picture leaves over.
void leave_at_warning(j_common_ptr common, int level) {
  const jpeg_error_mgr& error = *common->err;
  constexpr int max_bytes = 8, first_restart = 0xD0, last_restart = 0xD7;
  const bool padded = error.msg_code == JWRN_EXTRANEOUS_DATA && error.msg_parm.i[0] <= max_bytes &&
                      error.msg_parm.i[1] >= first_restart && error.msg_parm.i[1] <= last_restart;
  if (level < 0 && !padded) leave(common);
}

// Nothing here has a destructor that a long jump would pass by.
bool decode(std::span<const std::uint8_t> bytes, Image& picture, JpegFailure& failure) {
  jpeg_decompress_struct jpeg = {};
  jpeg.err = jpeg_std_error(&failure.manager);
  failure.manager.error_exit = leave;
  failure.manager.emit_message = leave_at_warning;
  if (setjmp(failure.back) != 0) {  // NOLINT(cert-err52-cpp)
    jpeg_destroy_decompress(&jpeg);
    return false;
  }
  jpeg_create_decompress(&jpeg);
  jpeg_mem_src(&jpeg, bytes.data(), bytes.size());
  (void)jpeg_read_header(&jpeg, TRUE);
  if (static_cast<int>(jpeg.image_width) != picture.width ||
      static_cast<int>(jpeg.image_height) != picture.height) {
    (void)std::snprintf(failure.message.data(), failure.message.size(),
                        "it has %u x %u pixels where %d x %d belong", jpeg.image_width,
                        jpeg.image_height, picture.width, picture.height);
    jpeg_destroy_decompress(&jpeg);
    return false;
  }
  jpeg.out_color_space = JCS_GRAYSCALE;
  (void)jpeg_start_decompress(&jpeg);
  while (jpeg.output_scanline < jpeg.output_height) {
    JSAMPROW row = picture.row(static_cast<int>(jpeg.output_scanline));
    (void)jpeg_read_scanlines(&jpeg, &row, 1);
  }
  (void)jpeg_finish_decompress(&jpeg);
  jpeg_destroy_decompress(&jpeg);
  return true;
}

}  // namespace

Result<Image> grey_picture(PixelFormat format, std::span<const std::uint8_t> bytes, int width,
                           int height) {
  Image picture(width, height);
  if (format == PixelFormat::mjpeg) {
    JpegFailure failure;
    if (decode(bytes, picture, failure)) return picture;
    return fail(Fault::bad_input, "no whole JPEG picture: {}", failure.message.data());
  }
  const std::size_t step = format == PixelFormat::yuyv ? 2 : 1;
  if (bytes.size() != step * picture.data.size()) {
    return fail(Fault::bad_input, "{} bytes where {} x {} pixels have {}", bytes.size(), width,
                height, step * picture.data.size());
  }
  for (std::size_t i = 0; i < picture.data.size(); ++i) picture.data[i] = bytes[step * i];
  return picture;
}

Image turned(Image picture, int degrees) {
  if (degrees == 180) std::reverse(picture.data.begin(), picture.data.end());
  if (degrees % 180 == 0) return picture;
  Image out(picture.height, picture.width);
  for (int y = 0; y < out.height; ++y) {
    for (int x = 0; x < out.width; ++x) {
      out.row(y)[x] = degrees == 90 ? picture.row(picture.height - 1 - x)[y]
                                    : picture.row(x)[picture.width - 1 - y];
    }
  }
  return out;
}

}  // namespace tuina::hardware
