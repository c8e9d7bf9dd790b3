// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

/// What a stage tells a camera of fake_v4l2.cpp over its socket: once who it is, then each frame
/// with its bytes behind it. When the socket closes, the camera is unplugged.
namespace tuina::tests::v4l2 {

struct Mode {
  std::uint32_t code = 0;  ///< as V4L2_PIX_FMT_...
  std::uint32_t width = 0, height = 0, frames_per_s = 30;
};

struct Hello {
  char name[32] = "fake camera";
  Mode modes[4] = {};
  std::uint32_t mode_count = 0;
  std::uint32_t capabilities = 0;     ///< 0: of a camera
  std::uint32_t failing_request = 0;  ///< this ioctl fails ...
  std::int32_t failure = 0;           ///< ... with this errno
  std::int32_t max_exposure = 10'000, max_gain = 100;
  std::uint32_t has_focus = 1;
  std::uint32_t bigger_by = 0;  ///< sizes are given so much wider than they are asked for
};

struct FrameHead {
  std::uint32_t bytes = 0;        ///< behind this head
  std::uint32_t flags = 0;        ///< of v4l2_buffer, with the clock
  std::int64_t stamp_us = 0;      ///< of the steady clock
  std::uint32_t wrong_index = 0;  ///< added to the buffer's number
};

}  // namespace tuina::tests::v4l2
