// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tuina/control/arm_controller.hpp"

namespace tuina::control {

/// Gains for arms whose motion, and so the force that comes of it, follows by `lag_s`: those that
/// take places (docs/control.md). None is 0, and these are the gains of `options` then. The damping
/// of contact rises and the trim slows down with the lag, so that the force loop keeps its distance
/// from ringing.
[[nodiscard]] ArmController::Options for_late_force(ArmController::Options options,
                                                    double lag_s) noexcept;

}  // namespace tuina::control
