// SPDX-License-Identifier: Apache-2.0
#include "tuina/robot/arm_model.hpp"

#include <Eigen/Cholesky>
#include <cassert>
#include <cmath>

namespace tuina::robot {
namespace {

/// Three plain doubles. Eigen handles a vector of three as a pair and a single, which costs this
/// code a quarter of its time.
struct Triple {
  double x = 0.0, y = 0.0, z = 0.0;
  Triple() = default;
  Triple(double x_, double y_, double z_) : x(x_), y(y_), z(z_) {}
  explicit Triple(const Vector3& v) : x(v.x()), y(v.y()), z(v.z()) {}
  [[nodiscard]] Vector3 eigen() const { return {x, y, z}; }
  void operator+=(const Triple& o) { x += o.x, y += o.y, z += o.z; }
};
Triple operator+(const Triple& a, const Triple& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
Triple operator-(const Triple& a, const Triple& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
Triple operator*(double s, const Triple& a) {
  return {s * a.x, s * a.y, s * a.z};
}
double dot(const Triple& a, const Triple& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
Triple cross(const Triple& a, const Triple& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// A symmetric 3x3 matrix by its six numbers: summing and applying it costs two thirds of a full
/// one.
struct Symmetric {
  double xx = 0, yy = 0, zz = 0, xy = 0, xz = 0, yz = 0;

  void add(double weight, const Triple& u) {  // weight * u u^T
    const Triple w = weight * u;
    xx += w.x * u.x, yy += w.y * u.y, zz += w.z * u.z;
    xy += w.x * u.y, xz += w.x * u.z, yz += w.y * u.z;
  }
  void add_products(double weight, const Triple& u, const Triple& v) {  // weight * (u v^T + v u^T)
    xx += 2.0 * weight * u.x * v.x, yy += 2.0 * weight * u.y * v.y, zz += 2.0 * weight * u.z * v.z;
    xy += weight * (u.x * v.y + u.y * v.x), xz += weight * (u.x * v.z + u.z * v.x);
    yz += weight * (u.y * v.z + u.z * v.y);
  }
  void add_to_diagonal(double value) { xx += value, yy += value, zz += value; }
  void operator+=(const Symmetric& o) {
    xx += o.xx, yy += o.yy, zz += o.zz, xy += o.xy, xz += o.xz, yz += o.yz;
  }
};
Triple operator*(const Symmetric& m, const Triple& u) {
  return {m.xx * u.x + m.xy * u.y + m.xz * u.z, m.xy * u.x + m.yy * u.y + m.yz * u.z,
          m.xz * u.x + m.yz * u.y + m.zz * u.z};
}

/// What gives a point of a turning body its acceleration relative to the origin: dw x r + w x (w x
/// r).
struct Swing {
  Symmetric inward;
  Triple dw;
  Swing(const Triple& w, const Triple& dw_) : dw(dw_) {
    inward.add(1.0, w);
    inward.add_to_diagonal(-dot(w, w));
  }
};
Triple operator*(const Swing& swing, const Triple& r) {
  return swing.inward * r + cross(swing.dw, r);
}

/// Mass, first moment and inertia about the shoulder of a link or of several taken as one.
struct Inertia {
  double mass = 0.0;
  Triple moment;
  Symmetric about_shoulder;
};

}  // namespace

ArmModel::ArmModel(const ArmTable& table, const RobotMount& mount, Arm arm) noexcept
    : table_(table),
      base_from_shoulder_turn_(mount.base_from_shoulder[arm].linear()),
      shoulder_in_base_(mount.base_from_shoulder[arm].translation()),
      rail_axis_in_base_(mount.rail_axis_in_base) {
  for (std::size_t i = 0; i < max_joints; ++i) {
    const Link& link = table_.links[i];
    turns_[i] = {std::cos(link.alpha_rad), std::sin(link.alpha_rad)};
    has_length_[i] = link.d_m != 0.0 || link.a_m != 0.0;
    reach_m_ += std::hypot(link.d_m, link.a_m);
    const auto& products = link.inertia_products_kg_m2;
    has_products_[i] = products[0] != 0.0 || products[1] != 0.0 || products[2] != 0.0;
  }
  turned_tool_ = !table_.end_from_tool_turn.isIdentity(0.0);
  elbow_ = static_cast<std::size_t>(elbow_origin(table_));
}

// Everything is expressed along the axes of base and about the shoulder, so no quantity is ever
// transformed from link to link: wrenches and inertias are summed as they are. Recursive
// Newton-Euler and composite rigid bodies, [featherstone2008] 5.3 and 6.2, written out in
// 3-vectors.
template <int N>
void ArmModel::evaluate_all(const double* q, const double* dq, double rail_m,
                            ArmDynamics& out) const noexcept {
  // While joint i alone turns with 1 rad/s: angular velocity, and velocity at the shoulder.
  Triple axis[N], at_shoulder[N];
  Inertia body[N];
  Triple force[N], torque[N];  // needed by the motion dq alone

  Triple x(base_from_shoulder_turn_.col(0)), y(base_from_shoulder_turn_.col(1)),
      z(base_from_shoulder_turn_.col(2));
  Triple origin;
  Triple acceleration;  // the origin's, as all others while ddq = 0
  Triple w, dw;
  for (int i = 0; i < N; ++i) {
    const Link& link = table_.links[static_cast<std::size_t>(i)];
    const Turn turn = turns_[static_cast<std::size_t>(i)];
    axis[i] = z;
    at_shoulder[i] = cross(origin, z);
    dw += dq[i] * cross(w, z);
    w += dq[i] * z;
    const Swing swing(w, dw);

    const double angle = q[i] + link.offset_rad;
    const double s = std::sin(angle), c = std::cos(angle);
    const Triple turned_x = c * x + s * y;
    const Triple turned_y = c * y - s * x;
    const Triple from_joint = link.com_in_joint[0] * turned_x + link.com_in_joint[1] * turned_y +
                              link.com_in_joint[2] * z;
    const Triple centre = origin + from_joint;
    Symmetric
        inertia;  // about the centre of mass; x x^T + y y^T + z z^T = 1 saves one of the three
    inertia.add_to_diagonal(link.inertia_kg_m2[0]);
    inertia.add(link.inertia_kg_m2[1] - link.inertia_kg_m2[0], turned_y);
    inertia.add(link.inertia_kg_m2[2] - link.inertia_kg_m2[0], z);
    if (has_products_[static_cast<std::size_t>(i)]) {
      const auto& products = link.inertia_products_kg_m2;
      inertia.add_products(products[0], turned_x, turned_y);
      inertia.add_products(products[1], turned_x, z);
      inertia.add_products(products[2], turned_y, z);
    }
    force[i] = link.mass_kg * (acceleration + swing * from_joint);
    torque[i] = inertia * dw + cross(w, inertia * w) + cross(centre, force[i]);

    Inertia& b = body[i];
    b.mass = link.mass_kg;
    b.moment = link.mass_kg * centre;
    b.about_shoulder = inertia;
    b.about_shoulder.add(-link.mass_kg, centre);
    b.about_shoulder.add_to_diagonal(dot(b.moment, centre));

    if (has_length_[static_cast<std::size_t>(i)]) {
      const Triple along = link.d_m * z + link.a_m * turned_x;
      acceleration += swing * along;
      origin += along;
    }
    x = turned_x;
    y = turn.cos_alpha * turned_y + turn.sin_alpha * z;
    z = turn.cos_alpha * z - turn.sin_alpha * turned_y;
  }

  out.base_from_tool.linear() << x.x, y.x, z.x, x.y, y.y, z.y, x.z, y.z, z.z;
  if (turned_tool_) out.base_from_tool.linear() *= table_.end_from_tool_turn;
  out.base_from_tool.translation() = origin.eigen() + shoulder_in_base(rail_m);
  out.base_from_tool.makeAffine();
  out.jacobian_dot_dq << acceleration.eigen(), dw.eigen();

  out.jacobian.resize(6, N);
  out.mass_kg_m2.resize(N, N);
  out.coriolis_nm.resize(N);
  out.gravity_nm.resize(N);
  Inertia carried;  // link i and all beyond, which joint i carries
  Triple carried_force, carried_torque;
  for (int i = N - 1; i >= 0; --i) {
    out.jacobian.col(i) << (at_shoulder[i] + cross(axis[i], origin)).eigen(), axis[i].eigen();

    carried.mass += body[i].mass;
    carried.moment += body[i].moment;
    carried.about_shoulder += body[i].about_shoulder;
    carried_force += force[i];
    carried_torque += torque[i];

    const Triple linear = carried.mass * at_shoulder[i] + cross(axis[i], carried.moment);
    const Triple angular = carried.about_shoulder * axis[i] + cross(carried.moment, at_shoulder[i]);
    for (int j = 0; j <= i; ++j) {
      const double m = dot(axis[j], angular) + dot(at_shoulder[j], linear);
      out.mass_kg_m2(i, j) = m;
      out.mass_kg_m2(j, i) = m;
    }
    out.mass_kg_m2(i, i) += table_.links[static_cast<std::size_t>(i)].rotor_inertia_kg_m2;
    out.coriolis_nm[i] = dot(axis[i], carried_torque) + dot(at_shoulder[i], carried_force);
    // Gravity pulls along -z: its moment about the joint is that of the weight at the carried
    // centre of mass, and `linear` is what the joint's turning moves that mass by.
    out.gravity_nm[i] = gravity_m_per_s2 * linear.z;
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
  if (turned_tool_) out.base_from_tool.linear() *= table_.end_from_tool_turn;
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

double unseen_yield_m_per_n(const ArmTable& table, const Jacobian& jacobian,
                            const Vector3& direction_in_base) noexcept {
  double m_per_n = 0.0;
  for (int i = 0; i < table.joints; ++i) {
    const double nm_per_rad = likely_gear_nm_per_rad(table.links[static_cast<std::size_t>(i)]);
    if (nm_per_rad >= rigid_gear_nm_per_rad) continue;
    const double lever_m = jacobian.col(i).head<3>().dot(direction_in_base);
    m_per_n += lever_m * lever_m / nm_per_rad;
  }
  return m_per_n;
}

PerArm<ArmModel> both_models(const ArmTable& table, const RobotMount& mount) noexcept {
  return {.of = {ArmModel(table, mount, Arm::left), ArmModel(table, mount, Arm::right)}};
}

JointVector acceleration(const JointMatrix& mass_kg_m2, const JointVector& torque_nm) noexcept {
  return mass_kg_m2.llt().solve(torque_nm);
}

Matrix6 tool_mobility(const ArmDynamics& dynamics) noexcept {
  const Eigen::LLT<JointMatrix> factor(dynamics.mass_kg_m2);
  Eigen::Matrix<double, Eigen::Dynamic, 6, 0, max_joints, 6> half = dynamics.jacobian.transpose();
  factor.matrixL().solveInPlace(half);  // M = L L^T, so J M^-1 J^T = (L^-1 J^T)^T (L^-1 J^T)
  return half.transpose() * half;
}

double apparent_mass_kg(const ArmDynamics& dynamics, const Vector3& direction_in_base) noexcept {
  const JointVector push = dynamics.jacobian.topRows<3>().transpose() * direction_in_base;
  const JointVector answer = acceleration(dynamics.mass_kg_m2, push);
  return 1.0 / std::max(push.dot(answer), 1e-12);
}

}  // namespace tuina::robot
