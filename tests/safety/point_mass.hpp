// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/safety/scene.hpp"

namespace tuina::safety {

/// A guarded tool of 3 kg, as an arm is felt at its tool, that moves along one tilted line only and
/// presses on a spring of 8000 N/m and 40 N s/m, firm muscle, with a controller that is a spring of
/// 1000 N/m.
struct PointMass : private Scene {
  double skin_m = 0.0;   ///< where the skin is when nobody presses, along the outward normal
  double tool_m = 0.01;  ///< likewise, from the same origin
  double speed_m_per_s = 0.0;
  using Scene::verdict;

  PointMass() { sensor_alive = false; }

  [[nodiscard]] double contact_n() const {
    const double depth_m = skin_m - tool_m;
    return depth_m > 0.0 ? std::max(0.0, 8000.0 * depth_m - 40.0 * speed_m_per_s) : 0.0;
  }
  [[nodiscard]] double guarded_n() const { return outward_n(); }
  [[nodiscard]] double way_out_m() const { return tool_m - left_at_m_; }

  /// One millisecond.
  void step() {
    seen.tick += 1;
    seen.time_s += 1e-3;
    seen.wrench_time_s = seen.time_s - 1e-3;
    seen.tool_in_base = tool_m * normal();
    seen.tool_velocity_m_per_s = speed_m_per_s * normal();
    seen.force_in_base_n = (felt_n_ + 1e-9 * static_cast<double>(seen.tick % 2)) * normal();
    const double pull_n = -press_n_ - 1000.0 * (tool_m - target_m_) - 80.0 * speed_m_per_s;
    proposal.virtual_target_in_base = target_m_ * normal();
    proposal.torque_nm = torque_of(std::clamp(pull_n, -press_n_, press_n_) * normal());
    verdict = guard.check(seen, proposal);
    felt_n_ = contact_n();
    for (int part = 0; part < 10; ++part) {
      speed_m_per_s += 1e-4 * (guarded_n() + contact_n()) / 3.0;
      tool_m += 1e-4 * speed_m_per_s;
    }
    if (verdict.action < Action::freeze) left_at_m_ = tool_m;
  }
  void press(double duration_s, double strength_n = 20.0) {
    press_n_ = strength_n;
    target_m_ = tool_m = -strength_n / 8000.0;
    felt_n_ = contact_n();
    for (double time_s = 0.0; time_s < duration_s; time_s += 1e-3) step();
    REQUIRE(verdict.action <= Action::warn);
  }
  void ask_to_leave() {
    proposal.set_force_n = 46.0;
    step();
    proposal.set_force_n = 20.0;
  }
  void skip_ticks(int ticks) {
    miss(ticks);
    step();
  }
  void comply() {
    guard.stop(Action::comply, Cause::tool_too_fast);
    step();
  }

 private:
  double target_m_ = 0.01;
  double press_n_ = 0.0;
  double felt_n_ = 0.0;
  double left_at_m_ = 0.0;
};

}  // namespace tuina::safety
