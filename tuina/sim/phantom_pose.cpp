// SPDX-License-Identifier: Apache-2.0
#include "tuina/sim/phantom_pose.hpp"

#include <algorithm>
#include <cmath>

#include "tuina/core/units.hpp"

namespace tuina::sim {
namespace {

/// Mean, dependence and spread of posture, measured on the people of phantom_table.cpp. Where two
/// numbers go together (who bends to the side also curves the spine and tilts the pelvis) the
/// correlation stands in pose_of.
struct PostureTable {
  double lean_deg, lean_woman_deg, lean_sd_deg;
  double bend_sd_deg, yaw_sd_deg, twist_sd_deg, shoulder_tilt_sd_deg, pelvis_tilt_sd_deg;
  double side_curve_sd;
  double neck_sd, head_aside_sd;
  double sacrum_back_m, sacrum_back_woman_m, sacrum_back_per_10_bmi_m, sacrum_back_sd_m;
  double sacrum_up_m, sacrum_up_per_10_bmi_m, sacrum_up_sd_m;
};
constexpr PostureTable sitting_table = {18.9, -1.3, 6.3,  3.0,  5.8,  2.5,  2.7,  1.6,  .0054,
                                        .03,  .012, .061, .018, .040, .014, .169, .022, .013};
constexpr PostureTable prone_table = {5.1, 2.2,  3.5,  4.3,  1.9,   2.0,  2.9,  1.7,  .0052,
                                      .02, .012, .222, .021, .0765, .015, .078, .010, .006};

double smooth_step(double x) {
  x = std::clamp(x, 0.0, 1.0);
  return x * x * (3.0 - 2.0 * x);
}

/// Upper arms from the shoulder to the elbow, x outwards: sitting they hang forward (hands on a
/// rest), prone they lie beside the trunk or reach up past the head.
Vector3 arm_direction(const PhantomShape& shape, Position position, double forward_score,
                      double outward_score, double lean_rad) {
  if (position == Position::sitting) {
    // The arm hangs by gravity and its support, so it keeps its angle to the vertical when the
    // trunk leans.
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

PhantomPose pose_of(const PhantomShape& shape, Position position, double length_m) {
  const PostureTable& t = position == Position::sitting ? sitting_table : prone_table;
  const auto& score = shape.posture;
  const double woman = shape.woman ? 1.0 : 0.0;
  const double heavier = (shape.bmi - 22.0) / 10.0;
  const double yaw_score =
      position == Position::sitting ? .65 * score[1] + .76 * score[2] : score[2];
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
  const Vector3 axis(0.0, -0.1 * length_m, 0.0);
  const Eigen::AngleAxisd twisted(twist_rad * (smooth_step(u) - 0.5), Vector3::UnitZ());
  p = axis + twisted * (p - axis);
  p = Eigen::AngleAxisd(yaw_rad, Vector3::UnitZ()) *
          (Eigen::AngleAxisd(lean_rad, Vector3::UnitX()) *
           (Eigen::AngleAxisd(bend_rad, Vector3::UnitY()) * p)) +
      sacrum_in_sitting;
  if (position == Position::prone) return {p.x(), -p.z(), p.y()};  // turned by 90 degrees about x
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
