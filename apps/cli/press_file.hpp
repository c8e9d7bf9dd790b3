// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "tuina/core/result.hpp"
#include "tuina/tissue/press_record.hpp"

namespace CLI {
class App;
}

namespace tuina::app {

/// The record of presses that the verbs `tissue fit` and `tissue estimate` read, and what the
/// caller knows of its sensors.
struct PressFile {
  std::string path;
  double force_noise_n = std::numeric_limits<double>::quiet_NaN();  ///< NaN: read from the record
  double position_noise_mm = std::numeric_limits<double>::quiet_NaN();

  void describe(CLI::App& command);
  /// CSV with time_s, position_mm, force_n; the times must grow.
  [[nodiscard]] Result<std::vector<tissue::TimedPress>> read() const;
  [[nodiscard]] tissue::SensorNoise noise_of(const std::vector<tissue::TimedPress>& record) const;
};

}  // namespace tuina::app
