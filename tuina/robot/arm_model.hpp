// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "tuina/robot/arm_table.hpp"
#include "tuina/robot/mount.hpp"

namespace tuina::robot {

/// Linear part before the angular one, as in twists and wrenches.
using Vector6 = Eigen::Matrix<double, 6, 1>;
/// Maps one such vector to another.
using Matrix6 = Eigen::Matrix<double, 6, 6>;
/// Six rows and a column for each joint.
using Jacobian = Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, max_joints>;

/// One evaluation of an arm's model, everything in `base`. Equation of motion:
/// mass * ddq + coriolis + gravity = motor torque - friction + jacobian^T * wrench on the tool.
struct ArmDynamics {
  Transform base_from_tool;
  Jacobian jacobian;        ///< rows 0-2 velocity of the tool's origin, rows 3-5 angular velocity
  Vector6 jacobian_dot_dq;  ///< the tool's acceleration when no joint accelerates
  JointMatrix mass_kg_m2;   ///< rotors included
  JointVector coriolis_nm;  ///< Coriolis and centrifugal torque
  JointVector gravity_nm;   ///< torque that holds the arm, [thesis] (3.14)
};

/// Kinematics and dynamics of one mounted arm from its table: fixed memory, no heap, no exceptions;
/// about 0.3 microseconds for everything (./run bench robot). The rail counts as standing still.
class ArmModel {
 public:
  /// One arm of a robot of this table, mounted so.
  ArmModel(const ArmTable& table, const RobotMount& mount, Arm arm) noexcept;

  /// The table that it was made of.
  [[nodiscard]] const ArmTable& table() const noexcept { return table_; }
  [[nodiscard]] int joints() const noexcept { return table_.joints; }  ///< number of joints: 6 or 7
  /// Distance from the shoulder to the tool's origin of the stretched arm.
  [[nodiscard]] double reach_m() const noexcept { return reach_m_; }
  /// Number of the DH frame whose origin is the elbow; the one before it is the shoulder's.
  [[nodiscard]] std::size_t elbow() const noexcept { return elbow_; }
  /// Where the shoulder is with the rail there.
  [[nodiscard]] Vector3 shoulder_in_base(double rail_m) const noexcept {
    return shoulder_in_base_ + rail_m * rail_axis_in_base_;
  }

  /// Kinematics and dynamics of a state at once.
  [[nodiscard]] ArmDynamics evaluate(const JointVector& q_rad, const JointVector& dq_rad_per_s,
                                     double rail_m) const noexcept;

  /// Pose of the tool at these joint angles.
  [[nodiscard]] Transform base_from_tool(const JointVector& q_rad, double rail_m) const noexcept;
  /// Torques that hold the arm against gravity.
  [[nodiscard]] JointVector gravity_nm(const JointVector& q_rad) const noexcept;

  /// Pose of the tool and its Jacobian only, for inverse kinematics.
  struct Kinematics {
    Transform base_from_tool;
    Jacobian jacobian;
    std::array<Vector3, max_joints + 1> origins_in_base;  ///< DH frames 0 to n
  };
  /// Kinematics alone, for planning.
  [[nodiscard]] Kinematics kinematics(const JointVector& q_rad, double rail_m) const noexcept;

 private:
  struct Turn {
    double cos_alpha, sin_alpha;
  };

  template <int N>
  void evaluate_all(const double* q, const double* dq, double rail_m,
                    ArmDynamics& out) const noexcept;

  ArmTable table_;
  std::array<Turn, max_joints> turns_ = {};
  std::array<bool, max_joints> has_length_ = {};
  Matrix3 base_from_shoulder_turn_;
  Vector3 shoulder_in_base_;
  Vector3 rail_axis_in_base_;
  std::array<bool, max_joints> has_products_ = {};
  bool turned_tool_ = false;
  std::size_t elbow_ = 0;
  double reach_m_ = 0.0;
};

/// By how much encoders at the motors say a tool deeper than it is, in metres for each newton along
/// the unit `direction_in_base` on its origin: the gears give way. A gear whose stiffness the table
/// does not tell is taken for a usual one.
[[nodiscard]] double unseen_yield_m_per_n(const ArmTable& table, const Jacobian& jacobian,
                                          const Vector3& direction_in_base) noexcept;

/// The models of both arms of one robot.
[[nodiscard]] PerArm<ArmModel> both_models(const ArmTable& table, const RobotMount& mount) noexcept;

/// How the joints of an arm at rest answer to torques that nothing else balances: M^-1 torque, in
/// rad/s^2.
[[nodiscard]] JointVector acceleration(const JointMatrix& mass_kg_m2,
                                       const JointVector& torque_nm) noexcept;

/// Inverse of the inertia that the tool shows to a force: J M^-1 J^T, [thesis] chapter 3. Always
/// defined.
[[nodiscard]] Matrix6 tool_mobility(const ArmDynamics& dynamics) noexcept;

/// The mass that a push along the unit `direction_in_base` on the tool's origin feels.
[[nodiscard]] double apparent_mass_kg(const ArmDynamics& dynamics,
                                      const Vector3& direction_in_base) noexcept;

}  // namespace tuina::robot
