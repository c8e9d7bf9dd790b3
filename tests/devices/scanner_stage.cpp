// SPDX-License-Identifier: Apache-2.0
// scanner_stage FIRMWARE.elf SWEEP FROM_DEG FOLDER [FAULT FRAME]: a whole scanner but for its host,
// at real pace. FOLDER/board is the serial line of an Arduino Mega in simavr, behind which an
// AX-12A is emulated; FOLDER/camera is a camera for fake_v4l2.cpp, which shows the frames of the
// recorded sweep SWEEP, each when the motor is where it was taken, and the dark where the laser is
// off. It ends with its standard input, and leaves FOLDER/stage.json.
//
// Faults, once that frame has been shown: camera_silent, camera_unplugged, camera_repeats,
// camera_late, board_unplugged, motor_blocked, motor_silent, motor_skips, and host_killed: the
// process of FOLDER/host.
#include <poll.h>
#include <signal.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <thread>

#include "tests/devices/camera_stage.hpp"
#include "tests/devices/firmware_board.hpp"
#include "tests/devices/stage_clock.hpp"
#include "tuina/core/random.hpp"
#include "tuina/core/units.hpp"
#include "tuina/hardware/camera_pixels.hpp"
#include "tuina/scanner/recording.hpp"

using namespace tuina;
using namespace tuina::tests;

namespace {

constexpr double frame_every_s = 1.0 / 30.0;
constexpr double sweep_rad_per_s = 9.0 * 0.666_deg;

/// The pictures of a sweep as the sensor gives them, on its side, in YUYV.
std::vector<CameraStage::Bytes> pictures_of(const std::string& sweep) {
  auto recording = scanner::Recording::open(sweep);
  if (!recording) throw std::runtime_error(recording.error().message);
  std::vector<CameraStage::Bytes> all;
  for (int i = 0; i < recording->frames(); ++i) {
    auto frame = recording->next_frame(1.0);
    if (!frame) throw std::runtime_error(frame.error().message);
    const Image sensor = hardware::turned(std::move(frame->image), 270);
    CameraStage::Bytes bytes(2 * sensor.data.size(), 128);
    for (std::size_t k = 0; k < sensor.data.size(); ++k) bytes[2 * k] = sensor.data[k];
    all.push_back(std::move(bytes));
  }
  return all;
}

class Stage {
 public:
  Stage(const std::string& elf, const std::string& sweep, double sweep_from_rad, std::string folder,
        std::string fault, int fault_frame)
      : pictures_(pictures_of(sweep)),
        sweep_from_rad_(sweep_from_rad),
        folder_(std::move(folder)),
        fault_(std::move(fault)),
        fault_frame_(fault_frame),
        clock_(folder_),
        board_(elf),
        camera_(folder_ + "/camera", hello()) {
    const std::string line = folder_ + "/board";
    ::unlink(line.c_str());
    (void)!::symlink(board_.address().c_str(), line.c_str());
    dark_ = CameraStage::Bytes(pictures_.front().size(), 128);
    Random random = make_random(5, "dark frames");
    for (std::size_t k = 0; k < dark_.size(); k += 2)
      dark_[k] = static_cast<std::uint8_t>(10.0 + std::abs(gaussian(random, 4.0)));
  }
  Stage(const Stage&) = delete;
  Stage& operator=(const Stage&) = delete;

  /// Until the standard input ends.
  void run() {
    constexpr double slice_s = 0.25e-3;
    auto next = std::chrono::steady_clock::now();
    for (double now_s = 0.0;; now_s += slice_s) {
      // At the pace of the world, but never ahead of a host that computes.
      next = std::max(next + std::chrono::microseconds(250), std::chrono::steady_clock::now());
      std::this_thread::sleep_until(next);
      while (camera_.pushes() || clock_.host_computes())
        std::this_thread::sleep_for(std::chrono::microseconds(50));
      board_.run_to(now_s);
      show(now_s);
      watch_laser();
      clock_.set(StageClock::begins_s + now_s);
      if (board_.crashed()) throw std::runtime_error("the board's program has ended");
      pollfd input = {.fd = STDIN_FILENO, .events = POLLIN, .revents = 0};
      char byte = 0;
      if (::poll(&input, 1, 0) > 0 && ::read(STDIN_FILENO, &byte, 1) <= 0) break;
    }
    std::ofstream(folder_ + "/stage.json")
        << "{\"frames_shown\": " << shown_ << ", \"lit_s\": " << lit_for_s_
        << ", \"lit_after_fault_ms\": " << 1e3 * lit_after_fault_s_
        << ", \"is_lit\": " << (board_.lit() ? "true" : "false") << "}\n";
  }

