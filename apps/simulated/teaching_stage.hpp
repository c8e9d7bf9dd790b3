// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "apps/simulated/guarded_arm.hpp"
#include "tuina/motion/arm_separation.hpp"
#include "tuina/robot/robot_model.hpp"
#include "tuina/session/config.hpp"
#include "tuina/sim/person/person.hpp"
#include "tuina/sim/person/tissue_map.hpp"
#include "tuina/sim/robot/plant.hpp"

namespace tuina::app {

/// A millisecond in which the tool was led or played, as it truly was.
struct TeachRow {
  double time_s = 0.0;
  Vector3 tool_in_couch = Vector3::Zero();  ///< foremost point
  double true_force_n = 0.0;
};

/// A robot before a person, with the errors between it and its table that the seed draws.
struct TeachingStage {
  static constexpr double tick_s = 1e-3;

  robot::RobotPlacement robot;
  robot::RobotMount mount;
  PerArm<robot::ArmModel> models;
  sim::BackContact person;
  std::unique_ptr<sim::Plant> plant;
  motion::ArmSeparation separation;
  PerArm<GuardedArm> arms;  // they look at `models`

  TeachingStage(const sim::Person& who, const robot::RobotPlacement& placement,
                const session::Config& config, std::uint64_t seed)
      : robot(placement),
        mount(placement.mount),
        models(robot::both_models(placement.arm, mount)),
        person(who.skin_in_couch, sim::lay_tissue(who, seed),
               {.torso_n_per_m = 1e3 * config.simulation.torso_n_per_mm,
                .breathing = {.amplitude_m = from_mm(config.simulation.breathing_mm),
                              .frequency_hz = config.simulation.breathing_hz}}),
        separation(models),
        arms{.of = {GuardedArm(models[Arm::left], {}), GuardedArm(models[Arm::right], {})}} {}
  TeachingStage(const TeachingStage&) = delete;
  TeachingStage& operator=(const TeachingStage&) = delete;

  [[nodiscard]] static Result<std::unique_ptr<TeachingStage>> make(
      const sim::Person& who, const robot::RobotPlacement& placement,
      const sim::Plant::Start& start, const session::Config& config, std::uint64_t seed) {
    auto stage = std::make_unique<TeachingStage>(who, placement, config, seed);
    Random errors = make_random(seed, "true arms");
    PerArm<robot::ArmTable> tables;
    for (const Arm arm : both_arms) {
      tables[arm] =
          sim::draw_arm(placement.arm, {.friction_scale = config.simulation.friction}, errors);
    }
    auto plant = sim::Plant::make(placement, tables, start, &stage->person, {.seed = seed});
    if (!plant) return tl::unexpected(plant.error());
    stage->plant = std::move(*plant);
    return stage;
  }

  [[nodiscard]] TeachRow row(Arm arm, double time_s) const {
    const sim::ArmTruth& truth = plant->truth().arms[arm];
    const Vector3 ahead = truth.couch_from_tool.linear().col(0);
    return {.time_s = time_s,
            .tool_in_couch =
                truth.couch_from_tool.translation() + models[arm].table().tool_radius_m * ahead,
            .true_force_n = truth.contact.force_n};
  }
};

}  // namespace tuina::app
