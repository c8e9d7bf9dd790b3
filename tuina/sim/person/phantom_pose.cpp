// SPDX-License-Identifier: Apache-2.0
#include "tuina/sim/person/phantom_pose.hpp"

#include <algorithm>
#include <cmath>

#include "tuina/core/units.hpp"

namespace tuina::sim {
namespace {

/// Mean, dependence and spread of posture, measured on the people of models/phantom.csv.
/// Correlations (bending curves the spine and tilts the pelvis) are in pose_of.
struct PostureTable {
  double lean_deg, lean_woman_deg, lean_sd_deg;
  double bend_sd_deg, yaw_sd_deg, twist_sd_deg, shoulder_tilt_sd_deg, pelvis_tilt_sd_deg;
  double side_curve_sd, flex_sd, neck_sd, head_aside_sd;  // in lengths C7-S2
  double sacrum_back_m, sacrum_back_woman_m, sacrum_back_per_10_bmi_m;
  double sacrum_up_m, sacrum_up_per_10_bmi_m;
};
constexpr PostureTable sitting_table = {.lean_deg = 18.9,
                                        .lean_woman_deg = -1.3,
                                        .lean_sd_deg = 6.3,
                                        .bend_sd_deg = 3.0,
                                        .yaw_sd_deg = 5.8,
                                        .twist_sd_deg = 2.5,
                                        .shoulder_tilt_sd_deg = 2.7,
                                        .pelvis_tilt_sd_deg = 1.6,
                                        .side_curve_sd = 0.0054,
                                        .flex_sd = 0.012,
                                        .neck_sd = 0.030,
                                        .head_aside_sd = 0.012,
                                        .sacrum_back_m = 0.061,
                                        .sacrum_back_woman_m = 0.018,
                                        .sacrum_back_per_10_bmi_m = 0.040,
                                        .sacrum_up_m = 0.169,
                                        .sacrum_up_per_10_bmi_m = 0.022};
constexpr PostureTable prone_table = {.lean_deg = 5.1,
                                      .lean_woman_deg = 2.2,
                                      .lean_sd_deg = 3.5,
                                      .bend_sd_deg = 4.3,
                                      .yaw_sd_deg = 1.9,
                                      .twist_sd_deg = 2.0,
                                      .shoulder_tilt_sd_deg = 2.9,
                                      .pelvis_tilt_sd_deg = 1.7,
                                      .side_curve_sd = 0.0052,
                                      .flex_sd = 0.0,
                                      .neck_sd = 0.020,
                                      .head_aside_sd = 0.012,
                                      .sacrum_back_m = 0.222,
                                      .sacrum_back_woman_m = 0.021,
                                      .sacrum_back_per_10_bmi_m = 0.0765,
                                      .sacrum_up_m = 0.078,
                                      .sacrum_up_per_10_bmi_m = 0.010};

double smooth_step(double x) {
  x = std::clamp(x, 0.0, 1.0);
  return x * x * (3.0 - 2.0 * x);
}

/// Upper arms from shoulder to elbow, x outwards: sitting they hang forward (hands on a rest),
/// prone they lie beside the trunk or reach past the head.
Vector3 arm_direction(const PhantomShape& shape, BodyPosture position, double forward_score,
                      double outward_score, double lean_rad) {
  if (position == BodyPosture::sitting) {
    // The arm keeps its angle to the vertical (gravity, hand rest) when the trunk leans.
    const double forward = from_deg(23.0 + 13.0 * forward_score) + lean_rad;
    const double outward = from_deg(12.7 + 5.5 * outward_score);
    const double down = std::cos(outward);
    return {std::sin(outward), -down * std::sin(forward), -down * std::cos(forward)};
  }
  if (shape.arms_up) {
    return Vector3(.89 - .04 * outward_score, -.28 + .08 * forward_score, .33 + .13 * outward_score)
        .normalized();
  }
  return Vector3(.30 + .08 * outward_score, -.19 + .08 * forward_score, -.92).normalized();
}

}  // namespace

PhantomPose pose_of(const PhantomShape& shape, BodyPosture position, double length_m) {
  const PostureTable& t = position == BodyPosture::sitting ? sitting_table : prone_table;
  const auto& score = shape.posture;
  const double woman = shape.woman ? 1.0 : 0.0;
  const double heavier = (shape.bmi - 22.0) / 10.0;
  const double yaw_score =
      position == BodyPosture::sitting ? .65 * score[1] + .76 * score[2] : score[2];
  PhantomPose pose;
  pose.position = position;
  pose.length_m = length_m;
  pose.lean_rad = from_deg(t.lean_deg + t.lean_woman_deg * woman + t.lean_sd_deg * score[0]);
  pose.bend_rad = from_deg(t.bend_sd_deg * score[1]);
  pose.yaw_rad = from_deg(t.yaw_sd_deg * yaw_score);
  pose.twist_rad = from_deg(t.twist_sd_deg * (.6 * yaw_score + .8 * score[3]));
  pose.shoulder_tilt_rad = from_deg(t.shoulder_tilt_sd_deg * score[4]);
  pose.pelvis_tilt_rad = from_deg(t.pelvis_tilt_sd_deg * (.6 * score[1] + .8 * score[5]));
  pose.side_curve = t.side_curve_sd * (-.6 * score[1] + .8 * score[6]);
  pose.flex = t.flex_sd * score[12];
  pose.neck = t.neck_sd * score[7];
  pose.head_aside = t.head_aside_sd * score[8];
  for (const std::size_t side : {0U, 1U}) {
    pose.arm_in_trunk[side] =
        arm_direction(shape, position, .8 * score[9] + (side == 0 ? .6 : -.6) * score[10],
                      score[11], pose.lean_rad);
    if (side == 1) pose.arm_in_trunk[side].x() *= -1.0;
  }
  pose.sacrum_in_sitting = {
      0.0, t.sacrum_back_m + t.sacrum_back_woman_m * woman + t.sacrum_back_per_10_bmi_m * heavier,
      t.sacrum_up_m + t.sacrum_up_per_10_bmi_m * heavier};
  return pose;
}

Vector3 PhantomPose::couch_from_trunk(const Vector3& at) const {
  const double u = at.z() / length_m;
  Vector3 p = at;
  const double along = std::clamp(u, 0.0, 1.0);
  p.x() += length_m * side_curve * 4.0 * along * (1.0 - along);
  p.z() += at.x() * (std::tan(shoulder_tilt_rad) * smooth_step((u - 0.3) / 0.5) +
                     std::tan(pelvis_tilt_rad) * (1.0 - smooth_step(u / 0.4)));
  // Rounding: half a wave of the back, continued straight at head and pelvis.
  const double beyond = u < 0.0 ? u : u > 1.0 ? 1.0 - u : 0.0;
  p.y() += length_m * flex * (std::sin(pi * along) + pi * beyond);
  const Vector3 axis(0.0, -0.1 * length_m, 0.0);
  const Eigen::AngleAxisd twisted(twist_rad * (smooth_step(u) - 0.5), Vector3::UnitZ());
  p = axis + twisted * (p - axis);
  p = Eigen::AngleAxisd(yaw_rad, Vector3::UnitZ()) *
          (Eigen::AngleAxisd(lean_rad, Vector3::UnitX()) *
           (Eigen::AngleAxisd(bend_rad, Vector3::UnitY()) * p)) +
      sacrum_in_sitting;
  if (position == BodyPosture::prone)
    return {p.x(), -p.z(), p.y()};  // rotation by 90 degrees about x
  return p;
}

Vector3 PhantomPose::normal_in_couch(const Vector3& at, const Vector3& normal_in_trunk) const {
  constexpr double h = 1e-4;
  const Vector3 along = normal_in_trunk.unitOrthogonal();
  const Vector3 across = normal_in_trunk.cross(along);
  const auto carried = [&](const Vector3& way) -> Vector3 {
    return couch_from_trunk(at + h * way) - couch_from_trunk(at - h * way);
  };
  return carried(along).cross(carried(across)).normalized();
}

}  // namespace tuina::sim
