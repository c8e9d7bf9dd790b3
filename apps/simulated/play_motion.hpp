// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/cli/command_line.hpp"
#include "apps/simulated/teaching_stage.hpp"
#include "tuina/session/taught_motion.hpp"

namespace tuina::app {

struct PlayedMotion {
  std::vector<TeachRow> truth;
  double tracking_rms_m = 0.0;  ///< the tool from where the taught joints would have it
  /// True force against what was felt when it was taught, in contact; NaN where none was felt.
  double force_rmse_n = 0.0;
  double peak_n = 0.0;
  double contact_s = 0.0;
  std::optional<std::string> stop;  ///< why the guard ended it
  /// The force in words.
  [[nodiscard]] std::string force() const;
};

/// Joint impedance along a taught motion, under the guard; the arm begins where the motion does. It
/// is one of a device file, or simulated in this program.
[[nodiscard]] Result<PlayedMotion> play_motion(const session::TaughtMotion& motion,
                                               const std::string& person,
                                               const session::Config& config,
                                               const CommonOptions& common,
                                               const std::string& device = {});

}  // namespace tuina::app
