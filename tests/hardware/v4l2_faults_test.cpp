// SPDX-License-Identifier: Apache-2.0
#include "tuina/hardware/v4l2_camera.hpp"

#include <doctest/doctest.h>

#include <cerrno>

#include "tests/hardware/sending_camera.hpp"
#include "tests/open_files.hpp"

using namespace tuina;
using namespace tuina::tests;
using hardware::CameraDevice;
using hardware::V4l2Camera;

namespace {

struct CameraFault {
  const char* name;
  const char* said;
  std::function<void(Hello&)> hello = {};
  std::function<void(CameraDevice&)> device = {};
  Spoil spoil = {};
  PixelFormat format = PixelFormat::grey;
};

/// What a camera says at its 20th frame at the latest; "twenty frames" when all were good.
std::string message_of(const CameraFault& fault) {
  Hello hello = usual_hello(fault.format);
  if (fault.hello) fault.hello(hello);
  Sender sender(hello, fault.format, fault.spoil);
  CameraDevice device{.address = sender.stage().path(), .format = fault.format};
  if (fault.device) fault.device(device);
  const auto camera = V4l2Camera::open(device, width, height);
  if (!camera) {
    CHECK(camera.error().fault == Fault::device);
    return camera.error().message;
  }
  for (int i = 0; i < 20; ++i) {
    const double asked_s = hardware::steady_s();
    const auto frame = (*camera)->next_frame(scanner::frame_timeout_s);
    CHECK(hardware::steady_s() - asked_s < 1.0);
    if (frame) continue;
    CHECK(frame.error().fault == Fault::device);
    CHECK(frame.error().message.starts_with(sender.stage().path()));
    return frame.error().message;
  }
  return "twenty frames";
}

void check_all(const std::vector<CameraFault>& faults) {
  const std::size_t open = test::open_files();
  for (const CameraFault& fault : faults) {
    const std::string message = message_of(fault);
    INFO(std::string(fault.name));
    CHECK_MESSAGE(message.find(fault.said) != std::string::npos, message);
  }
  CHECK(test::open_files() == open);
}

std::function<void(Hello&)> fails(unsigned long request, int why) {
  return [=](Hello& hello) {
    hello.failing_request = static_cast<std::uint32_t>(request);
    hello.failure = why;
  };
}

Spoil from_fifth(std::function<void(int, FrameHead&, Bytes&)> spoil) {
  return [spoil](int i, FrameHead& head, Bytes& bytes) {
    if (i >= 5) spoil(i, head, bytes);
  };
}

std::vector<CameraFault> before_the_start() {
  return {
      {"nothing there",
       "is it plugged in? `tuina camera` lists",
       {},
       [](CameraDevice& d) { d.address = "/dev/video63"; }},
      {"no camera", "is no camera", {}, [](CameraDevice& d) { d.address = "/dev/null"; }},
      {"another device", "is no camera", fails(VIDIOC_QUERYCAP, ENOTTY)},
      {"metadata device", "takes no pictures",
       [](Hello& h) { h.capabilities = V4L2_CAP_META_CAPTURE | V4L2_CAP_STREAMING; }},
      {"no streaming", "takes no pictures",
       [](Hello& h) { h.capabilities = V4L2_CAP_VIDEO_CAPTURE; }},
      {"in use", "is used by another program", fails(VIDIOC_S_FMT, EBUSY)},
      {"another size", "it offers GREY 32 x 48", [](Hello& h) { h.modes[0].width = 32; }},
      {"another format", "has no mode GREY of 64 x 48 pixels",
       [](Hello& h) { h.modes[0].code = V4L2_PIX_FMT_YUYV; }},
      {"a size of its own", "has no mode", [](Hello& h) { h.bigger_by = 16; }},
      {"no modes", "it offers none",
       [](Hello& h) {
         h.mode_count = 0;
         h.modes[0].width = 0;
       }},
      {"no memory", "gives no memory", fails(VIDIOC_REQBUFS, ENOMEM)},
      {"memory in use", "is used by another program", fails(VIDIOC_REQBUFS, EBUSY)},
      {"no buffer", "gives no memory", fails(VIDIOC_QUERYBUF, EINVAL)},
      {"buffer not taken", "takes no memory", fails(VIDIOC_QBUF, EIO)},
      {"bus full", "is the USB bus overloaded", fails(VIDIOC_STREAMON, ENOSPC)},
      {"exposure too long", "takes exposure (units of 0.1 ms) from 1 to 100, not 250",
       [](Hello& h) { h.max_exposure = 100; }, [](CameraDevice& d) { d.exposure_ms = 25.0; }},
      {"gain too high",
       "takes gain from 0 to 100, not 101",
       {},
       [](CameraDevice& d) { d.gain = 101; }},
      {"no focus", "has no focus to set", [](Hello& h) { h.has_focus = 0; },
       [](CameraDevice& d) { d.focus = 10; }},
      {"focus too far",
       "takes focus from 0 to 250, not 900",
       {},
       [](CameraDevice& d) { d.focus = 900; }},
      {"gain not taken", "does not take gain 5: ", fails(VIDIOC_S_CTRL, EIO),
       [](CameraDevice& d) { d.gain = 5; }},
  };
}

std::vector<CameraFault> of_frames() {
  return {
      {"silent from the first",
       "gave no frame within 150 ms",
       {},
       {},
       [](int, FrameHead&, Bytes& b) { b.clear(); }},
      {"falls silent",
       "gave no frame within 150 ms",
       {},
       {},
       from_fifth([](int, FrameHead&, Bytes& b) { b.clear(); })},
      {"late", "gave no frame within 150 ms", {}, {}, from_fifth([](int i, FrameHead&, Bytes& b) {
         if (i % 30 != 0) b.clear();
       })},
      {"half a frame",
       "5 frames in a row are broken (1536 bytes where 64 x 48 pixels have 3072)",
       {},
       {},
       from_fifth([](int, FrameHead&, Bytes& b) { b.resize(b.size() / 2); })},
      {"a row too many",
       "5 frames in a row are broken",
       {},
       {},
       from_fifth([](int, FrameHead&, Bytes& b) { b.resize(b.size() + width); })},
      {"one byte",
       "5 frames in a row are broken",
       {},
       {},
       from_fifth([](int, FrameHead&, Bytes& b) { b.resize(1); })},
      {"driver's fault flag",
       "5 frames in a row are broken (the driver says so)",
       {},
       {},
       from_fifth([](int, FrameHead& h, Bytes&) { h.flags |= V4L2_BUF_FLAG_ERROR; })},
      {"another clock",
       "does not stamp frames by the steady clock",
       {},
       {},
       [](int, FrameHead& h, Bytes&) { h.flags = V4L2_BUF_FLAG_TIMESTAMP_COPY; }},
      {"clock unknown",
       "does not stamp frames by the steady clock",
       {},
       {},
       [](int, FrameHead& h, Bytes&) { h.flags = 0; }},
      {"stamps go back", "stamps a frame at", {}, {}, from_fifth([](int, FrameHead& h, Bytes&) {
         h.stamp_us -= 2'000'000;
       })},
      {"stamps stand", "stamps a frame at", {}, {}, from_fifth([](int, FrameHead& h, Bytes&) {
         h.stamp_us = 5;
       })},
      {"the future", "s into the future", {}, {}, from_fifth([](int, FrameHead& h, Bytes&) {
         h.stamp_us += 2'000'000;
       })},
      {"wall clock",
       "s into the future",
       {},
       {},
       [](int, FrameHead& h, Bytes&) { h.stamp_us = 1'700'000'000'000'000; }},
      {"number of a buffer",
       "gives a picture where none can be",
       {},
       {},
       from_fifth([](int, FrameHead& h, Bytes&) { h.wrong_index = 1000; })},
      {"input fault", "5 frames in a row are broken (nothing came)", fails(VIDIOC_DQBUF, EIO)},
      {"gone in the kernel", "was unplugged (No such device)", fails(VIDIOC_DQBUF, ENODEV)},
      {"JPEG cut",
       "5 frames in a row are broken (no whole JPEG picture: ",
       {},
       {},
       from_fifth([](int, FrameHead&, Bytes& b) { b.resize(b.size() - 40); }),
       PixelFormat::mjpeg},
      {"JPEG of another size",
       "it has 32 x 48 pixels where 64 x 48 belong",
       {},
       {},
       from_fifth([](int, FrameHead&, Bytes& b) { b = jpeg_of(32, 48); }),
       PixelFormat::mjpeg},
      {"no JPEG",
       "no whole JPEG picture: Not a JPEG file",
       {},
       {},
       from_fifth([](int, FrameHead&, Bytes& b) { b = bytes_of(PixelFormat::grey, 1); }),
       PixelFormat::mjpeg},
      {"JPEG overwritten",
       "no whole JPEG picture",
       {},
       {},
       from_fifth([](int, FrameHead&, Bytes& b) { std::fill(b.begin() + 200, b.end(), 0xFF); }),
       PixelFormat::mjpeg},
  };
}

}  // namespace

TEST_CASE("what is wrong with a camera or its frames is named, and ends the scan") {
  const auto before = before_the_start(), later = of_frames();
  const std::size_t count = before.size() + later.size();
  MESSAGE(count << " faults of a camera");
  CHECK(count >= 40);
  check_all(before);
  check_all(later);
}

TEST_CASE("a few broken frames are lost, and the next one is taken") {
  check_all({{"some halves",
              "twenty frames",
              {},
              {},
              [](int i, FrameHead&, Bytes& b) {
                if (i % 4 == 1) b.resize(10);
              }},
             {"three in a row", "twenty frames", {}, {}, [](int i, FrameHead& h, Bytes&) {
                if (i % 8 < 3) h.flags |= V4L2_BUF_FLAG_ERROR;
              }}});
}
