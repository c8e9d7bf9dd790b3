// SPDX-License-Identifier: Apache-2.0
#include "tuina/session/lay_plan.hpp"

#include "tuina/core/units.hpp"
#include "tuina/session/run.hpp"

namespace tuina::session {

Result<massage::PlanOptions> plan_options(const Config& config, const std::string& no_go_file) {
  massage::PlanOptions options{.force_scale = config.massage.force_scale,
                               .force_ceiling_n = config.safety.force_ceiling_n,
                               .transfers = {.standoff_m = from_mm(config.massage.standoff_mm)}};
  if (no_go_file.empty()) return options;
  auto no_go = massage::read_no_go(no_go_file);
  if (!no_go) return tl::unexpected(no_go.error());
  options.no_go = std::move(*no_go);
  return options;
}

Result<motion::ReadyPlan> lay_plan(const body::BackSurface& back,
                                   std::span<const Acupoint> acupoints,
                                   std::span<const Landmark> landmarks,
                                   const massage::Programme& programme,
                                   const robot::RobotModel& robot,
                                   const massage::PlanOptions& options) {
  auto plan = massage::plan(back, acupoints, landmarks, programme, options);
  if (!plan) return tl::unexpected(plan.error());
  const robot::RobotPlacement placement =
      robot::place_robot(robot, back.position(), head_at_plus_y(acupoints));
  const robot::RobotMount& mount = placement.mount;
  return motion::make_ready(std::move(*plan), back, mount, robot::both_models(placement.arm, mount),
                            mount.base_from_couch, options.transfers.standoff_m);
}

}  // namespace tuina::session
