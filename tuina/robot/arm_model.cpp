// SPDX-License-Identifier: Apache-2.0
#include "tuina/robot/arm_model.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cassert>
#include <cmath>

namespace tuina::robot {
namespace {

const Vector3 gravity_in_base(0.0, 0.0, -gravity_m_per_s2);

/// A symmetric 3x3 matrix by its six numbers: summing and applying it costs two thirds of a full
/// one.
struct Symmetric {
  double xx = 0, yy = 0, zz = 0, xy = 0, xz = 0, yz = 0;

  void add(double weight, const Vector3& u) {  // weight * u u^T
    const double wx = weight * u.x(), wy = weight * u.y(), wz = weight * u.z();
    xx += wx * u.x(), yy += wy * u.y(), zz += wz * u.z();
    xy += wx * u.y(), xz += wx * u.z(), yz += wy * u.z();
  }
  void add_to_diagonal(double value) { xx += value, yy += value, zz += value; }
  void operator+=(const Symmetric& o) {
    xx += o.xx, yy += o.yy, zz += o.zz, xy += o.xy, xz += o.xz, yz += o.yz;
  }
  [[nodiscard]] Vector3 operator*(const Vector3& u) const {
    return {xx * u.x() + xy * u.y() + xz * u.z(), xy * u.x() + yy * u.y() + yz * u.z(),
            xz * u.x() + yz * u.y() + zz * u.z()};
  }
};

/// Mass, first moment and inertia about the shoulder of a link or of several taken as one.
struct Inertia {
  double mass = 0.0;
  Vector3 moment = Vector3::Zero();
  Symmetric about_shoulder;
};

}  // namespace

ArmModel::ArmModel(const ArmTable& table, const RobotMount& mount, Arm arm) noexcept
    : table_(table),
      base_from_shoulder_turn_(mount.base_from_shoulder[arm].linear()),
      shoulder_in_base_(mount.base_from_shoulder[arm].translation()),
      rail_axis_in_base_(mount.rail_axis_in_base) {
  for (std::size_t i = 0; i < most_joints; ++i) {
    const Link& link = table_.links[i];
    turns_[i] = {std::cos(link.alpha_rad), std::sin(link.alpha_rad)};
    reach_m_ += std::hypot(link.d_m, link.a_m);
  }
}

// Everything is expressed along the axes of base and about the shoulder, so no quantity is ever
// transformed from link to link: wrenches and inertias are summed as they are. Spatial algebra as
// in [featherstone2008] 5.3 (recursive Newton-Euler) and 6.2 (composite rigid bodies), written out
// in 3-vectors.
template <int N>
void ArmModel::evaluate_all(const double* q, const double* dq, double rail_m,
                            ArmDynamics& out) const noexcept {
  Vector3 axis[N], at_shoulder[N];  // of joint i turning with 1 rad/s: angular velocity, velocity
                                    // at the shoulder
  Inertia body[N];
  Vector3 force[N], torque[N];  // that the motion dq alone needs

  Vector3 x = base_from_shoulder_turn_.col(0), y = base_from_shoulder_turn_.col(1),
          z = base_from_shoulder_turn_.col(2);
  Vector3 origin = Vector3::Zero();
  Vector3 w = Vector3::Zero(), v = Vector3::Zero();    // motion of the link
  Vector3 dw = Vector3::Zero(), dv = Vector3::Zero();  // its spatial acceleration while ddq = 0
  for (int i = 0; i < N; ++i) {
    const Link& link = table_.links[static_cast<std::size_t>(i)];
    const Turn turn = turns_[static_cast<std::size_t>(i)];
    axis[i] = z;
    at_shoulder[i] = origin.cross(z);
    dw += dq[i] * w.cross(z);
    dv += dq[i] * (w.cross(at_shoulder[i]) + v.cross(z));
    w += dq[i] * z;
    v += dq[i] * at_shoulder[i];

    const double angle = q[i] + link.offset_rad;
    const double s = std::sin(angle), c = std::cos(angle);
    const Vector3 turned_x = c * x + s * y;
    const Vector3 turned_y = c * y - s * x;
    const auto& com = link.com_in_joint;
    const auto& inertia = link.inertia_kg_m2;
    const Vector3 centre = origin + com[0] * turned_x + com[1] * turned_y + com[2] * z;
    Inertia& b = body[i];
    b.mass = link.mass_kg;
    b.moment = link.mass_kg * centre;
    b.about_shoulder.add(inertia[0], turned_x);
    b.about_shoulder.add(inertia[1], turned_y);
    b.about_shoulder.add(inertia[2], z);
    b.about_shoulder.add(-link.mass_kg, centre);
    b.about_shoulder.add_to_diagonal(link.mass_kg * centre.squaredNorm());

    const Vector3 momentum = b.mass * v + w.cross(b.moment);
    force[i] = b.mass * dv + dw.cross(b.moment) + w.cross(momentum);
    torque[i] = b.about_shoulder * dw + b.moment.cross(dv) +
                w.cross(b.about_shoulder * w + b.moment.cross(v)) + v.cross(momentum);

    origin += link.d_m * z + link.a_m * turned_x;
    const Vector3 next_y = turn.cos_alpha * turned_y + turn.sin_alpha * z;
    z = turn.cos_alpha * z - turn.sin_alpha * turned_y;
    x = turned_x;
    y = next_y;
  }

  out.base_from_tool.linear().col(0) = x;
  out.base_from_tool.linear().col(1) = y;
  out.base_from_tool.linear().col(2) = z;
  out.base_from_tool.translation() = origin + shoulder_in_base(rail_m);
  out.base_from_tool.makeAffine();
  out.jacobian_dot_dq.head<3>() = dv + dw.cross(origin) + w.cross(v + w.cross(origin));
  out.jacobian_dot_dq.tail<3>() = dw;

  out.jacobian.resize(6, N);
  out.mass_kg_m2.resize(N, N);
  out.coriolis_nm.resize(N);
  out.gravity_nm.resize(N);
  Inertia carried;  // by joint i: link i and all beyond
  Vector3 carried_force = Vector3::Zero(), carried_torque = Vector3::Zero();
  for (int i = N - 1; i >= 0; --i) {
    out.jacobian.col(i).head<3>() = at_shoulder[i] + axis[i].cross(origin);
    out.jacobian.col(i).tail<3>() = axis[i];

    carried.mass += body[i].mass;
    carried.moment += body[i].moment;
    carried.about_shoulder += body[i].about_shoulder;
    carried_force += force[i];
    carried_torque += torque[i];

    const Vector3 linear = carried.mass * at_shoulder[i] + axis[i].cross(carried.moment);
    const Vector3 angular = carried.about_shoulder * axis[i] + carried.moment.cross(at_shoulder[i]);
    for (int j = 0; j <= i; ++j) {
      const double m = axis[j].dot(angular) + at_shoulder[j].dot(linear);
      out.mass_kg_m2(i, j) = m;
      out.mass_kg_m2(j, i) = m;
    }
    out.mass_kg_m2(i, i) += table_.links[static_cast<std::size_t>(i)].rotor_inertia_kg_m2;
    out.coriolis_nm[i] = axis[i].dot(carried_torque) + at_shoulder[i].dot(carried_force);
    out.gravity_nm[i] = -axis[i].dot(carried.moment.cross(gravity_in_base)) -
                        carried.mass * at_shoulder[i].dot(gravity_in_base);
  }
}

ArmDynamics ArmModel::evaluate(const JointVector& q_rad, const JointVector& dq_rad_per_s,
                               double rail_m) const noexcept {
  assert(q_rad.size() == table_.joints && dq_rad_per_s.size() == table_.joints);
  ArmDynamics out;
  if (table_.joints == 6) {
    evaluate_all<6>(q_rad.data(), dq_rad_per_s.data(), rail_m, out);
  } else {
    assert(table_.joints == 7);
    evaluate_all<7>(q_rad.data(), dq_rad_per_s.data(), rail_m, out);
  }
  return out;
}

ArmModel::Kinematics ArmModel::kinematics(const JointVector& q_rad, double rail_m) const noexcept {
  assert(q_rad.size() == table_.joints);
  Kinematics out;
  Matrix3 turn = base_from_shoulder_turn_;
  Vector3 origin = shoulder_in_base(rail_m);
  out.jacobian.resize(6, table_.joints);
  for (int i = 0; i < table_.joints; ++i) {
    const Link& link = table_.links[static_cast<std::size_t>(i)];
    const auto [ca, sa] = turns_[static_cast<std::size_t>(i)];
    out.origins_in_base[static_cast<std::size_t>(i)] = origin;
    out.jacobian.col(i).tail<3>() = turn.col(2);
    const double angle = q_rad[i] + link.offset_rad;
    const double s = std::sin(angle), c = std::cos(angle);
    const Vector3 x = c * turn.col(0) + s * turn.col(1);
    const Vector3 y = c * turn.col(1) - s * turn.col(0);
    const Vector3 z = turn.col(2);
    origin += link.d_m * z + link.a_m * x;
    turn.col(0) = x;
    turn.col(1) = ca * y + sa * z;
    turn.col(2) = ca * z - sa * y;
  }
  out.origins_in_base[static_cast<std::size_t>(table_.joints)] = origin;
  for (int i = 0; i < table_.joints; ++i) {
    const Vector3 axis = out.jacobian.col(i).tail<3>();
    out.jacobian.col(i).head<3>() =
        axis.cross(origin - out.origins_in_base[static_cast<std::size_t>(i)]);
  }
  out.base_from_tool.linear() = turn;
  out.base_from_tool.translation() = origin;
  out.base_from_tool.makeAffine();
  return out;
}

Transform ArmModel::base_from_tool(const JointVector& q_rad, double rail_m) const noexcept {
  return kinematics(q_rad, rail_m).base_from_tool;
}

JointVector ArmModel::gravity_nm(const JointVector& q_rad) const noexcept {
  return evaluate(q_rad, JointVector::Zero(table_.joints), 0.0).gravity_nm;
}

Matrix6 tool_mobility(const ArmDynamics& dynamics) noexcept {
  const Eigen::LLT<JointMatrix> factor(dynamics.mass_kg_m2);
  Eigen::Matrix<double, Eigen::Dynamic, 6, 0, most_joints, 6> half = dynamics.jacobian.transpose();
  factor.matrixL().solveInPlace(half);  // M = L L^T, so J M^-1 J^T = (L^-1 J^T)^T (L^-1 J^T)
  return half.transpose() * half;
}

Matrix6 operational_inertia(const ArmDynamics& dynamics, double largest_kg) noexcept {
  const Eigen::SelfAdjointEigenSolver<Matrix6> eigen(tool_mobility(dynamics));
  const Vector6 inertia = eigen.eigenvalues().cwiseMax(1.0 / largest_kg).cwiseInverse();
  return eigen.eigenvectors() * inertia.asDiagonal() * eigen.eigenvectors().transpose();
}

double apparent_mass_kg(const ArmDynamics& dynamics, const Vector3& direction_in_base) noexcept {
  const JointVector push = dynamics.jacobian.topRows<3>().transpose() * direction_in_base;
  const Eigen::LLT<JointMatrix> factor(dynamics.mass_kg_m2);
  const JointVector answer = factor.solve(push);
  return 1.0 / std::max(push.dot(answer), 1e-12);
}

}  // namespace tuina::robot
