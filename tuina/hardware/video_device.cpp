// SPDX-License-Identifier: Apache-2.0
#include "tuina/hardware/video_device.hpp"

#include <fcntl.h>
#include <linux/videodev2.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

namespace tuina::hardware {
namespace {

constexpr std::uint32_t max_listed = 64;  // of a list that a driver never ends

}  // namespace

std::string letters_of_format(std::uint32_t code) {
  std::string letters;
  for (unsigned i = 0; i < 4; ++i) letters += static_cast<char>(code >> (8 * i) & 0x7FU);
  return letters;
}

std::vector<std::string> video_devices() {
  std::vector<std::string> all;
  constexpr int max_number = 63;
  for (int i = 0; i <= max_number; ++i) {
    const std::string path = fmt::format("/dev/video{}", i);
    if (::access(path.c_str(), F_OK) == 0) all.push_back(path);
  }
  return all;
}

Result<CameraListing> list_camera(const std::string& address) {
  const auto device = VideoDevice::open(address);
  if (!device) return tl::unexpected(device.error());
  return CameraListing{.name = device->name(), .modes = device->modes()};
}

Result<VideoDevice> VideoDevice::open(const std::string& address) {
  VideoDevice device(::open(address.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC));
  if (device.number_ < 0) {
    const int why = errno;
    const char* mend = why == ENOENT || why == ENODEV || why == ENXIO
                           ? "is it plugged in? `tuina camera` lists what is"
                       : why == EACCES ? "join the group `video`"
                       : why == EBUSY  ? "end the program that has it"
                                       : "plug it in again";
    return fail(Fault::device, "{} cannot be opened: {}; {}", address, std::strerror(why), mend);
  }
  v4l2_capability can = {};
  if (device.ask(VIDIOC_QUERYCAP, &can) != 0)
    return fail(Fault::device, "{} is no camera; `tuina camera` lists what is one", address);
  const std::uint32_t caps =
      (can.capabilities & V4L2_CAP_DEVICE_CAPS) != 0 ? can.device_caps : can.capabilities;
  if ((caps & V4L2_CAP_VIDEO_CAPTURE) == 0 || (caps & V4L2_CAP_STREAMING) == 0) {
    return fail(Fault::device,
                "{} takes no pictures; a camera may have several devices, so try the one before",
                address);
  }
  const auto* card = reinterpret_cast<const char*>(can.card);
  device.name_ = std::string(card, strnlen(card, sizeof can.card));
  return device;
}

VideoDevice::VideoDevice(VideoDevice&& other) noexcept
    : number_(std::exchange(other.number_, -1)), name_(std::move(other.name_)) {}

VideoDevice& VideoDevice::operator=(VideoDevice&& other) noexcept {
  std::swap(number_, other.number_);
  std::swap(name_, other.name_);
  return *this;
}

VideoDevice::~VideoDevice() {
  if (number_ >= 0) ::close(number_);
}

int VideoDevice::ask(unsigned long request, void* what) const {
  int result = 0;
  do result = ::ioctl(number_, request, what);
  while (result < 0 && errno == EINTR);
  return result;
}

double VideoDevice::max_rate(std::uint32_t format, std::uint32_t width,
                             std::uint32_t height) const {
  double rate = 0.0;
  v4l2_frmivalenum interval = {};
  interval.pixel_format = format;
  interval.width = width;
  interval.height = height;
  for (; interval.index < max_listed; ++interval.index) {
    if (ask(VIDIOC_ENUM_FRAMEINTERVALS, &interval) != 0) break;
    const v4l2_fract& time_s =
        interval.type == V4L2_FRMIVAL_TYPE_DISCRETE ? interval.discrete : interval.stepwise.min;
    if (time_s.numerator > 0)
      rate = std::max(rate, static_cast<double>(time_s.denominator) / time_s.numerator);
  }
  return rate;
}

std::vector<CameraMode> VideoDevice::modes() const {
  std::vector<CameraMode> modes;
  v4l2_fmtdesc format = {};
  format.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  for (; format.index < max_listed; ++format.index) {
    if (ask(VIDIOC_ENUM_FMT, &format) != 0) break;
    v4l2_frmsizeenum size = {};
    size.pixel_format = format.pixelformat;
    for (; size.index < max_listed; ++size.index) {
      if (ask(VIDIOC_ENUM_FRAMESIZES, &size) != 0) break;
      const bool discrete = size.type == V4L2_FRMSIZE_TYPE_DISCRETE;
      const std::uint32_t width = discrete ? size.discrete.width : size.stepwise.max_width;
      const std::uint32_t height = discrete ? size.discrete.height : size.stepwise.max_height;
      modes.push_back({.format = letters_of_format(format.pixelformat),
                       .width_px = static_cast<int>(width),
                       .height_px = static_cast<int>(height),
                       .max_frames_per_s = max_rate(format.pixelformat, width, height)});
      if (!discrete) break;
    }
  }
  return modes;
}

}  // namespace tuina::hardware
