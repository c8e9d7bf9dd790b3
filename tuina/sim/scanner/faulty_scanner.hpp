// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "tuina/core/random.hpp"
#include "tuina/scanner/camera.hpp"
#include "tuina/scanner/turntable.hpp"

namespace tuina::sim {

/// What may go wrong with camera, motor and view of a scanner.
enum class ScanFault : std::uint8_t {
  none,
  frames_lost,     ///< the share `size` of them
  frames_frozen,   ///< `size` seconds of the same picture with fresh times
  frames_cut,      ///< the lower half is grey for `size` seconds
  frames_swapped,  ///< every second one comes before the one that it follows
  camera_silent,   ///< no frame any more
  blurred,         ///< over `size` pixels along the row
  lamp,            ///< `size` grey levels more in a quarter of the picture
  second_line,     ///< a reflection of the line, `size` pixels aside
  covered,         ///< a band of the share `size` of the rows is dark: a cloth, a hand
  motor_silent,    ///< the motor does not answer any more
  yaw_stuck,       ///< the motor turns on, its readings do not for `size` seconds
  yaw_skips,       ///< readings are `size` rad too large from half way on
};

struct TimedScanFault {
  ScanFault kind = ScanFault::none;
  double size = 0.0;
  double onset_s = 0.0;  ///< after the first frame
};

/// Camera and turntable of a scanner that go wrong from a time after the first frame on; all else
/// is the scanner behind them. It remembers how long the laser was lit after the fault.
class FaultyScanner final : public scanner::Camera, public scanner::Turntable {
 public:
  /// Both must outlive it.
  FaultyScanner(scanner::Camera& camera, scanner::Turntable& turntable, const TimedScanFault& fault,
                std::uint64_t seed)
      : camera_(camera),
        turntable_(turntable),
        fault_(fault),
        random_(make_random(seed, "faulty scanner")) {}

  [[nodiscard]] Result<scanner::Frame> next_frame(double timeout_s) override;
  [[nodiscard]] Result<void> sweep(double from_rad, double to_rad, double rad_per_s) override;
  [[nodiscard]] Result<void> step(double from_rad, double to_rad, double step_rad) override;
  [[nodiscard]] Result<bool> arrived() const override;
  [[nodiscard]] Result<void> switch_laser(bool on) override;
  [[nodiscard]] Result<std::vector<scanner::YawReading>> readings() const override;

  [[nodiscard]] bool lit() const { return lit_; }
  /// Between the onset and the last frame with the laser lit, s; what was waited for counts.
  [[nodiscard]] double lit_after_onset_s() const { return lit_after_onset_s_; }

 private:
  [[nodiscard]] bool acts() const {
    return fault_.kind != ScanFault::none && now_s_ >= fault_.onset_s;
  }
  [[nodiscard]] bool acts_for_size() const {
    return acts() && now_s_ < fault_.onset_s + fault_.size;
  }
  void spoil(Image& image);

  scanner::Camera& camera_;
  scanner::Turntable& turntable_;
  TimedScanFault fault_;
  Random random_;
  std::optional<double> first_s_;
  double now_s_ = 0.0;
  bool lit_ = false;
  double lit_after_onset_s_ = 0.0;
  Image frozen_;
  std::optional<scanner::Frame> held_;  // the one that comes too late
};

}  // namespace tuina::sim
