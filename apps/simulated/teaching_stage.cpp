// SPDX-License-Identifier: Apache-2.0
#include "apps/simulated/teaching_stage.hpp"

#include "apps/simulated/session_order.hpp"

namespace tuina::app {

TeachingStage::TeachingStage(std::unique_ptr<sim::World> made)
    : world(std::move(made)),
      models(robot::both_models(world->robot_table(), world->mount())),
      arms{.of = {session::ControlledArm(models[Arm::left]),
                  session::ControlledArm(models[Arm::right])}} {}

Result<std::unique_ptr<TeachingStage>> TeachingStage::make(
    const sim::Person& who, const robot::RobotPlacement& placement, const robot::ReadyPose& start,
    const session::Config& config, std::uint64_t seed, const Device& device) {
  auto world = sim::World::make(who, placement, world_options(config), seed);
  if (!world) return tl::unexpected(world.error());
  std::unique_ptr<TeachingStage> stage(new TeachingStage(std::move(*world)));
  if (!device.file.empty()) {
    SessionOrder order;
    order.robot = device.robot;
    auto far = DeviceArms::open(device.file, placement, world_name(order, *stage->world, seed));
    if (!far) return tl::unexpected(far.error());
    stage->far_ = std::move(*far);
    stage->told_.emplace(stage->far_->truth(), *stage->world);
  }
  if (auto stands = stage->robot().stand_ready(start); !stands)
    return tl::unexpected(stands.error());
  if (auto armed = stage->guard().arm({.arm = placement.arm, .mount = placement.mount}); !armed)
    return tl::unexpected(armed.error());
  return stage;
}

link::Supervisor& TeachingStage::guard() {
  if (far_) return *far_;
  return own_;
}

TeachRow TeachingStage::row(Arm arm, double time_s) const {
  const sim::ArmTruth& truth = world->truth().arms[arm];
  const Vector3 ahead = truth.couch_from_tool.linear().col(0);
  return {.time_s = time_s,
          .tool_in_couch =
              truth.couch_from_tool.translation() + models[arm].table().tool_radius_m * ahead,
          .true_force_n = truth.contact.force_n};
}

}  // namespace tuina::app
