// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <linux/videodev2.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <atomic>
#include <cstring>
#include <deque>
#include <mutex>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "tests/devices/fake_v4l2.hpp"

namespace tuina::tests {

/// The other end of a camera of fake_v4l2.cpp: it takes whoever opens the camera, one at a time,
/// and sends frames. Like a driver with four buffers it drops what nobody takes.
class CameraStage {
 public:
  using Bytes = std::vector<std::uint8_t>;

  CameraStage(std::string path, const v4l2::Hello& hello) : path_(std::move(path)), hello_(hello) {
    sockaddr_un address = {};
    address.sun_family = AF_UNIX;
    if (path_.size() >= sizeof address.sun_path) throw std::runtime_error("path is too long");
    std::strncpy(address.sun_path, path_.c_str(), sizeof address.sun_path - 1);
    ::unlink(path_.c_str());
    door_ = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    if (::bind(door_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 ||
        ::listen(door_, 4) != 0)
      throw std::runtime_error("cannot listen at " + path_);
    thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
  }
  ~CameraStage() {
    thread_.request_stop();
    thread_.join();
    ::close(door_);
    ::unlink(path_.c_str());
  }
  CameraStage(const CameraStage&) = delete;
  CameraStage& operator=(const CameraStage&) = delete;

  void send(const v4l2::FrameHead& head, const Bytes& bytes) {
    const std::lock_guard lock(mutex_);
    if (!taken_ || waiting_.size() >= 4) return;
    waiting_.push_back({head, bytes});
  }
  /// Nobody can open it any more, and who has it is told.
  void unplug() { unplugged_ = true; }
  [[nodiscard]] bool taken() const { return taken_; }
  /// Bytes are on their way to somebody who takes them.
  [[nodiscard]] bool pushes() const { return pushes_; }
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  struct Waiting {
    v4l2::FrameHead head;
    Bytes bytes;
  };
  bool put(int number, const void* from, std::size_t size) {
    const auto* at = static_cast<const char*>(from);
    while (size > 0) {
      pushes_ = true;
      const ssize_t sent = ::send(number, at, size, MSG_NOSIGNAL | MSG_DONTWAIT);
      if (sent < 0 && errno == EAGAIN) {
        pushes_ = false;
        pollfd wanted = {.fd = number, .events = POLLOUT, .revents = 0};
        if (::poll(&wanted, 1, 20'000) <= 0) return false;  // a busy machine
        continue;
      }
      if (sent <= 0) break;
      at += sent;
      size -= static_cast<std::size_t>(sent);
    }
    pushes_ = false;
    return size == 0;
  }
  static bool has_left(int number) {
    char nothing = 0;
    return ::recv(number, &nothing, 1, MSG_PEEK | MSG_DONTWAIT) == 0;
  }
  void run(const std::stop_token& stop) {
    while (!stop.stop_requested() && !unplugged_) {
      pollfd wanted = {.fd = door_, .events = POLLIN, .revents = 0};
      if (::poll(&wanted, 1, 20) <= 0) continue;
      const int host = ::accept4(door_, nullptr, nullptr, SOCK_CLOEXEC);
      if (host < 0) continue;
      const int room = 4 << 20;
      (void)::setsockopt(host, SOL_SOCKET, SO_SNDBUFFORCE, &room, sizeof room);
      if (put(host, &hello_, sizeof hello_)) serve(host, stop);
      ::close(host);
    }
  }
  void serve(int host, const std::stop_token& stop) {
    taken_ = true;
    while (!stop.stop_requested() && !unplugged_ && !has_left(host)) {
      Waiting next;
      {
        const std::lock_guard lock(mutex_);
        if (!waiting_.empty()) {
          next = std::move(waiting_.front());
          waiting_.pop_front();
        }
      }
      if (next.bytes.empty()) {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
        continue;
      }
      if (!put(host, &next.head, sizeof next.head) ||
          !put(host, next.bytes.data(), next.bytes.size()))
        break;
    }
    const std::lock_guard lock(mutex_);
    taken_ = false;
    waiting_.clear();
  }

  std::string path_;
  v4l2::Hello hello_;
  int door_ = -1;
  std::atomic<bool> taken_ = false, unplugged_ = false, pushes_ = false;
  std::mutex mutex_;
  std::deque<Waiting> waiting_;
  std::jthread thread_;
};

}  // namespace tuina::tests
