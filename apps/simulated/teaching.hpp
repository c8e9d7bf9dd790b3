// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "apps/cli/command_line.hpp"
#include "apps/simulated/leading_hand.hpp"
#include "apps/simulated/teaching_stage.hpp"
#include "tuina/session/config.hpp"
#include "tuina/session/taught_motion.hpp"

namespace tuina::app {

struct TaughtByHand {
  session::TaughtMotion motion;  ///< smoothed
  std::vector<TeachRow> truth;   ///< while it was led
  /// Largest force that the hand needed; nothing where another program has the hand.
  std::optional<double> peak_hand_n;
  bool asked_to_end = false;  ///< before the hand was done
};

/// The arm in lead-through, a hand that leads it through the air, over the skin and home again. The
/// arms of a device file have their hand with them, `tuina robot armlink --hand`.
[[nodiscard]] Result<TaughtByHand> record_by_hand(const TeachOrder& order,
                                                  const session::Config& config,
                                                  const CommonOptions& common);

}  // namespace tuina::app
