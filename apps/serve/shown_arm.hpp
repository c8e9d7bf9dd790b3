// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "tuina/robot/arm_model.hpp"

namespace tuina::app {

/// To a whole number of parts: `per_unit` 1000 leaves three decimals, in few letters of JSON.
[[nodiscard]] double rounded(double value, double per_unit);

/// What a page draws of an arm, as JSON: its joints from shoulder to tool, each as x, y, z in couch
/// and the radius of what begins there, in m. A joint is as thick as the link that begins at it;
/// the last is the tool's ball.
[[nodiscard]] nlohmann::json shown_links(const robot::ArmModel& model, const JointVector& q_rad,
                                         double rail_m, const Transform& couch_from_base);

}  // namespace tuina::app
