// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "apps/simulated/session_order.hpp"
#include "tuina/session/control_loop.hpp"
#include "tuina/session/controlled_arm.hpp"
#include "tuina/sim/world.hpp"

namespace tuina::app {

/// A millisecond in which the tool was led or played, as it truly was.
struct TeachRow {
  double time_s = 0.0;
  Vector3 tool_in_couch = Vector3::Zero();  ///< tip of the tool
  double true_force_n = 0.0;
};

/// A guarded robot before a person, for motions that a hand shows.
struct TeachingStage {
  std::unique_ptr<sim::World> world;
  PerArm<robot::ArmModel> models;
  safety::RobotGuard guard;
  PerArm<session::ControlledArm> arms;  // they look at `models`

  explicit TeachingStage(std::unique_ptr<sim::World> made)
      : world(std::move(made)),
        models(robot::both_models(world->robot_table(), world->mount())),
        guard(models, {}),
        arms{.of = {session::ControlledArm(models[Arm::left]),
                    session::ControlledArm(models[Arm::right])}} {}
  TeachingStage(const TeachingStage&) = delete;
  TeachingStage& operator=(const TeachingStage&) = delete;

  [[nodiscard]] static Result<std::unique_ptr<TeachingStage>> make(
      const sim::Person& who, const robot::RobotPlacement& placement, const robot::ReadyPose& start,
      const session::Config& config, std::uint64_t seed) {
    auto world = sim::World::make(who, placement, world_options(config), seed);
    if (!world) return tl::unexpected(world.error());
    if (auto stands = (*world)->robot().stand_ready(start); !stands)
      return tl::unexpected(stands.error());
    return std::make_unique<TeachingStage>(std::move(*world));
  }

  [[nodiscard]] const robot::RobotMount& mount() const { return world->mount(); }
  [[nodiscard]] TeachRow row(Arm arm, double time_s) const {
    const sim::ArmTruth& truth = world->truth().arms[arm];
    const Vector3 ahead = truth.couch_from_tool.linear().col(0);
    return {.time_s = time_s,
            .tool_in_couch =
                truth.couch_from_tool.translation() + models[arm].table().tool_radius_m * ahead,
            .true_force_n = truth.contact.force_n};
  }
};

}  // namespace tuina::app
