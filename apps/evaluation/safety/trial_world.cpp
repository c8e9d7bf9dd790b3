// SPDX-License-Identifier: Apache-2.0
#include "apps/evaluation/safety/trial_world.hpp"

#include <algorithm>

#include "tuina/core/units.hpp"
#include "tuina/robot/elbow_turn.hpp"

namespace tuina::app {
namespace {

constexpr double beside_m = 5_mm;  // where other tissue begins

/// The arm above its place, its elbow turned as far as the trial wants it.
JointVector start_rad(const TrialPlan& plan) {
  constexpr double tolerated_rad = 0.35;  // by a session, of a joint
  const Site& site = *plan.site;
  if (plan.elbow == 0.0) return site.above_rad;
  const robot::ArmModel model(robot::thesis_arm(), site.mount, site.arm);
  const auto turned = robot::turn_elbow(model, site.rail_m, site.above_rad);
  const auto off_rad = [&](const JointVector& q_rad) {
    return (q_rad - site.above_rad).cwiseAbs().maxCoeff();
  };
  const auto planned = std::min_element(turned.begin(), turned.end(),
                                        [&](auto& a, auto& b) { return off_rad(a) < off_rad(b); });
  JointVector best_rad = site.above_rad;
  const double wanted_rad = tolerated_rad * std::abs(plan.elbow);
  for (auto one = plan.elbow > 0.0 ? planned : turned.begin();
       one != (plan.elbow > 0.0 ? turned.end() : planned); ++one) {
    const double off = off_rad(*one);
    if (off <= wanted_rad && off > off_rad(best_rad)) best_rad = *one;
  }
  return best_rad;
}

}  // namespace

Stage first_stage(const TrialPlan& plan) {
  return plan.whole ? Stage::idle : std::min(plan.stage, Stage::approach);
}

sim::BackContact skin_of(const TrialPlan& plan) {
  const Site& site = *plan.site;
  const auto scaled = [&](TangentTissue tissue) {
    tissue.alpha_n *= plan.alpha_scale;
    tissue.beta_per_m *= plan.beta_scale;
    return tissue;
  };
  std::vector<TangentTissue> tissues(site.skin_in_couch.vertices.size(), scaled(site.tissue));
  sim::ContactOptions options{.torso_n_per_m = site.world.torso_n_per_m,
                              .friction = site.world.skin_friction,
                              .breathing = site.world.breathing,
                              .living = site.world.living,
                              .seed = plan.seed};
  for (const Onset& onset : plan.onsets) {
    const Injection& injection = onset.fault->injection;
    if (injection.breathing.amplitude_m > 0.0) {
      options.breathing.amplitude_m = onset.severity * injection.breathing.amplitude_m;
      options.breathing.frequency_hz = injection.breathing.frequency_hz;
    }
    for (std::size_t i = 0; i < tissues.size(); ++i) {
      const Vector3 from_place = site.skin_in_couch.vertices[i] - site.at_in_couch;
      if (from_place.dot(site.along_in_couch) < beside_m) continue;
      if (injection.bone_beside) tissues[i] = scaled(site.bone);
      tissues[i].alpha_n *= injection.harder;
    }
  }
  return {site.skin_in_couch, std::move(tissues), options};
}

Result<std::unique_ptr<sim::Plant>> plant_of(const TrialPlan& plan, sim::BackContact& skin,
                                             Random& random) {
  const Site& site = *plan.site;
  PerArm<robot::ArmTable> arms;
  for (const Arm arm : both_arms)
    arms[arm] = sim::draw_arm(robot::thesis_arm(),
                              {.friction_scale = plan.friction_scale,
                               .tool_mass_share = site.world.arm_errors.tool_mass_share},
                              random);
  robot::ArmTable& works = arms[site.arm];
  for (const Onset& onset : plan.onsets) {
    works.tool_mass_kg += onset.fault->injection.tool_kg;
    works.links[static_cast<std::size_t>(works.joints - 1)].mass_kg +=
        onset.fault->injection.tool_kg;
  }
  sim::Plant::Start start{.q_rad = site.ready_rad, .rail_m = site.rail_m};
  const bool above = first_stage(plan) == Stage::approach;
  start.q_rad[site.arm] = above ? start_rad(plan) : site.aside_rad;
  return sim::Plant::make(site.mount, arms, start, &skin,
                          {.seed = plan.seed, .flaws = site.world.devices.flaws});
}

}  // namespace tuina::app
