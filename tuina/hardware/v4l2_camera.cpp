// SPDX-License-Identifier: Apache-2.0
#include "tuina/hardware/v4l2_camera.hpp"

#include <linux/videodev2.h>
#include <poll.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>

#include "tuina/hardware/camera_pixels.hpp"
#include "tuina/hardware/steady_clock.hpp"
#include "tuina/hardware/video_device.hpp"

namespace tuina::hardware {
namespace {

constexpr std::uint32_t wanted_buffers = 4;
constexpr int max_broken = 5;
constexpr double max_unasked_s = 0.15;  // the buffers hold as much
constexpr double max_ahead_s = 0.05;    // of a time stamp before this machine's clock

std::uint32_t code_of(PixelFormat format) {
  return format == PixelFormat::grey   ? V4L2_PIX_FMT_GREY
         : format == PixelFormat::yuyv ? V4L2_PIX_FMT_YUYV
                                       : V4L2_PIX_FMT_MJPEG;
}

}  // namespace

tl::unexpected<Error> V4l2Camera::wrong(const std::string& what) const {
  return fail(Fault::device, "{}: {}", device_.address, what);
}

Result<std::unique_ptr<V4l2Camera>> V4l2Camera::open(const CameraDevice& device, int width_px,
                                                     int height_px) {
  auto kernel = VideoDevice::open(device.address);
  if (!kernel) return tl::unexpected(kernel.error());
  std::unique_ptr<V4l2Camera> camera(new V4l2Camera(device, std::move(*kernel)));
  if (device.turned_deg % 180 != 0) std::swap(width_px, height_px);
  auto done = camera->set_mode(width_px, height_px);
  if (done) done = camera->set_controls();
  if (done) done = camera->begin();
  if (!done) return tl::unexpected(done.error());
  return camera;
}

V4l2Camera::~V4l2Camera() {
  v4l2_buf_type type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  (void)kernel_.ask(VIDIOC_STREAMOFF, &type);
  for (const auto& buffer : buffers_) ::munmap(buffer.data(), buffer.size());
}

Result<void> V4l2Camera::set_mode(int width_px, int height_px) {
  v4l2_format format = {};
  format.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  format.fmt.pix.width = static_cast<std::uint32_t>(width_px);
  format.fmt.pix.height = static_cast<std::uint32_t>(height_px);
  format.fmt.pix.pixelformat = code_of(device_.format);
  format.fmt.pix.field = V4L2_FIELD_NONE;
  const int result = kernel_.ask(VIDIOC_S_FMT, &format);
  if (result != 0 && errno == EBUSY) return wrong("is used by another program; end that");
  const v4l2_pix_format& got = format.fmt.pix;
  const bool just_this = result == 0 && got.pixelformat == code_of(device_.format) &&
                         static_cast<int>(got.width) == width_px &&
                         static_cast<int>(got.height) == height_px;
  if (!just_this) {
    std::string offers;
    for (const CameraMode& mode : kernel_.modes())
      offers += fmt::format("{}{} {} x {}", offers.empty() ? "" : ", ", mode.format, mode.width_px,
                            mode.height_px);
    return wrong(
        fmt::format("has no mode {} of {} x {} pixels, for which the calibration is; it "
                    "offers {}",
                    letters_of_format(code_of(device_.format)), width_px, height_px,
                    offers.empty() ? "none" : offers));
  }
  width_px_ = width_px;
  height_px_ = height_px;
  v4l2_streamparm rate = {};
  rate.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  rate.parm.capture.timeperframe = {
      .numerator = 1, .denominator = static_cast<std::uint32_t>(device_.frames_per_s)};
  (void)kernel_.ask(VIDIOC_S_PARM, &rate);  // some cameras have one rate only
  return {};
}

// Sets what the camera has. What was ordered by name must be there, and take the value.
Result<void> V4l2Camera::set(std::uint32_t control, std::optional<int> value,
                             const char* name) const {
  if (!value) return {};
  v4l2_queryctrl limits = {};
  limits.id = control;
  const bool there =
      kernel_.ask(VIDIOC_QUERYCTRL, &limits) == 0 && (limits.flags & V4L2_CTRL_FLAG_DISABLED) == 0;
  if (!there && name == nullptr) return {};
  if (!there) return wrong(fmt::format("has no {} to set; take it out of the device file", name));
  if (*value < limits.minimum || *value > limits.maximum) {
    if (name == nullptr) return {};
    return wrong(fmt::format("takes {} from {} to {}, not {}", name, limits.minimum, limits.maximum,
                             *value));
  }
  v4l2_control order = {.id = control, .value = *value};
  if (kernel_.ask(VIDIOC_S_CTRL, &order) == 0 || name == nullptr) return {};
  return wrong(fmt::format("does not take {} {}: {}", name, *value, std::strerror(errno)));
}

Result<void> V4l2Camera::set_controls() {
  struct Order {
    std::uint32_t control;
    std::optional<int> value;
    const char* name;  // null: where the camera has it
  };
  const auto if_set = [](bool set, int value) { return set ? std::optional(value) : std::nullopt; };
  std::optional<int> exposure;  // in units of 0.1 ms
  if (device_.exposure_ms) exposure = static_cast<int>(std::lround(10.0 * *device_.exposure_ms));
  const std::vector<Order> orders = {
      {V4L2_CID_POWER_LINE_FREQUENCY, V4L2_CID_POWER_LINE_FREQUENCY_DISABLED, nullptr},
      {V4L2_CID_AUTO_WHITE_BALANCE, 0, nullptr},
      {V4L2_CID_EXPOSURE_AUTO, if_set(exposure.has_value(), V4L2_EXPOSURE_MANUAL), nullptr},
      {V4L2_CID_EXPOSURE_AUTO_PRIORITY, 0, nullptr},  // the frame rate stays as it is
      {V4L2_CID_AUTOGAIN, if_set(device_.gain.has_value(), 0), nullptr},
      {V4L2_CID_FOCUS_AUTO, if_set(device_.focus.has_value(), 0), nullptr},
      {V4L2_CID_EXPOSURE_ABSOLUTE, exposure, "exposure (units of 0.1 ms)"},
      {V4L2_CID_GAIN, device_.gain, "gain"},
      {V4L2_CID_FOCUS_ABSOLUTE, device_.focus, "focus"}};
  for (const Order& order : orders) {
    auto done = set(order.control, order.value, order.name);
    if (!done) return done;
  }
  return {};
}

Result<void> V4l2Camera::begin() {
  v4l2_requestbuffers wanted = {};
  wanted.count = wanted_buffers;
  wanted.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  wanted.memory = V4L2_MEMORY_MMAP;
  if (kernel_.ask(VIDIOC_REQBUFS, &wanted) != 0 || wanted.count < 2)
    return wrong(errno == EBUSY ? "is used by another program; end that"
                                : "gives no memory for pictures");
  for (std::uint32_t i = 0; i < wanted.count; ++i) {
    v4l2_buffer buffer = {};
    buffer.index = i;
    buffer.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    buffer.memory = V4L2_MEMORY_MMAP;
    if (kernel_.ask(VIDIOC_QUERYBUF, &buffer) != 0)
      return wrong(fmt::format("gives no memory for pictures: {}", std::strerror(errno)));
    void* at = ::mmap(nullptr, buffer.length, PROT_READ | PROT_WRITE, MAP_SHARED, kernel_.number(),
                      buffer.m.offset);
    if (at == MAP_FAILED)
      return wrong(fmt::format("gives no memory for pictures: {}", std::strerror(errno)));
    buffers_.emplace_back(static_cast<std::uint8_t*>(at), buffer.length);
    if (kernel_.ask(VIDIOC_QBUF, &buffer) != 0)
      return wrong(fmt::format("takes no memory for pictures: {}", std::strerror(errno)));
  }
  v4l2_buf_type type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  if (kernel_.ask(VIDIOC_STREAMON, &type) != 0)
    return wrong(
        fmt::format("does not begin: {}; is the USB bus overloaded?", std::strerror(errno)));
  return {};
}

Result<void> V4l2Camera::wait(double until_s, double timeout_s) const {
  for (;;) {
    pollfd wanted = {.fd = kernel_.number(), .events = POLLIN, .revents = 0};
    const int left_ms = std::max(0, static_cast<int>(std::ceil(1e3 * (until_s - steady_s()))));
    const int ready = ::poll(&wanted, 1, left_ms);
    if (ready < 0 && errno == EINTR) continue;
    if (ready > 0 && (wanted.revents & POLLIN) != 0) return {};
    if (ready > 0) return wrong("was unplugged; plug it in again");
    return wrong(fmt::format("gave no frame within {:.0f} ms; does it hang? plug it in again",
                             1e3 * timeout_s));
  }
}

Result<scanner::Frame> V4l2Camera::next_frame(double timeout_s) {
  const double now_s = steady_s();
  const double from_s = now_s - asked_s_ > max_unasked_s ? now_s : asked_s_ - max_unasked_s;
  for (int broken = 0;;) {
    if (const auto there = wait(now_s + timeout_s, timeout_s); !there)
      return tl::unexpected(there.error());
    auto frame = take();
    if (!frame && frame.error().fault == Fault::device) return frame;
    if (frame && frame->time_s >= from_s) {
      asked_s_ = steady_s();
      return frame;
    }
    if (frame && steady_s() > now_s + timeout_s)
      return wrong(fmt::format("its frames come {:.2f} s late; is this machine overloaded?",
                               steady_s() - frame->time_s));
    if (!frame && ++broken == max_broken)
      return wrong(
          fmt::format("{} frames in a row are broken ({}); is the cable or the USB bus "
                      "overloaded?",
                      broken, frame.error().message));
  }
}

// The oldest frame that the driver has. Fault::bad_input: it is broken, and the next may be good.
Result<scanner::Frame> V4l2Camera::take() {
  v4l2_buffer buffer = {};
  buffer.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  buffer.memory = V4L2_MEMORY_MMAP;
  if (kernel_.ask(VIDIOC_DQBUF, &buffer) != 0) {
    if (errno == EAGAIN || errno == EIO) return fail(Fault::bad_input, "nothing came");
    return wrong(fmt::format("was unplugged ({}); plug it in again", std::strerror(errno)));
  }
  if (buffer.index >= buffers_.size()) return wrong("gives a picture where none can be");
  const std::span<const std::uint8_t> memory = buffers_[buffer.index];
  Result<Image> picture = fail(Fault::bad_input, "the driver says so");
  if ((buffer.flags & V4L2_BUF_FLAG_ERROR) == 0 && buffer.bytesused <= memory.size())
    picture = grey_picture(device_.format, memory.first(buffer.bytesused), width_px_, height_px_);
  const bool steady =
      (buffer.flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) == V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC;
  const double time_s = static_cast<double>(buffer.timestamp.tv_sec) +
                        1e-6 * static_cast<double>(buffer.timestamp.tv_usec);
  if (kernel_.ask(VIDIOC_QBUF, &buffer) != 0)
    return wrong(fmt::format("was unplugged ({}); plug it in again", std::strerror(errno)));
  if (!picture) return tl::unexpected(picture.error());
  if (!steady) return wrong("its driver does not stamp frames by the steady clock");
  if (time_s > steady_s() + max_ahead_s)
    return wrong(fmt::format("stamps a frame {:.3f} s into the future", time_s - steady_s()));
  if (last_s_ && time_s <= *last_s_)
    return wrong(fmt::format("stamps a frame at {:.3f} s after one at {:.3f} s", time_s, *last_s_));
  last_s_ = time_s;
  return scanner::Frame{
      .time_s = time_s, .image = turned(std::move(*picture), device_.turned_deg), .dark = {}};
}

}  // namespace tuina::hardware
