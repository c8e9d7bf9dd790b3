// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <doctest/doctest.h>

#include <limits>

#include "tuina/safety/guard.hpp"

namespace tuina::safety {

inline constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
inline constexpr double infinity = std::numeric_limits<double>::infinity();

inline Guard::Options six_joints() {
  Guard::Options options;
  options.torque_limit_nm = JointVector::Constant(6, 50.0);
  options.bench = true;
  return options;
}

/// An arm that stands still and presses tilted skin with 20 N, all sensors well; tests spoil one
/// thing. The first three joints move the tool along the axes of the base, 0.2 m for each radian,
/// the others not at all; the tool is felt as 3 kg.
struct Scene {
  Observation seen;
  Proposal proposal;
  Guard guard;
  double force_n = 20.0;
  bool sensor_alive = true;
  Vector3 pushed_along;  ///< where the body pushes the tool; unit
  Verdict verdict;

  explicit Scene(const Guard::Options& options = six_joints()) : guard(options) {
    seen.q_rad = JointVector::LinSpaced(6, -1.0, 1.5);
    seen.dq_rad_per_s = JointVector::Zero(6);
    seen.gravity_nm = JointVector::LinSpaced(6, -2.0, 3.0);
    seen.jacobian.setZero(3, 6);
    seen.jacobian.leftCols<3>() = 0.2 * Eigen::Matrix3d::Identity();
    seen.mass_kg_m2 = 3.0 * 0.2 * 0.2 * JointMatrix::Identity(6, 6);
    seen.tool_in_base = {0.5, -0.2, 0.3};
    proposal = {.torque_nm = seen.gravity_nm,
                .phase = Phase::contact,
                .zone = Zone::muscle,
                .set_force_n = 20.0,
                .normal_in_base = Vector3(1.0, 2.0, 2.0) / 3.0,
                .stiffness_n_per_m = 1000.0};
    proposal.virtual_target_in_base = seen.tool_in_base - 0.02 * normal();
    pushed_along = normal();
  }

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

  /// One tick at a time of its own.
  const Verdict& tick_at(double time_s) {
    seen.tick += 1;
    seen.time_s = time_s;
    if (sensor_alive) seen.wrench_time_s = time_s - 1e-3;
    // No sensor says the same twice to the last bit.
    seen.force_in_base_n = (force_n - 1e-9 * static_cast<double>(seen.tick % 2)) * pushed_along;
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

  void freeze() {
    seen.tick += 3;  // that many were missed
    tick();
    REQUIRE(verdict.action == Action::freeze);
  }
  void comply() {
    seen.q_rad[5] += 6e-3;
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

}  // namespace tuina::safety
