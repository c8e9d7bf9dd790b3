// SPDX-License-Identifier: Apache-2.0
#include "tuina/sim/person/phantom_parts.hpp"

#include <algorithm>
#include <cmath>

namespace tuina::sim {

double RoundCone::distance(const Vector3& at) const {
  // Exact distance to the hull of two balls [quilez_sdf].
  const Vector3 axis = to - from;
  const double l2 = axis.squaredNorm();
  const double dr = from_radius - to_radius;
  const double a2 = l2 - dr * dr;
  const Vector3 p = at - from;
  const double y = p.dot(axis);
  const double z = y - l2;
  const double x2 = (p * l2 - axis * y).squaredNorm();
  const double y2 = y * y * l2;
  const double z2 = z * z * l2;
  const double k = (dr < 0.0 ? -1.0 : 1.0) * dr * dr * x2;
  if ((z < 0.0 ? -1.0 : 1.0) * a2 * z2 > k) return std::sqrt(x2 + z2) / l2 - to_radius;
  if ((y < 0.0 ? -1.0 : 1.0) * a2 * y2 < k) return std::sqrt(x2 + y2) / l2 - from_radius;
  return (std::sqrt(x2 * a2 / l2) + y * dr) / l2 - from_radius;
}

double Ellipsoid::distance(const Vector3& at) const {
  const Vector3 p = at - middle;
  const Vector3 q = p.cwiseQuotient(half).cwiseAbs();
  const double norm =
      boxy ? std::pow((q.array().square() * q.array().sqrt()).sum(), 0.4) : q.norm();
  if (norm < 1e-6) return -half.minCoeff();
  // Distance along the ray from the centre, shortened by the obliquity of the surface.
  const double k1 = p.cwiseQuotient(half.cwiseAbs2()).norm();
  return (norm - 1.0) * std::min(p.norm() / norm, q.norm() / k1);
}

Parts place_parts(const PartSizes& s, const Proportions& proportions, const PhantomShape& shape,
                  const PhantomPose& pose, double spine_depth) {
  const auto& of = proportions.of;
  const double length_m = pose.length_m;
  const double heavier = (shape.bmi - 22.0) / 10.0;
  const double woman = shape.woman ? 1.0 : 0.0;
  const bool prone = pose.position == BodyPosture::prone;
  const bool raised = shape.arms_up && prone;
  Parts parts;
  parts.raised = raised;

  const double neck = s.neck_woman * woman + s.neck_bmi * heavier;
  parts.neck = {.from = length_m * Vector3(0.0, s.neck_low_y, s.neck_low_z),
                .to = length_m * Vector3(pose.head_aside * 0.6, s.neck_high_y + 0.6 * pose.neck,
                                         s.neck_high_z),
                .from_radius = length_m * (s.neck_low_r + neck),
                .to_radius = length_m * (s.neck_high_r + neck)};
  const Vector3 skull(pose.head_aside, s.skull_y + pose.neck + (prone ? s.skull_prone_y : 0.0),
                      s.skull_z + (prone ? s.skull_prone_z : 0.0));
  parts.skull = {.middle = length_m * skull,
                 .half = length_m * Vector3(s.skull_half_x, s.skull_half_y, s.skull_half_z),
                 .boxy = true};
  parts.face = {.middle = length_m * (skull + Vector3(0.0, -0.075, -0.115)),
                .half = length_m * Vector3(0.115, 0.115, 0.125)};

  const double arm = s.arm_woman * woman + s.arm_bmi * heavier;
  for (const std::size_t side : {0U, 1U}) {
    const Vector3 outward(side == 0 ? 1.0 : -1.0, 1.0, 1.0);
    const auto place = [&](double x, double y, double z) -> Vector3 {
      return length_m * outward.cwiseProduct(Vector3(x, y, z));
    };
    parts.ear[side] = {
        .middle = length_m * (skull + Vector3(outward.x() * s.skull_half_x * 1.02, -0.005, -0.045)),
        .half = length_m * Vector3(0.016, 0.030, 0.055)};
    const Vector3 shoulder =
        raised ? place(of[acromion_x] + s.raised_x, of[acromion_y] + s.raised_y,
                       of[acromion_z] + s.raised_z)
               : place(of[acromion_x] + s.shoulder_x, of[acromion_y] + s.shoulder_y,
                       of[acromion_z] + s.shoulder_z);
    const Vector3 way = length_m * pose.arm_in_trunk[side];
    parts.upper_arm[side] = {
        .from = shoulder,
        .to = shoulder + 0.33 * way,
        .from_radius = length_m * (s.shoulder_r + arm + (raised ? s.raised_r : 0.0)),
        .to_radius = length_m * (s.triceps_r + arm)};
    parts.lower_arm[side] = {.from = parts.upper_arm[side].to,
                             .to = shoulder + 0.62 * way,
                             .from_radius = parts.upper_arm[side].to_radius,
                             .to_radius = length_m * (s.elbow_r + 0.7 * arm)};
    if (raised) {
      parts.fold[side] = {.from = place(s.fold_x, s.fold_y, s.fold_z),
                          .to = parts.upper_arm[side].to,
                          .from_radius = length_m * s.fold_r,
                          .to_radius = length_m * 0.8 * s.triceps_r};
    }
    parts.girdle[side] = {.from = place(s.girdle_x, spine_depth + s.girdle_y, s.girdle_z),
                          .to = shoulder + length_m * Vector3(0.0, s.girdle_out_y, s.girdle_out_z),
                          .from_radius = length_m * s.girdle_r,
                          .to_radius = length_m * (s.girdle_out_r + 0.7 * arm)};
  }
  return parts;
}

}  // namespace tuina::sim
