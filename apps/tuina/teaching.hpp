// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/tuina/command_line.hpp"
#include "tuina/core/contact.hpp"
#include "tuina/session/config.hpp"
#include "tuina/session/taught_motion.hpp"

namespace tuina::app {

/// What a simulated masseur shows to an arm.
struct TeachOrder {
  std::string person = "phantom:medium";
  Position position = Position::sitting;
  Technique technique = Technique::stroke;  ///< of the programme `relax`, its first on that side
  Arm arm = Arm::left;
};

/// A millisecond in which the tool was led or played, as it truly was.
struct TeachRow {
  double time_s = 0.0;
  Vector3 tool_in_couch = Vector3::Zero();  ///< foremost point
  double true_force_n = 0.0;
};

struct TaughtByHand {
  session::TaughtMotion motion;  ///< smoothed
  std::vector<TeachRow> truth;   ///< while it was led
  double peak_hand_n = 0.0;      ///< that the hand needed
};

/// The arm in lead-through, a hand that leads it through the air, over the skin and home again.
[[nodiscard]] Result<TaughtByHand> record_by_hand(const TeachOrder& order,
                                                  const session::Config& config,
                                                  const CommonOptions& common);

struct PlayedMotion {
  std::vector<TeachRow> truth;
  double tracking_rms_m = 0.0;  ///< the tool from where the taught joints would have it
  double force_rmse_n = 0.0;    ///< true force against what was felt when it was taught, in contact
  double peak_n = 0.0;
  double contact_s = 0.0;
  std::optional<std::string> stop;  ///< why the guard ended it
};

/// Joint impedance along a taught motion, under the guard; the arm begins where the motion does.
[[nodiscard]] Result<PlayedMotion> play_motion(const session::TaughtMotion& motion,
                                               const std::string& person,
                                               const session::Config& config,
                                               const CommonOptions& common);

}  // namespace tuina::app
