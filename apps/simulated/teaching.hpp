// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "apps/cli/command_line.hpp"
#include "apps/simulated/teaching_stage.hpp"
#include "tuina/core/contact.hpp"
#include "tuina/session/config.hpp"
#include "tuina/session/taught_motion.hpp"

namespace tuina::app {

/// What a simulated masseur shows to an arm.
struct TeachOrder {
  std::string person = "phantom:medium";
  std::string robot = "thesis";  ///< a shipped robot or the file of its table
  BodyPosture position = BodyPosture::sitting;
  Technique technique = Technique::stroke;  ///< shown as the first of `relax` on that side
  Arm arm = Arm::left;
};

struct TaughtByHand {
  session::TaughtMotion motion;  ///< smoothed
  std::vector<TeachRow> truth;   ///< while it was led
  double peak_hand_n = 0.0;      ///< largest force that the hand needed
};

/// The arm in lead-through, a hand that leads it through the air, over the skin and home again.
[[nodiscard]] Result<TaughtByHand> record_by_hand(const TeachOrder& order,
                                                  const session::Config& config,
                                                  const CommonOptions& common);

}  // namespace tuina::app
