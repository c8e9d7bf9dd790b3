// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "apps/cli/options.hpp"
#include "tuina/core/result.hpp"
#include "tuina/core/units.hpp"
#include "tuina/tissue/press_record.hpp"

namespace tuina::app {

/// CSV with time_s, position_mm, force_n; the times must grow. With `force_may_lack` a force is NaN
/// where its cell is empty.
[[nodiscard]] Result<std::vector<tissue::TimedPress>> read_presses(const std::string& path,
                                                                   bool force_may_lack = false);

/// The record of presses that the verbs `tissue fit` and `tissue estimate` read, and what the
/// caller knows of its sensors.
struct PressFile {
  std::string path;
  double force_noise_n = std::numeric_limits<double>::quiet_NaN();  ///< NaN: read from the record
  double position_noise_mm = std::numeric_limits<double>::quiet_NaN();

  void describe(Options& options);
  [[nodiscard]] tissue::KnownNoise known_noise() const {
    return {.force_n = force_noise_n, .position_m = from_mm(position_noise_mm)};
  }
};

}  // namespace tuina::app