 private:
  v4l2::Hello hello() const {
    v4l2::Hello hello;
    hello.mode_count = 1;
    hello.modes[0] = {.code = V4L2_PIX_FMT_YUYV, .width = 640, .height = 480};
    return hello;
  }
  void watch_laser() {
    const double now_s = board_.time_s();
    if (board_.lit()) lit_for_s_ += now_s - looked_s_;
    if (board_.lit() && fault_s_ >= 0.0) lit_after_fault_s_ = now_s - fault_s_;
    looked_s_ = now_s;
  }
  /// Exposes each picture of the sweep when the motor is where it was taken, else the dark.
  void show(double now_s) {
    const double even_counts = board_.servo().at(now_s) - 512.0;
    const double yaw_rad = even_counts * scanner::yaw_count_rad;
    const double rad_per_s = board_.servo().speed_counts_per_s(now_s) * scanner::yaw_count_rad;
    const double per_frame_rad = sweep_rad_per_s * frame_every_s;
    if (rad_per_s <= 0.0) next_ = 0;
    const bool sweeps = std::abs(rad_per_s - sweep_rad_per_s) < 1e-6;
    if (sweeps && yaw_rad < sweep_from_rad_) next_ = 0;
    // A turn that begins within the sweep has missed its first pictures.
    const double behind = (yaw_rad - sweep_from_rad_) / per_frame_rad;
    if (sweeps && behind > static_cast<double>(next_ + 1))
      next_ = static_cast<std::size_t>(behind) + 1;
    const double at_rad = sweep_from_rad_ + static_cast<double>(next_) * per_frame_rad;
    if (sweeps && next_ < pictures_.size() && yaw_rad >= at_rad) {
      const double exposed_s = now_s - (yaw_rad - at_rad) / rad_per_s;
      expose(exposed_s, board_.lit() ? pictures_[next_] : dark_);
      ++next_;
    } else if (now_s - last_exposed_s_ > 1.2 * frame_every_s) {
      expose(now_s, dark_);
    }
  }
  void expose(double exposed_s, const CameraStage::Bytes& picture) {
    last_exposed_s_ = exposed_s;
    const bool lit = &picture != &dark_;
    shown_ += lit ? 1 : 0;
    if (lit && shown_ == fault_frame_) begin_fault();
    const bool faulty = fault_s_ >= 0.0;
    if (faulty && (fault_ == "camera_silent" || (fault_ == "camera_late" && shown_ % 3 != 0)))
      return;
    if (!faulty || fault_ != "camera_repeats") before_ = &picture;
    // Sensor noise makes each dark picture another.
    if (!lit) dark_[2 * (static_cast<std::size_t>(1e3 * exposed_s) % 1000)] ^= 1;
    camera_.send({.bytes = static_cast<std::uint32_t>(before_->size()),
                  .flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC,
                  .stamp_us = static_cast<std::int64_t>(1e6 * (StageClock::begins_s + exposed_s))},
                 *before_);
  }
  void begin_fault() {
    fault_s_ = board_.time_s();
    if (fault_ == "camera_unplugged") camera_.unplug();
    if (fault_ == "board_unplugged") board_.unplug();
    if (fault_ == "motor_blocked") board_.servo().block(fault_s_);
    if (fault_ == "motor_silent") board_.motor_silent = true;
    if (fault_ == "host_killed") {
      if (clock_.host() > 1) ::kill(static_cast<pid_t>(clock_.host()), SIGKILL);
    }
    if (fault_ == "motor_skips") board_.servo().skip_counts = 2.0_deg / scanner::yaw_count_rad;
  }

  std::vector<CameraStage::Bytes> pictures_;
  double sweep_from_rad_;
  CameraStage::Bytes dark_;
  std::string folder_, fault_;
  int fault_frame_;
  StageClock clock_;
  FirmwareBoard board_;
  CameraStage camera_;
  double last_exposed_s_ = -1.0, looked_s_ = 0.0, lit_for_s_ = 0.0;
  double fault_s_ = -1.0, lit_after_fault_s_ = 0.0;
  std::size_t next_ = 0;
  int shown_ = 0;
  const CameraStage::Bytes* before_ = &dark_;
};

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 5 && argc != 7) {
    std::fputs("scanner_stage FIRMWARE.elf SWEEP FROM_DEG FOLDER [FAULT FRAME]\n", stderr);
    return 1;
  }
  Stage stage(argv[1], argv[2], from_deg(std::stod(argv[3])), argv[4], argc == 7 ? argv[5] : "",
              argc == 7 ? std::stoi(argv[6]) : 0);
  stage.run();
  return 0;
} catch (const std::exception& fault) {
  std::fprintf(stderr, "scanner_stage: %s\n", fault.what());
  return 1;
}
