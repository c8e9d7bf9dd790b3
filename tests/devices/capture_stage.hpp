// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fcntl.h>
#include <sys/mman.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <new>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "tests/devices/camera_stage.hpp"
#include "tests/hardware/scripted_board.hpp"
#include "tuina/hardware/camera_pixels.hpp"
#include "tuina/scanner/calibration.hpp"

namespace tuina::tests {

/// The clock of a stage, which a host under fake_v4l2.cpp goes by, too.
class StageClock {
 public:
  explicit StageClock(const std::string& path) {
    const int file = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
    if (file < 0 || ::ftruncate(file, bytes) != 0) throw std::runtime_error("cannot write " + path);
    void* page = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    ::close(file);
    if (page == MAP_FAILED) throw std::runtime_error("cannot map " + path);
    time_ns_ = new (page) std::atomic<std::int64_t>(1'000'000'000'000);
  }
  StageClock(const StageClock&) = delete;
  StageClock& operator=(const StageClock&) = delete;
  ~StageClock() { ::munmap(time_ns_, bytes); }
  [[nodiscard]] double now_s() const { return 1e-9 * static_cast<double>(time_ns_->load()); }
  void pass(std::int64_t by_ns) { *time_ns_ += by_ns; }

 private:
  static constexpr std::size_t bytes = 4096;
  std::atomic<std::int64_t>* time_ns_;
};

/// A scanner before which somebody shows what a script says: camera and board of the devices' own
/// kinds in a folder, and the time, which waits for a host that computes. What the host has told
/// its user stands in FOLDER/err, and who it is in FOLDER/host.
class CaptureStage {
 public:
  /// The picture of the scanner's camera at that yaw, at that time, with the laser lit or dark.
  using Picture = std::function<Image(double yaw_rad, double time_s, bool lit)>;

  CaptureStage(std::string folder, Picture picture)
      : folder_(std::move(folder)),
        picture_(std::move(picture)),
        clock_(folder_ + "/clock"),
        board_({.clock = [this] { return clock_.now_s(); }}),
        camera_(folder_ + "/camera", hello()) {
    std::ofstream(folder_ + "/device.toml") << "[camera]\nkind = \"v4l2\"\naddress = \"" << folder_
                                            << "/camera\"\nturned_deg = 90\nframes_per_s = "
                                               "15\n[turntable]\nkind = \"board\"\naddress = \""
                                            << board_.device().address << "\"\n";
    thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
  }
  /// After the host has ended.
  [[nodiscard]] bool lit() const { return board_.lit(); }
  /// While the unit stood, at once.
  [[nodiscard]] double max_lit_s() const { return max_lit_s_; }

 private:
  static v4l2::Hello hello() {
    v4l2::Hello hello;
    hello.mode_count = 1;
    hello.modes[0] = {.code = V4L2_PIX_FMT_YUYV, .width = 640, .height = 480, .frames_per_s = 15};
    return hello;
  }
  /// Whether a thread of the host runs or could.
  bool host_computes() {
    if (host_ == 0) std::ifstream(folder_ + "/host") >> host_;
    std::error_code gone;
    const std::filesystem::path tasks = "/proc/" + std::to_string(host_) + "/task";
    if (host_ == 0 || !std::filesystem::exists(tasks, gone)) return false;
    for (const auto& thread : std::filesystem::directory_iterator(tasks, gone)) {
      std::string text;
      std::getline(std::ifstream(thread.path() / "stat"), text);
      const std::size_t name_end = text.rfind(") ");
      if (name_end == std::string::npos) continue;
      const char state = text[name_end + 2];
      if (state == 'R' || state == 'D') return true;
    }
    return false;
  }
  void run(const std::stop_token& stop) {
    constexpr std::int64_t slice_ns = 500'000;
    constexpr double frame_every_s = 1.0 / 15.0;
    auto next = std::chrono::steady_clock::now();
    double lit_s = 0.0, shown_s = 0.0;
    while (!stop.stop_requested()) {
      // At the pace of the world, but never ahead of a host that computes.
      next = std::max(next + std::chrono::nanoseconds(slice_ns), std::chrono::steady_clock::now());
      std::this_thread::sleep_until(next);
      while (!stop.stop_requested() && (camera_.pushes() || host_computes()))
        std::this_thread::sleep_for(std::chrono::microseconds(50));
      clock_.pass(slice_ns);
      const bool stands = board_.servo().speed_counts_per_s(clock_.now_s()) == 0.0;
      lit_s = board_.lit() && stands ? lit_s + 1e-9 * slice_ns : 0.0;
      max_lit_s_ = std::max<double>(max_lit_s_, lit_s);
      if (!camera_.taken() || clock_.now_s() < shown_s + frame_every_s) continue;
      shown_s = clock_.now_s();
      show(shown_s);
    }
  }
  void show(double time_s) {
    const double counts = board_.servo().at(time_s) - 512.0;
    const Image seen = picture_(counts * scanner::yaw_count_rad, time_s, board_.lit());
    const Image sensor = hardware::turned(seen, 270);  // the camera lies on its side
    CameraStage::Bytes bytes(2 * sensor.data.size(), 128);
    for (std::size_t k = 0; k < sensor.data.size(); ++k) bytes[2 * k] = sensor.data[k];
    camera_.send({.bytes = static_cast<std::uint32_t>(bytes.size()),
                  .flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC,
                  .stamp_us = static_cast<std::int64_t>(1e6 * time_s)},
                 bytes);
  }

  std::string folder_;
  Picture picture_;
  StageClock clock_;
  ScriptedBoard board_;
  CameraStage camera_;
  long host_ = 0;
  std::atomic<double> max_lit_s_ = 0.0;
  std::jthread thread_;
};

}  // namespace tuina::tests
