// SPDX-License-Identifier: Apache-2.0
#include "apps/simulated/devices/felt_recorder.hpp"

#include <algorithm>

namespace tuina::app {

void FeltRecorder::on_plan(const motion::ReadyPlan& plan, const Transform& base_from_couch) {
  plan_ = &plan.plan;
  last_path_ = {.of = {-1, -1}};
  couch_from_base_ = base_from_couch.inverse();
}

void FeltRecorder::on_tick(const session::Tick& tick) noexcept {
  constexpr int rows_every_ticks = 5;
  const double time_s = tick.reading.time_s;
  const bool row = ticks_++ % rows_every_ticks == 0;
  if (row) {
    const auto& arms = tick.reading.arms;
    (void)distances_.add(time_s,
                         distances_.poses({.of = {arms[Arm::left].q_rad, arms[Arm::right].q_rad}},
                                          tick.reading.rail_m),
                         tick.reading.rail_m);
  }
  for (const Arm arm : both_arms) {
    const session::ArmView& seen = tick.view[arm];
    std::optional<Technique> technique;
    if (seen.phase == session::ArmPhase::contact) {
      technique = plan_->paths[static_cast<std::size_t>(seen.path)].path.technique;
      count(time_s, arm, seen, *technique);
    }
    touching_[arm] = technique.has_value();
    if (!row) continue;
    felt_.trace.push_back({.time_s = time_s,
                           .arm = arm,
                           .technique = technique,
                           .target_n = seen.target_n,
                           .true_force_n = unknown,
                           .measured_force_n = seen.measured_n,
                           .depth_m = unknown,
                           .tool_in_couch = couch_from_base_ * seen.tool_in_base});
  }
}

void FeltRecorder::count(double time_s, Arm arm, const session::ArmView& seen,
                         Technique technique) {
  if (!touching_[arm]) touched_[arm] = {};
  touched_[arm].held.add(seen.target_n, seen.measured_n);
  touched_[arm].peak_n = std::max(touched_[arm].peak_n, seen.measured_n);
  if (seen.target_n <= 0.0) return;
  session::ForceErrorSum& sum = by_technique_[technique];
  if (seen.path != last_path_[arm]) sum.begin(), all_.begin();
  last_path_[arm] = seen.path;
  sum.add(time_s, seen.target_n, seen.measured_n);
  all_.add(time_s, seen.target_n, seen.measured_n);
}

SessionTruth FeltRecorder::finish() {
  felt_.min_arm_distance_m = distances_.min_apart_m();
  felt_.clear = distances_.clear();
  felt_.distances = distances_.take();
  felt_.force = all_.errors();
  for (const auto& [technique, sum] : by_technique_) felt_.techniques[technique] = sum.errors();
  return std::move(felt_);
}

}  // namespace tuina::app
