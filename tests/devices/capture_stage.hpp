// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <deque>
#include <fstream>
#include <functional>
#include <string>
#include <thread>

#include "tests/devices/camera_stage.hpp"
#include "tests/devices/firmware_board.hpp"
#include "tests/devices/stage_clock.hpp"
#include "tuina/core/image.hpp"
#include "tuina/hardware/camera_pixels.hpp"

namespace tuina::tests {

/// A scanner before which somebody shows what a script says: in a folder a camera, the board with
/// its firmware and its motor, their device file, and the time. Pictures come late, as from a real
/// camera.
class CaptureStage {
 public:
  /// The picture of the scanner's camera at that yaw, at that time, with the laser lit or dark.
  using Picture = std::function<Image(double yaw_rad, double time_s, bool lit)>;

  /// A picture is there, and stamped, `latency_s` after its exposure.
  CaptureStage(const std::string& folder, const std::string& firmware, double latency_s,
               Picture picture)
      : picture_(std::move(picture)),
        latency_s_(latency_s),
        clock_(folder),
        board_(firmware),
        camera_(folder + "/camera", hello()) {
    std::ofstream(folder + "/device.toml")
        << "[camera]\nkind = \"v4l2\"\naddress = \"" << folder
        << "/camera\"\nturned_deg = 90\nframes_per_s = 15\n"
        << "[turntable]\nkind = \"board\"\naddress = \"" << board_.address() << "\"\n";
    thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
  }
  [[nodiscard]] bool lit() const { return lit_; }
  /// While the unit stood, at once.
  [[nodiscard]] double max_lit_s() const { return max_lit_s_; }
  [[nodiscard]] double now_s() const { return clock_.now_s() - StageClock::begins_s; }
  [[nodiscard]] bool crashed() const { return crashed_; }

 private:
  struct Taken {
    double due_s = 0.0;
    CameraStage::Bytes bytes;
  };

  static v4l2::Hello hello() {
    v4l2::Hello hello;
    hello.mode_count = 1;
    hello.modes[0] = {.code = V4L2_PIX_FMT_YUYV, .width = 640, .height = 480, .frames_per_s = 15};
    return hello;
  }
  void run(const std::stop_token& stop) {
    constexpr double slice_s = 0.25e-3, frame_every_s = 1.0 / 15.0;
    constexpr auto slice = std::chrono::microseconds(60);
    auto next = std::chrono::steady_clock::now();
    double lit_s = 0.0, exposed_s = 0.0;
    for (double now_s = 0.0; !stop.stop_requested(); now_s += slice_s) {
      // Four times as fast as the world, but never ahead of a host that computes.
      next = std::max(next + slice, std::chrono::steady_clock::now());
      std::this_thread::sleep_until(next);
      while (!stop.stop_requested() && (camera_.pushes() || clock_.host_computes()))
        std::this_thread::sleep_for(std::chrono::microseconds(50));
      board_.run_to(now_s);
      lit_ = board_.lit();
      crashed_ = board_.crashed();
      const bool stands = board_.servo().speed_counts_per_s(now_s) == 0.0;
      lit_s = lit_ && stands ? lit_s + slice_s : 0.0;
      max_lit_s_ = std::max<double>(max_lit_s_, lit_s);
      if (camera_.taken() && now_s >= exposed_s + frame_every_s) {
        exposed_s = now_s;
        taken_.push_back({now_s + latency_s_, picture_at(now_s)});
      }
      if (!taken_.empty() && taken_.front().due_s <= now_s) send(now_s);
      clock_.set(StageClock::begins_s + now_s);
    }
  }
  CameraStage::Bytes picture_at(double now_s) {
    const double counts = board_.servo().at(now_s) - 512.0;
    const Image seen = picture_(counts * scanner::yaw_count_rad, now_s, lit_);
    const Image sensor = hardware::turned(seen, 270);  // the camera lies on its side
    CameraStage::Bytes bytes(2 * sensor.data.size(), 128);
    for (std::size_t k = 0; k < sensor.data.size(); ++k) bytes[2 * k] = sensor.data[k];
    return bytes;
  }
  void send(double now_s) {
    const Taken taken = std::move(taken_.front());
    taken_.pop_front();
    camera_.send({.bytes = static_cast<std::uint32_t>(taken.bytes.size()),
                  .flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC,
                  .stamp_us = static_cast<std::int64_t>(1e6 * (StageClock::begins_s + now_s))},
                 taken.bytes);
  }

  Picture picture_;
  double latency_s_;
  StageClock clock_;
  FirmwareBoard board_;
  CameraStage camera_;
  std::deque<Taken> taken_;
  std::atomic<bool> lit_ = false, crashed_ = false;
  std::atomic<double> max_lit_s_ = 0.0;
  std::jthread thread_;
};

}  // namespace tuina::tests
