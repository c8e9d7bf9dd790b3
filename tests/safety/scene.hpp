// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "tests/safety/standing_arm.hpp"

namespace tuina::safety {

inline constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
inline constexpr double infinity = std::numeric_limits<double>::infinity();

/// An arm that stands still and presses tilted skin with 20 N, all sensors well; tests spoil one
/// thing.
struct Scene {
  Observation seen = standing_arm();
  Proposal proposal = pressing(seen);
  Guard guard;
  double force_n = 20.0;
  double noise_n = 1e-9;  ///< no sensor says the same twice to the last bit
  double sensor_lag_s = 1e-3;
  bool sensor_alive = true;
  Vector3 pushed_along;  ///< where the body pushes the tool; unit
  Verdict verdict;

  explicit Scene(const Guard::Options& options = six_joints())
      : guard(options), pushed_along(normal()) {}

  [[nodiscard]] const Vector3& normal() const { return proposal.normal_in_base; }
  /// Skin that faces another way.
  void face(const Vector3& normal) {
    proposal.normal_in_base = pushed_along = normal;
    proposal.virtual_target_in_base = seen.tool_in_base - 0.02 * normal;
  }
  [[nodiscard]] JointVector torque_of(const Vector3& force) const {
    return seen.gravity_nm + seen.jacobian.transpose() * force;
  }
  /// The force on the tool that the allowed torques stand for.
  [[nodiscard]] Vector3 allowed_n() const {
    return (verdict.allowed_nm - seen.gravity_nm).head<3>() / 0.2;
  }
  [[nodiscard]] double outward_n() const { return allowed_n().dot(normal()); }

  /// The controller wants the arm to push its tool with this force.
  void pull(const Vector3& force) { proposal.torque_nm = torque_of(force); }
  /// Likewise, by 4 N more in each tick, as suddenly as torques may press.
  void lean(const Vector3& force) {
    const JointVector from_nm = proposal.torque_nm, change_nm = torque_of(force) - from_nm;
    const int ticks = static_cast<int>(std::ceil(change_nm.norm() / (0.2 * 4.0)));
    for (int i = 1; i <= ticks; ++i) {
      proposal.torque_nm = from_nm + change_nm * i / ticks;
      tick();
    }
  }

  /// One tick at a time of its own.
  const Verdict& tick_at(double time_s) {
    seen.tick += 1;
    seen.time_s = time_s;
    if (sensor_alive) seen.wrench_time_s = time_s - sensor_lag_s;
    seen.force_in_base_n = (force_n - noise_n * static_cast<double>(seen.tick % 2)) * pushed_along;
    seen.q_rad += 1e-3 * seen.dq_rad_per_s;
    return verdict = guard.check(seen, proposal);
  }
  const Verdict& tick(int ticks = 1) {
    for (int i = 0; i < ticks; ++i) tick_at(seen.time_s + 1e-3);
    return verdict;
  }
  /// How many ticks pass before the guard does more than warn, at most `limit`.
  int ticks_until_it_acts(int limit = 1000) {
    for (int i = 0; i < limit; ++i) {
      if (tick().action >= Action::freeze) return i;
    }
    return limit;
  }

  /// The next tick comes after so many that did not.
  void miss(int ticks) {
    seen.tick += static_cast<std::uint64_t>(ticks);
    seen.time_s += 1e-3 * ticks;
    seen.q_rad += 1e-3 * ticks * seen.dq_rad_per_s;
  }

  void freeze() {
    miss(3);
    tick();
    REQUIRE(verdict.action == Action::freeze);
  }
  /// Of an arm whose joints are known.
  void comply() {
    guard.stop(Action::comply, Cause::tool_too_fast);
    tick();
    REQUIRE(verdict.action == Action::comply);
  }
  void retract() {
    proposal.set_force_n = 46.0;
    tick();
    proposal.set_force_n = 20.0;
    REQUIRE(verdict.action == Action::retract);
  }
};

inline void check_same(const Vector3& a, const Vector3& b) {
  INFO("(", a.x(), ", ", a.y(), ", ", a.z(), ") and (", b.x(), ", ", b.y(), ", ", b.z(), ")");
  CHECK((a - b).norm() < 1e-6);
}

/// A retreat from skin that faces up and pushes the tool with that force.
inline Scene retreating(double felt_n) {
  Scene scene;
  scene.face(Vector3::UnitZ());
  scene.noise_n = 0.0;
  scene.force_n = felt_n;
  scene.proposal.virtual_target_in_base = scene.seen.tool_in_base;
  scene.tick(10);
  scene.retract();
  return scene;
}

}  // namespace tuina::safety
