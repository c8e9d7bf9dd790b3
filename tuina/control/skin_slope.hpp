// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tuina/core/geometry.hpp"

namespace tuina::control {

/// Slope of the skin against the believed one, learned from a tool that slides over it.
///
/// About the place under the tool the error of the believed skin is taken for a lean s and a bend
/// C: height = s w + w C w / 2 for a way w along the skin. A Kalman filter holds the two components
/// of s, the three of the symmetric C and the speed of the breath, and is told how fast the tool
/// goes outward. Its state travels with the tool (s grows by C w), so what was felt on one side of
/// a circle tells the slope of the other side.
class SkinSlope {
 public:
  /// Forgets all, at a new contact.
  void begin(const Vector3& normal_in_base) noexcept;

  /// One tick of a tool that is kept on the skin. `normal_in_base` is the believed outward normal,
  /// `deepening_m_per_s` the speed at which a set force that changes presses the tool in.
  void learn(const Vector3& velocity_m_per_s, const Vector3& normal_in_base,
             double deepening_m_per_s, double dt_s) noexcept;

  /// Rise of the skin per metre of way, a vector in the believed skin; at most 0.3 long.
  [[nodiscard]] Vector3 rise_in_base() const noexcept;
  /// Outward normal of the skin under the tool.
  [[nodiscard]] Vector3 normal_in_base() const noexcept;

 private:
  using State = Eigen::Matrix<double, 6, 1>;
  using Covariance = Eigen::Matrix<double, 6, 6>;

  void travel(const Eigen::Vector2d& way_m, double dt_s) noexcept;

  // Axes along the skin; their third is the believed normal.
  Vector3 normal_ = Vector3::UnitZ(), along_ = Vector3::UnitX(), across_ = Vector3::UnitY();
  State state_ = State::Zero();  // breath, two slopes, bends along, twist, across
  Covariance covariance_ = Covariance::Zero();
};

}  // namespace tuina::control
