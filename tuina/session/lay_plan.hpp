// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

#include "tuina/body/back_surface.hpp"
#include "tuina/core/acupoint.hpp"
#include "tuina/core/result.hpp"
#include "tuina/massage/plan.hpp"
#include "tuina/massage/programme.hpp"
#include "tuina/motion/ready_plan.hpp"
#include "tuina/robot/robot_model.hpp"
#include "tuina/session/config.hpp"

namespace tuina::session {

/// How the config and the therapist want a plan; `no_go_file` may be empty.
[[nodiscard]] Result<massage::PlanOptions> plan_options(const Config& config,
                                                        const std::string& no_go_file);

/// Lays a programme onto a back, for the arms of a robot that stands where its table wants it.
/// Fails as `massage::plan` and `motion::make_ready` do.
[[nodiscard]] Result<motion::ReadyPlan> lay_plan(const body::BackSurface& back,
                                                 std::span<const Acupoint> acupoints,
                                                 std::span<const Landmark> landmarks,
                                                 const massage::Programme& programme,
                                                 const robot::RobotModel& robot,
                                                 const massage::PlanOptions& options);

}  // namespace tuina::session
