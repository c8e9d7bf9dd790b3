// SPDX-License-Identifier: Apache-2.0
#include "tuina/hardware/v4l2_camera.hpp"

#include <doctest/doctest.h>

#include "tests/hardware/sending_camera.hpp"
#include "tests/reason.hpp"
#include "tuina/hardware/camera_pixels.hpp"

using namespace tuina;
using namespace tuina::tests;
using hardware::V4l2Camera;

TEST_CASE("grey, YUYV and JPEG frames come with the driver's times, whole and in order") {
  for (const PixelFormat format : {PixelFormat::grey, PixelFormat::yuyv, PixelFormat::mjpeg}) {
    Sender sender(usual_hello(format), format, {});
    const auto camera =
        V4l2Camera::open({.address = sender.stage().path(), .format = format}, width, height);
    REQUIRE_MESSAGE(camera.has_value(), test::reason(camera));
    double before_s = 0.0;
    for (int i = 0; i < 10; ++i) {
      const auto frame = (*camera)->next_frame(1.0);
      REQUIRE_MESSAGE(frame.has_value(), test::reason(frame));
      CHECK(frame->time_s > before_s);
      CHECK(std::abs(frame->time_s - hardware::steady_s()) < 0.5);
      before_s = frame->time_s;
      REQUIRE(frame->image.width == width);
      const double step = format == PixelFormat::mjpeg ? 2.0 : 1.0;
      for (int x = 4; x < width - 4; ++x)
        CHECK(std::abs(frame->image.row(20)[x] - frame->image.row(20)[x - 1] - step) <= 2.0);
    }
  }
}

TEST_CASE("a picture is turned to the right") {
  Image picture(3, 2);
  picture.data = {1, 2, 3, 4, 5, 6};
  CHECK(hardware::turned(picture, 0).data == picture.data);
  CHECK(hardware::turned(picture, 90).data == std::vector<std::uint8_t>{4, 1, 5, 2, 6, 3});
  CHECK(hardware::turned(picture, 180).data == std::vector<std::uint8_t>{6, 5, 4, 3, 2, 1});
  CHECK(hardware::turned(picture, 270).data == std::vector<std::uint8_t>{3, 6, 2, 5, 1, 4});
  CHECK(hardware::turned(hardware::turned(picture, 90), 270).data == picture.data);
  Sender sender(usual_hello(), PixelFormat::grey, {});
  const auto camera = V4l2Camera::open(
      {.address = sender.stage().path(), .format = PixelFormat::grey, .turned_deg = 90}, height,
      width);
  REQUIRE_MESSAGE(camera.has_value(), test::reason(camera));
  CHECK((*camera)->next_frame(1.0)->image.height == width);
}

TEST_CASE("a camera is listed with its modes") {
  Hello hello = usual_hello();
  hello.modes[1] = {.code = V4L2_PIX_FMT_MJPEG, .width = 1280, .height = 720, .frames_per_s = 60};
  hello.mode_count = 2;
  Sender sender(hello, PixelFormat::grey, {});
  const auto listing = hardware::list_camera(sender.stage().path());
  REQUIRE_MESSAGE(listing.has_value(), test::reason(listing));
  CHECK(listing->name == "fake camera");
  REQUIRE(listing->modes.size() == 2);
  CHECK(listing->modes[1].format == "MJPG");
  CHECK(listing->modes[1].width_px == 1280);
  CHECK(listing->modes[1].max_frames_per_s == 60.0);
}

TEST_CASE("a camera that is unplugged says so") {
  Sender sender(usual_hello(), PixelFormat::grey, {});
  const auto camera = V4l2Camera::open(
      {.address = sender.stage().path(), .format = PixelFormat::grey}, width, height);
  REQUIRE_MESSAGE(camera.has_value(), test::reason(camera));
  REQUIRE((*camera)->next_frame(1.0).has_value());
  sender.stage().unplug();
  std::string message;
  for (int i = 0; i < 10 && message.empty(); ++i)
    if (const auto frame = (*camera)->next_frame(0.15); !frame) message = frame.error().message;
  CHECK_MESSAGE(message.find("was unplugged") != std::string::npos, message);
}

TEST_CASE(
    "bytes too many before a restart marker, as the Logitech C270 sends them, spoil nothing") {
  constexpr int restart_rows = 1;
  const tests::Bytes bytes = tests::jpeg_of(32, 48, restart_rows);
  const auto plain = grey_picture(PixelFormat::mjpeg, bytes, 32, 48);
  REQUIRE(plain.has_value());
  tests::Bytes more;
  int restarts = 0;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    const bool restart = i + 1 < bytes.size() && bytes[i] == 0xFF && (bytes[i + 1] & 0xF8) == 0xD0;
    if (restart) more.insert(more.end(), {0x3C, 0x5A}), ++restarts;
    more.push_back(bytes[i]);
  }
  REQUIRE(restarts > 0);
  const auto same = grey_picture(PixelFormat::mjpeg, more, 32, 48);
  REQUIRE(same.has_value());
  CHECK(same->data == plain->data);
  // Elsewhere they are what a damaged picture leaves over.
  tests::Bytes damaged = bytes;
  damaged.insert(damaged.begin() + 2, {0x3C, 0x5A});
  CHECK_FALSE(grey_picture(PixelFormat::mjpeg, damaged, 32, 48).has_value());
}
