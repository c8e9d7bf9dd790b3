// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "tuina/core/random.hpp"
#include "tuina/core/units.hpp"
#include "tuina/scanner/calibration.hpp"
#include "tuina/scanner/camera.hpp"
#include "tuina/scanner/turntable.hpp"

namespace tuina::tests {

/// A scanner without a world: its line wanders through small noisy pictures while the motor turns.
/// The script says what goes wrong.
class FakeScanner final : public scanner::Camera, public scanner::Turntable {
 public:
  static constexpr int frames_of_a_sweep = 24;
  static constexpr int never = std::numeric_limits<int>::max();
  struct Script {
    int silent_from = never;        ///< the camera gives no frame from this one on
    int wrong_size_at = never;      ///< this frame comes in another size
    int motor_lost_at = never;      ///< the motor does not answer once so many frames were taken
    bool never_arrives = false;     ///< the motor turns on and on
    int motor_stands_from = never;  ///< at this frame
    int same_picture_from = never;
    double skip_deg = 0.0;       ///< at the twelfth frame, with a gear that slips
    bool laser_is_dead = false;  ///< the switch of the laser does not answer
  };

  FakeScanner() = default;
  explicit FakeScanner(const Script& script) : script_(script) {}

  [[nodiscard]] Result<scanner::Frame> next_frame(double timeout_s) override {
    if (next_ >= script_.silent_from || (next_ >= frames_of_a_sweep && !script_.never_arrives))
      return fail(Fault::device, "no frame within {:.1f} s", timeout_s);
    const bool wrong = next_ == script_.wrong_size_at;
    const int shown = std::min(next_, script_.same_picture_from);
    Random random = make_random(static_cast<std::uint64_t>(shown), "little camera");
    scanner::Frame frame{
        .time_s = next_ / 30.0, .image = wrong ? Image(72, 96) : Image(96, 72), .dark = {}};
    for (int y = 0; y < frame.image.height; ++y) {
      for (int x = 0; x < frame.image.width; ++x) {
        const double u = (x - 40.0 - 0.2 * shown) / 2.0;
        frame.image.row(y)[x] = static_cast<std::uint8_t>(
            20.0 + (lit_ ? 180.0 * std::exp(-0.5 * u * u) : 0.0) + std::abs(gaussian(random, 3.0)));
      }
    }
    ++next_;
    last_lit_ = lit_ ? frame.time_s : last_lit_;
    return frame;
  }
  [[nodiscard]] Result<void> sweep(double, double, double) override {
    next_ = 0;
    return {};
  }
  [[nodiscard]] Result<void> step(double from_rad, double to_rad, double step_rad) override {
    return sweep(from_rad, to_rad, step_rad);
  }
  [[nodiscard]] Result<bool> arrived() const override {
    if (next_ >= script_.motor_lost_at) return fail(Fault::device, "the motor does not answer");
    return next_ >= frames_of_a_sweep && !script_.never_arrives;
  }
  [[nodiscard]] Result<void> switch_laser(bool on) override {
    if (script_.laser_is_dead) return fail(Fault::device, "the laser does not answer");
    lit_ = on;
    return {};
  }
  [[nodiscard]] Result<std::vector<scanner::YawReading>> readings() const override {
    std::vector<scanner::YawReading> readings;
    const double stands_s = script_.motor_stands_from / 30.0;
    for (int i = -5; i < (script_.never_arrives ? 1200 : 60); ++i) {
      const double skip_rad = i >= 20 ? from_deg(script_.skip_deg) : 0.0;
      const double counts = std::round(0.9 * std::min<double>(i, 50.0 * stands_s));
      readings.push_back({i * 0.02 + 1.0 / 3.0, from_deg(counts * (300.0 / 1024.0)) + skip_rad});
    }
    return readings;
  }
  [[nodiscard]] bool lit() const { return lit_; }
  /// Time of the last frame with the laser lit.
  [[nodiscard]] double last_lit_s() const { return last_lit_; }

 private:
  Script script_ = {};
  int next_ = 0;
  bool lit_ = false;
  double last_lit_ = 0.0;
};

[[nodiscard]] inline scanner::ScannerCalibration calibration_of_fake() {
  scanner::ScannerCalibration calibration;
  calibration.camera = {.width_px = 96,
                        .height_px = 72,
                        .fx_px = 150.0,
                        .fy_px = 150.0,
                        .cx_px = 47.5,
                        .cy_px = 35.5};
  calibration.laser_normal_in_camera = {std::sin(73.0_deg), 0.0, std::cos(73.0_deg)};
  calibration.laser_distance_m = 0.19;
  calibration.axis_point_in_camera = {0.1, 0.0, 0.0};
  calibration.latency_s = -1.0 / 3.0;
  return calibration;
}

}  // namespace tuina::tests
