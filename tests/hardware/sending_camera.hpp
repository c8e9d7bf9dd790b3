// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <linux/videodev2.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>
#include <thread>
#include <vector>
// It needs FILE and size_t from before it.
#include <jpeglib.h>

#include "tests/devices/camera_stage.hpp"
#include "tests/folder.hpp"
#include "tuina/hardware/device_file.hpp"
#include "tuina/hardware/steady_clock.hpp"

namespace tuina::tests {

using Bytes = CameraStage::Bytes;
using hardware::PixelFormat;
using v4l2::FrameHead;
using v4l2::Hello;

inline constexpr int width = 64, height = 48;

inline Bytes bytes_of(PixelFormat format, int number) {
  Bytes bytes(static_cast<std::size_t>(width) * height * (format == PixelFormat::yuyv ? 2 : 1),
              128);
  const std::size_t step = format == PixelFormat::yuyv ? 2 : 1;
  for (std::size_t i = 0; i < bytes.size(); i += step)
    bytes[i] = static_cast<std::uint8_t>(i / step % width + static_cast<std::size_t>(number));
  return bytes;
}

inline Bytes jpeg_of(int wide, int high, int restart_rows = 0) {
  jpeg_compress_struct jpeg = {};
  jpeg_error_mgr manager = {};
  jpeg.err = jpeg_std_error(&manager);
  jpeg_create_compress(&jpeg);
  unsigned char* memory = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&jpeg, &memory, &size);
  jpeg.image_width = static_cast<unsigned>(wide);
  jpeg.image_height = static_cast<unsigned>(high);
  jpeg.input_components = 3;
  jpeg.in_color_space = JCS_RGB;
  jpeg_set_defaults(&jpeg);
  jpeg.restart_in_rows = restart_rows;
  jpeg_start_compress(&jpeg, TRUE);
  for (int y = 0; y < high; ++y) {
    Bytes row(3 * static_cast<std::size_t>(wide));
    for (std::size_t i = 0; i < row.size(); ++i) row[i] = static_cast<std::uint8_t>(2 * (i / 3));
    JSAMPROW at = row.data();
    (void)jpeg_write_scanlines(&jpeg, &at, 1);
  }
  jpeg_finish_compress(&jpeg);
  Bytes bytes(memory, memory + size);
  jpeg_destroy_compress(&jpeg);
  free(memory);
  return bytes;
}

inline Hello usual_hello(PixelFormat format = PixelFormat::grey) {
  constexpr std::array codes = {V4L2_PIX_FMT_GREY, V4L2_PIX_FMT_YUYV, V4L2_PIX_FMT_MJPEG};
  Hello hello;
  hello.mode_count = 1;
  hello.modes[0] = {
      .code = codes.at(static_cast<std::size_t>(format)), .width = width, .height = height};
  return hello;
}

using Spoil = std::function<void(int number, FrameHead& head, Bytes& bytes)>;

/// A camera that sends a frame each 10 ms, which may be spoilt; without bytes none is sent.
class Sender {
 public:
  Sender(const Hello& hello, PixelFormat format, Spoil spoil)
      : stage_((folder_.path() / "camera").string(), hello),
        thread_([this, format, spoil = std::move(spoil)](const std::stop_token& stop) {
          for (int i = 0; !stop.stop_requested(); ++i) {
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
            if (!stage_.taken()) {
              i = -1;
              continue;
            }
            FrameHead head{.flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC,
                           .stamp_us = static_cast<std::int64_t>(1e6 * hardware::steady_s())};
            Bytes bytes =
                format == PixelFormat::mjpeg ? jpeg_of(width, height) : bytes_of(format, i);
            if (spoil) spoil(i, head, bytes);
            head.bytes = static_cast<std::uint32_t>(bytes.size());
            if (!bytes.empty() || head.wrong_index != 0) stage_.send(head, bytes);
          }
        }) {}
  [[nodiscard]] CameraStage& stage() { return stage_; }

 private:
  test::Folder folder_;
  CameraStage stage_;
  std::jthread thread_;
};

}  // namespace tuina::tests
