// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/safety/standing_arm.hpp"

namespace tuina::safety {

/// What must be true of every verdict on a `standing_arm` that is moved and spoilt at will,
/// whatever its guard finds. The skin under the tool, where it is told, stays the same.
class Oracle {
 public:
  /// What is wrong with a verdict; null when nothing is.
  const char* judge(const Observation& seen, const Proposal& proposal, const Verdict& verdict) {
    const char* fault = of_torque(seen, proposal, verdict);
    if (fault == nullptr) fault = of_action(seen, verdict);
    known_ = known_ || knows(seen);
    before_ = verdict;
    q_rad_ = seen.q_rad;
    return fault;
  }

 private:
  static bool knows(const Observation& seen) {
    return seen.q_rad.size() == 6 && seen.dq_rad_per_s.size() == 6 && seen.gravity_nm.size() == 6 &&
           seen.jacobian.cols() == 6 && seen.mass_kg_m2.cols() == 6 && seen.q_rad.allFinite() &&
           seen.dq_rad_per_s.allFinite() && seen.gravity_nm.allFinite() &&
           seen.jacobian.allFinite() && seen.mass_kg_m2.allFinite() &&
           seen.tool_in_base.allFinite() && seen.tool_velocity_m_per_s.allFinite() &&
           seen.time_s - seen.time_s == 0.0;
  }

  const char* of_torque(const Observation& seen, const Proposal& proposal, const Verdict& verdict) {
    const JointVector& allowed_nm = verdict.allowed_nm;
    if (allowed_nm.size() != 6 || !allowed_nm.allFinite()) return "a torque is a number";
    if (allowed_nm.cwiseAbs().maxCoeff() > 50.0) return "a torque is one that drives can give";
    if (!known_ && !knows(seen))
      return allowed_nm.isZero(0.0) ? nullptr : "unknown joints get none";
    const JointVector last_nm = known_ ? before_.allowed_nm : seen.gravity_nm;
    const double step_nm = (allowed_nm - last_nm).cwiseAbs().maxCoeff();
    if (step_nm > 10.0 + 1e-9) return "a torque is not sudden";
    if (verdict.action == Action::pass && allowed_nm != proposal.torque_nm)
      return "what passes is what was proposed";
    if (verdict.action <= Action::warn && seen.skin != nullptr) {
      // The levers of the joints are alike and so are their masses: what the torques push along the
      // normal is what the body has to push back.
      const Vector3 force_n = (allowed_nm - seen.gravity_nm).head<3>() / 0.2;
      // 60 N and friction; where a drive is at its limit the others take a tick more to make up.
      const bool at_limit = allowed_nm.head<3>().cwiseAbs().maxCoeff() == 50.0;
      if (-force_n.dot(seen.skin->normal_in_base.cast<double>()) > (at_limit ? 80.0 : 70.001))
        return "nobody is pressed harder than muscle bears";
    }
    return nullptr;
  }

  const char* of_action(const Observation& seen, const Verdict& verdict) {
    if ((verdict.action == Action::pass) != (verdict.cause == Cause::none))
      return "whatever is done has a cause";
    if (verdict.latched && verdict.action < Action::freeze) return "a stop does something";
    if (verdict.action >= Action::comply && !verdict.latched) return "what stops is latched";
    if (before_.latched && (!verdict.latched || verdict.action < before_.action))
      return "no stop ends or grows milder";
    if (before_.latched && verdict.cause != before_.cause) return "a stop keeps its cause";
    const bool turned = q_rad_.size() == 6 && seen.q_rad.size() == 6 &&
                        !((seen.q_rad - q_rad_).norm() + seen.dq_rad_per_s.norm() < 1e-12);
    jumped_ = jumped_ || turned;
    const bool disobeys = !(seen.tool_velocity_m_per_s.norm() < 0.05);
    const bool may_brake =
        !knows(seen) || jumped_ || (before_.latched && disobeys) || before_.action == Action::brake;
    if (verdict.action == Action::brake && !may_brake) return "brakes need a cause";
    return nullptr;
  }

  Verdict before_;
  JointVector q_rad_;
  bool known_ = false, jumped_ = false;
};

}  // namespace tuina::safety
