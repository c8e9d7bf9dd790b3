// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tuina/safety/guard.hpp"

namespace tuina::safety {

inline Guard::Options six_joints() {
  Guard::Options options;
  options.torque_limit_nm = JointVector::Constant(6, 50.0);
  options.bench = true;
  return options;
}

/// An arm that stands still. The first three joints move the tool along the axes of the base, 0.2 m
/// for each radian, the others not at all; the tool is felt as 3 kg.
inline Observation standing_arm() {
  Observation seen;
  seen.q_rad = JointVector::LinSpaced(6, -1.0, 1.5);
  seen.dq_rad_per_s = JointVector::Zero(6);
  seen.gravity_nm = JointVector::LinSpaced(6, -2.0, 3.0);
  seen.jacobian.setZero(3, 6);
  seen.jacobian.leftCols<3>() = 0.2 * Eigen::Matrix3d::Identity();
  seen.mass_kg_m2 = 3.0 * 0.2 * 0.2 * JointMatrix::Identity(6, 6);
  seen.tool_in_base = {0.5, -0.2, 0.3};
  return seen;
}

/// What a controller says that lets this arm press tilted skin with 20 N.
inline Proposal pressing(const Observation& seen) {
  const Vector3 normal = Vector3(1.0, 2.0, 2.0) / 3.0;
  return {.torque_nm = seen.gravity_nm,
          .phase = Phase::contact,
          .zone = Zone::muscle,
          .set_force_n = 20.0,
          .normal_in_base = normal,
          .virtual_target_in_base = seen.tool_in_base - 0.02 * normal,
          .stiffness_n_per_m = 1000.0};
}

}  // namespace tuina::safety
