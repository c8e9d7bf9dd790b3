// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "tuina/core/result.hpp"

namespace tuina::scanner {

/// One reading of the yaw motor, quantised, on the motor's clock, which lags the camera's by the
/// calibrated latency.
struct YawReading {
  double time_s = 0.0;
  double yaw_rad = 0.0;
};

/// Interface to the motor that turns laser and camera about the yaw axis.
class Turntable {
 public:
  virtual ~Turntable() = default;
  /// Starts a continuous turn; camera frames belong to it until it has arrived.
  [[nodiscard]] virtual Result<void> sweep(double from_rad, double to_rad, double rad_per_s) = 0;
  /// Starts a stop-and-shoot turn, standing still for each frame ([thesis] chapter 4); camera
  /// frames belong to it until it has arrived.
  [[nodiscard]] virtual Result<void> step(double from_rad, double to_rad, double step_rad) = 0;
  /// All readings since the turn began, oldest first.
  [[nodiscard]] virtual Result<std::vector<YawReading>> readings() const = 0;

 protected:
  Turntable() = default;
  Turntable(const Turntable&) = default;
  Turntable& operator=(const Turntable&) = default;
};

}  // namespace tuina::scanner
