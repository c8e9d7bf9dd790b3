// SPDX-License-Identifier: Apache-2.0
// A camera of Video4Linux below the system calls, for LD_PRELOAD or to link before the C library: a
// Unix socket that is opened as a file is a camera whose frames come through the socket. All else
// goes to the kernel.
#include "tests/devices/fake_v4l2.hpp"

#include <fcntl.h>
#include <linux/videodev2.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/un.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdarg>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <vector>

namespace {

using namespace tuina::tests::v4l2;

constexpr unsigned max_buffers = 8;

struct FakeCamera {
  int number = -1;
  Hello hello;
  Mode mode;
  unsigned frame_bytes = 0;
  void* buffers[max_buffers] = {};
  std::vector<unsigned> queued;
};
FakeCamera camera;  // one at a time

/// The clock that the stage keeps, in nanoseconds; null: the machine's.
const std::atomic<std::int64_t>* stage_clock() {
  static const std::atomic<std::int64_t>* const clock = [] {
    const char* path = std::getenv("TUINA_CLOCK");
    const long file = path != nullptr ? ::syscall(SYS_openat, AT_FDCWD, path, O_RDONLY, 0) : -1;
    void* page = MAP_FAILED;
    if (file >= 0)
      page = reinterpret_cast<void*>(
          ::syscall(SYS_mmap, nullptr, 4096, PROT_READ, MAP_SHARED, file, 0));
    return page != MAP_FAILED ? static_cast<const std::atomic<std::int64_t>*>(page) : nullptr;
  }();
  return clock;
}

constexpr timespec moment = {.tv_sec = 0, .tv_nsec = 100'000};  // of the machine's own clock
int failed(int why) {
  errno = why;
  return -1;
}

bool read_whole(void* into, std::size_t size) {
  auto* at = static_cast<char*>(into);
  while (size > 0) {
    const ssize_t got = ::recv(camera.number, at, size, 0);
    if (got <= 0) return false;
    at += got;
    size -= static_cast<std::size_t>(got);
  }
  return true;
}

bool is_socket(const char* path) {
  struct stat status = {};
  return ::syscall(SYS_newfstatat, AT_FDCWD, path, &status, 0) == 0 && S_ISSOCK(status.st_mode);
}

int open_camera(const char* path) {
  const int number = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_un address = {};
  address.sun_family = AF_UNIX;
  std::strncpy(address.sun_path, path, sizeof address.sun_path - 1);
  if (::connect(number, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    ::syscall(SYS_close, number);
    return failed(ENXIO);
  }
  camera = FakeCamera{};
  camera.number = number;
  if (!read_whole(&camera.hello, sizeof camera.hello)) {
    ::syscall(SYS_close, number);
    camera = FakeCamera{};
    return failed(ENODEV);
  }
  return number;
}

unsigned bytes_of(const Mode& mode) {
  return mode.width * mode.height * (mode.code == V4L2_PIX_FMT_GREY ? 1 : 2);
}

int control(unsigned id, int& low, int& high) {
  low = 0;
  switch (id) {
    case V4L2_CID_EXPOSURE_ABSOLUTE:
      low = 1;
      high = camera.hello.max_exposure;
      return 0;
    case V4L2_CID_GAIN:
      high = camera.hello.max_gain;
      return 0;
    case V4L2_CID_EXPOSURE_AUTO:
    case V4L2_CID_POWER_LINE_FREQUENCY:
      high = 3;
      return 0;
    case V4L2_CID_FOCUS_ABSOLUTE:
      high = 250;
      return camera.hello.has_focus != 0 ? 0 : failed(EINVAL);
    default:
      return failed(EINVAL);
  }
}

int take_frame(v4l2_buffer& buffer) {
  FrameHead head;
  const ssize_t there = ::recv(camera.number, &head, sizeof head, MSG_PEEK | MSG_DONTWAIT);
  if (there == 0) return failed(ENODEV);
  if (there < static_cast<ssize_t>(sizeof head) || camera.queued.empty()) return failed(EAGAIN);
  std::vector<char> data;
  if (!read_whole(&head, sizeof head)) return failed(ENODEV);
  data.resize(head.bytes);
  if (!read_whole(data.data(), data.size())) return failed(ENODEV);
  const unsigned index = camera.queued.front();
  camera.queued.erase(camera.queued.begin());
  std::memcpy(camera.buffers[index], data.data(),
              std::min<std::size_t>(data.size(), camera.frame_bytes));
  buffer.index = index + head.wrong_index;
  buffer.bytesused = head.bytes;
  buffer.flags = head.flags;
  buffer.timestamp.tv_sec = head.stamp_us / 1'000'000;
  buffer.timestamp.tv_usec = head.stamp_us % 1'000'000;
  return 0;
}

int list_mode(unsigned index, unsigned code, Mode& mode) {
  for (unsigned i = 0; i < camera.hello.mode_count; ++i) {
    mode = camera.hello.modes[i];
    if ((code == 0 || mode.code == code) && index-- == 0) return 0;
  }
  return failed(EINVAL);
}

int set_format(v4l2_pix_format& pixels) {
  Mode mode = camera.hello.modes[0];  // a driver answers with what it has
  for (unsigned i = 0; i < camera.hello.mode_count; ++i) {
    const Mode& other = camera.hello.modes[i];
    if (other.code == pixels.pixelformat && other.width == pixels.width &&
        other.height == pixels.height)
      mode = other;
  }
  camera.mode = mode;
  pixels.pixelformat = mode.code;
  pixels.width = mode.width + camera.hello.bigger_by;
  pixels.height = mode.height;
  camera.frame_bytes = pixels.sizeimage = bytes_of(mode);
  return 0;
}

// Who it is and which modes it has.
int describe(unsigned long request, void* what) {
  Mode mode;
  if (request == VIDIOC_QUERYCAP) {
    auto& can = *static_cast<v4l2_capability*>(what);
    std::memcpy(can.card, camera.hello.name, sizeof can.card);
    can.capabilities = camera.hello.capabilities != 0 ? camera.hello.capabilities
                                                      : V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;
    return 0;
  }
  if (request == VIDIOC_ENUM_FMT) {
    auto& format = *static_cast<v4l2_fmtdesc*>(what);
    if (list_mode(format.index, 0, mode) != 0) return -1;
    format.pixelformat = mode.code;
    return 0;
  }
  if (request == VIDIOC_ENUM_FRAMESIZES) {
    auto& size = *static_cast<v4l2_frmsizeenum*>(what);
    if (list_mode(size.index, size.pixel_format, mode) != 0) return -1;
    size.type = V4L2_FRMSIZE_TYPE_DISCRETE;
    size.discrete = {.width = mode.width, .height = mode.height};
    return 0;
  }
  if (request != VIDIOC_ENUM_FRAMEINTERVALS) return failed(ENOTTY);
  auto& interval = *static_cast<v4l2_frmivalenum*>(what);
  if (interval.index > 0 || list_mode(0, interval.pixel_format, mode) != 0) return failed(EINVAL);
  interval.type = V4L2_FRMIVAL_TYPE_DISCRETE;
  interval.discrete = {.numerator = 1, .denominator = mode.frames_per_s};
  return 0;
}

int answer(unsigned long request, void* what) {
  if (camera.hello.failing_request != 0 && request == camera.hello.failing_request)
    return failed(camera.hello.failure);
  int low = 0, high = 0;
  switch (request) {
    case VIDIOC_S_FMT:
      return set_format(static_cast<v4l2_format*>(what)->fmt.pix);
    case VIDIOC_S_PARM:
    case VIDIOC_STREAMON:
    case VIDIOC_STREAMOFF:
      return 0;
    case VIDIOC_QUERYCTRL: {
      auto& limits = *static_cast<v4l2_queryctrl*>(what);
      return control(limits.id, limits.minimum, limits.maximum);
    }
    case VIDIOC_S_CTRL:
      return control(static_cast<v4l2_control*>(what)->id, low, high);
    case VIDIOC_REQBUFS: {
      auto& wanted = *static_cast<v4l2_requestbuffers*>(what);
      wanted.count = std::min(wanted.count, max_buffers);
      return 0;
    }
    case VIDIOC_QUERYBUF: {
      auto& buffer = *static_cast<v4l2_buffer*>(what);
      buffer.length = camera.frame_bytes;
      buffer.m.offset = buffer.index * 4096;
      return 0;
    }
    case VIDIOC_QBUF:
      camera.queued.push_back(static_cast<v4l2_buffer*>(what)->index % max_buffers);
      return 0;
    case VIDIOC_DQBUF:
      return take_frame(*static_cast<v4l2_buffer*>(what));
    default:
      return describe(request, what);
  }
}

}  // namespace

extern "C" {

int open(const char* path, int flags, ...) {
  va_list rest;
  va_start(rest, flags);
  const int mode = (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(rest, int) : 0;
  va_end(rest);
  if (is_socket(path)) return open_camera(path);
  return static_cast<int>(::syscall(SYS_openat, AT_FDCWD, path, flags, mode));
}

int close(int number) {
  if (number >= 0 && number == camera.number) camera.number = -1;
  return static_cast<int>(::syscall(SYS_close, number));
}

int ioctl(int number, unsigned long request, ...) {
  va_list rest;
  va_start(rest, request);
  void* what = va_arg(rest, void*);
  va_end(rest);
  if (number >= 0 && number == camera.number) return answer(request, what);
  return static_cast<int>(::syscall(SYS_ioctl, number, request, what));
}

int clock_gettime(clockid_t clock, timespec* now) noexcept {
  const auto* kept = clock == CLOCK_MONOTONIC ? stage_clock() : nullptr;
  if (kept == nullptr) return static_cast<int>(::syscall(SYS_clock_gettime, clock, now));
  const std::int64_t ns = *kept;
  *now = {.tv_sec = ns / 1'000'000'000, .tv_nsec = ns % 1'000'000'000};
  return 0;
}

int nanosleep(const timespec* time, timespec* left) {
  const auto* kept = stage_clock();
  if (kept == nullptr) return static_cast<int>(::syscall(SYS_nanosleep, time, left));
  const std::int64_t until = *kept + time->tv_sec * 1'000'000'000 + time->tv_nsec;
  while (*kept < until) ::syscall(SYS_nanosleep, &moment, nullptr);
  return 0;
}

int poll(pollfd* wanted, nfds_t count, int timeout_ms) {
  const auto* kept = stage_clock();
  if (kept == nullptr) return static_cast<int>(::syscall(SYS_poll, wanted, count, timeout_ms));
  const std::int64_t until = *kept + std::int64_t{1'000'000} * timeout_ms;
  for (;;) {
    timespec brief = moment;
    const auto ready = static_cast<int>(::syscall(SYS_ppoll, wanted, count, &brief, nullptr, 0));
    if (ready != 0 || (timeout_ms >= 0 && *kept >= until)) return ready;
  }
}

void* mmap(void* at, size_t size, int protection, int flags, int number, off_t offset) noexcept {
  const bool fake = number >= 0 && number == camera.number;
  if (fake) flags = MAP_PRIVATE | MAP_ANONYMOUS;
  void* memory = reinterpret_cast<void*>(
      ::syscall(SYS_mmap, at, size, protection, flags, fake ? -1 : number, fake ? 0 : offset));
  if (fake) camera.buffers[static_cast<unsigned>(offset) / 4096 % max_buffers] = memory;
  return memory;
}

}  // extern "C"
