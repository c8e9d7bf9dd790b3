// SPDX-License-Identifier: Apache-2.0
#include "apps/simulated/teaching_stage.hpp"

#include "apps/simulated/session_order.hpp"
#include "tuina/session/guarded_field.hpp"

namespace tuina::app {
namespace {

/// What a scan shows of the person: the guard knows the places by it, whatever a file says of them.
Result<safety::ZoneField> field_of(const sim::Person& who, const Transform& base_from_couch) {
  PointCloud skin_in_couch;
  skin_in_couch.points = who.skin_in_couch.vertices;
  const auto back = body::fit_back(skin_in_couch, {.position = who.position});
  if (!back) return tl::unexpected(back.error());
  return session::zone_field(*back, who.acupoints, who.landmarks, {}, base_from_couch);
}

}  // namespace

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
  auto field = field_of(who, placement.mount.base_from_couch);
  if (!field) return tl::unexpected(field.error());
  const auto armed = stage->guard().arm(
      {.arm = placement.arm, .mount = placement.mount, .options = {.field = std::move(*field)}});
  if (!armed) return tl::unexpected(armed.error());
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
