// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "tuina/sim/person/phantom_parts.hpp"
#include "tuina/sim/person/polygonise.hpp"

namespace tuina::sim {

/// Natural cubic spline through points of rising x, constant beyond the ends.
class Curve {
 public:
  Curve(std::vector<double> x, std::vector<double> y);
  [[nodiscard]] double operator()(double x) const;

 private:
  std::vector<double> x_, y_, slope_;
};

/// Implicit surface of a phantom in the trunk frame (m): negative inside, about a distance outside.
/// The trunk is interpolated from sections; shoulders, arms, neck and head are round bodies blended
/// into it.
class PhantomForm {
 public:
  PhantomForm(const Proportions& proportions, const PhantomShape& shape, const PhantomPose& pose,
              const PartSizes& sizes = {});

  [[nodiscard]] double operator()(const Vector3& at) const;

  /// First point of the skin along the viewing direction from behind.
  [[nodiscard]] Vector3 skin_at(double x_m, double z_m) const;
  /// Projects a point onto the skin along the gradient.
  [[nodiscard]] Vector3 onto_skin(Vector3 at) const;

  [[nodiscard]] double length_m() const { return length_m_; }  ///< C7 to S2
  [[nodiscard]] Box box() const;
  /// Negative beyond the elbow, where the surface ends.
  [[nodiscard]] double before_elbow(const Vector3& at) const;

 private:
  void lay_sections(const Proportions& proportions);
  [[nodiscard]] double trunk(const Vector3& at) const;

  double length_m_;
  Curve spine_;
  std::vector<float> radius_;  ///< over height and angle, in units of length_m
  std::vector<float> axis_y_;  ///< over height
  Parts parts_;
  double neck_blend_m_, skull_blend_m_, girdle_blend_m_, arm_blend_m_;
};

}  // namespace tuina::sim
