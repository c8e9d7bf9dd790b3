// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "tuina/core/result.hpp"
#include "tuina/core/units.hpp"

namespace tuina::scanner {

/// Resolution of the yaw motor, an AX-12A.
constexpr double yaw_count_rad = from_deg(300.0 / 1024.0);

/// One reading of the yaw motor, quantised, on the motor's clock, which lags the camera's by the
/// calibrated latency.
struct YawReading {
  double time_s = 0.0;
  double yaw_rad = 0.0;
};

/// The interface to the unit that carries laser and camera: its yaw motor and the laser's switch.
class Turntable {
 public:
  virtual ~Turntable() = default;
  /// Starts one continuous turn; frames of the camera belong to it until `arrived`. Fails with
  /// Fault::device when the unit does not answer or cannot turn so.
  [[nodiscard]] virtual Result<void> sweep(double from_rad, double to_rad, double rad_per_s) = 0;
  /// Starts a turn in steps, the unit standing still while each frame is taken ("stop and shoot",
  /// [thesis] chapter 4); frames of the camera belong to it until `arrived`.
  [[nodiscard]] virtual Result<void> step(double from_rad, double to_rad, double step_rad) = 0;
  /// True once the turn that was started last is over, which ends the sweep. Fault::device when the
  /// motor does not answer.
  [[nodiscard]] virtual Result<bool> arrived() const = 0;
  /// Lights the laser or darkens it; a scan lights it for its own time only.
  [[nodiscard]] virtual Result<void> switch_laser(bool on) = 0;
  /// All readings since the turn began, oldest first.
  [[nodiscard]] virtual Result<std::vector<YawReading>> readings() const = 0;

 protected:
  Turntable() = default;
  Turntable(const Turntable&) = default;
  Turntable& operator=(const Turntable&) = default;
};

}  // namespace tuina::scanner
