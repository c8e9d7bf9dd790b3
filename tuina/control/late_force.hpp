// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tuina/control/arm_controller.hpp"

namespace tuina::control {

/// Gains for arms that take places (docs/position_arms.md): their motion, and so the force, follows
/// by `lag_s`. At 0 they are those of `options`. The damping of contact rises and the trim slows
/// down with the lag, so that the force loop keeps its distance from ringing.
[[nodiscard]] ArmController::Options for_late_force(ArmController::Options options,
                                                    double lag_s) noexcept;

}  // namespace tuina::control
