// SPDX-License-Identifier: Apache-2.0
#include "tuina/session/robot_pose.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "tuina/core/decompositions.hpp"

namespace tuina::session {
namespace {

constexpr std::size_t min_touches = 3;
constexpr double touch_sd_m = 1.5_mm;       // of one touch along each axis, believed beforehand
constexpr double believed_residuals = 6.0;  // as if so many had told it
constexpr double min_breadth_m = 0.1;       // of the spots across their longest direction
constexpr double max_scale_error = 0.05;
constexpr double stray_m = 8_mm;  // a touch so far from where the others put it is another spot
constexpr double max_lean_rad = 15_deg;  // of a robot on its feet
constexpr double max_misfit_m = 6_mm;    // of three touches, of which none can be named

/// The centre of the sphere, as the couch knows it and as the arm does.
struct Pair {
  Vector3 in_couch;
  Vector3 in_base;
  Vector3 normal_in_couch;
  Vector3 tool_axis_in_base;  // out of the fist
};

Pair pair_of(const robot::Touch& touch, const robot::ArmModel& arm) {
  const Transform base_from_tool = arm.base_from_tool(touch.q_rad, touch.rail_m);
  return {.in_couch = touch.spot_in_couch + arm.table().tool_radius_m * touch.normal_in_couch,
          .in_base = base_from_tool.translation(),
          .normal_in_couch = touch.normal_in_couch,
          .tool_axis_in_base = base_from_tool.linear().col(0)};
}

Transform fit(std::span<const Pair> pairs) {
  Eigen::Matrix3Xd from(3, static_cast<Eigen::Index>(pairs.size()));
  Eigen::Matrix3Xd to = from;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    from.col(static_cast<Eigen::Index>(i)) = pairs[i].in_couch;
    to.col(static_cast<Eigen::Index>(i)) = pairs[i].in_base;
  }
  return rigid_motion(from, to);
}

double residual_m(const Transform& base_from_couch, const Pair& pair) {
  return (base_from_couch * pair.in_couch - pair.in_base).norm();
}

Vector3 middle_of(std::span<const Pair> pairs, Vector3 Pair::*place) {
  Vector3 sum = Vector3::Zero();
  for (const Pair& pair : pairs) sum += pair.*place;
  return sum / static_cast<double>(pairs.size());
}

// Standard deviations of the places about their middle along their principal axes, falling.
Vector3 spread_m(std::span<const Pair> pairs, Vector3 Pair::*place) {
  const Vector3 middle = middle_of(pairs, place);
  Matrix3 scatter = Matrix3::Zero();
  for (const Pair& pair : pairs) {
    scatter += (pair.*place - middle) * (pair.*place - middle).transpose();
  }
  scatter /= static_cast<double>(pairs.size());
  return principal_axes(scatter).moments.cwiseMax(0.0).cwiseSqrt().reverse();
}

// The touch that the others contradict most, once it is left out of the fit.
std::optional<std::pair<std::size_t, double>> stray_of(std::span<const Pair> pairs) {
  if (pairs.size() <= min_touches) return {};
  std::size_t worst = 0;
  double worst_m = 0.0;
  double others_m = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    std::vector<Pair> others(pairs.begin(), pairs.end());
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
    if (4.0 * spread_m(others, &Pair::in_couch)(1) < min_breadth_m) continue;
    const Transform without = fit(others);
    double sum2 = 0.0;
    for (const Pair& pair : others) sum2 += std::pow(residual_m(without, pair), 2);
    const double rms_m = std::sqrt(sum2 / static_cast<double>(others.size()));
    // Without the stray the others agree; that tells it from its neighbours.
    if (rms_m < others_m) {
      worst = i;
      worst_m = residual_m(without, pairs[i]);
      others_m = rms_m;
    }
  }
  if (worst_m < stray_m || worst_m < 4.0 * others_m) return {};
  return std::pair{worst, worst_m};
}

Result<void> judge(std::span<const Pair> pairs) {
  if (pairs.size() < min_touches) {
    return fail(Fault::bad_input, "{} spots were touched; at least {} are needed, six are better",
                pairs.size(), min_touches);
  }
  const Vector3 in_couch = spread_m(pairs, &Pair::in_couch);
  const Vector3 in_base = spread_m(pairs, &Pair::in_base);
  const double scale = in_base.norm() / std::max(in_couch.norm(), 1e-9);
  if (scale > 100.0 || scale < 0.01) {
    return fail(Fault::bad_input,
                "the arm moved {:.3g} times as far between the spots as their places say; are they "
                "in millimetres?",
                scale);
  }
  // Two standard deviations to either side span the spots.
  if (4.0 * in_couch(1) < min_breadth_m) {
    return fail(Fault::bad_input,
                "the spots lie within {:.0f} mm of one line, so the turn about it is not known; "
                "touch one that lies at least {:.0f} mm aside",
                to_mm(2.0 * in_couch(1)), to_mm(min_breadth_m));
  }
  if (const auto stray = stray_of(pairs)) {
    return fail(Fault::bad_input,
                "line {}: the arm was {:.0f} mm from where the other touches put this spot; was "
                "another one touched, or are its numbers mistyped?",
                stray->first + 2, to_mm(stray->second));
  }
  if (std::abs(scale - 1.0) > max_scale_error) {
    return fail(Fault::bad_input,
                "the arm moved {:.2f} times as far between the spots as their places say; is the "
                "size of the board right, and the kind of the robot?",
                scale);
  }
  return {};
}

}  // namespace

double RobotPose::expected_error_m(const Vector3& place_in_couch) const {
  const Vector3 lever = place_in_couch - middle_in_couch;
  Matrix3 cross;
  cross << 0.0, -lever.z(), lever.y(), lever.z(), 0.0, -lever.x(), -lever.y(), lever.x(), 0.0;
  const Matrix3 by_turn = cross * turn_covariance_rad2 * cross.transpose();
  return std::sqrt((place_covariance_m2 + by_turn).trace());
}

Result<RobotPose> locate_robot(std::span<const robot::Touch> touches,
                               const PerArm<robot::ArmModel>& arms) {
  std::vector<Pair> pairs;
  pairs.reserve(touches.size());
  for (const robot::Touch& touch : touches) pairs.push_back(pair_of(touch, arms[touch.arm]));
  if (const auto good = judge(pairs); !good) return tl::unexpected(good.error());

  RobotPose pose{.base_from_couch = fit(pairs),
                 .middle_in_couch = middle_of(pairs, &Pair::in_couch)};
  const double lean_rad = std::acos(std::clamp(pose.base_from_couch(2, 2), -1.0, 1.0));
  if (lean_rad > max_lean_rad) {
    return fail(Fault::bad_input,
                "the robot would lean by {:.0f} degrees; was it touched for the other position, or "
                "are axes of the couch exchanged?",
                to_deg(lean_rad));
  }
  double sum2 = 0.0;
  Matrix3 inertia = Matrix3::Zero();
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    pose.residual_m.push_back(residual_m(pose.base_from_couch, pairs[i]));
    sum2 += pose.residual_m.back() * pose.residual_m.back();
    const Vector3 arm = pairs[i].in_couch - pose.middle_in_couch;
    inertia += arm.squaredNorm() * Matrix3::Identity() - arm * arm.transpose();
    const Vector3 normal_in_base = pose.base_from_couch.linear() * pairs[i].normal_in_couch;
    if (normal_in_base.dot(pairs[i].tool_axis_in_base) > 0.0) {
      return fail(Fault::bad_input,
                  "line {}: the arm would have touched this spot from behind; are left and right "
                  "exchanged, or the signs of the normals?",
                  i + 2);
    }
  }
  const auto count = static_cast<double>(pairs.size());
  const double rms_m = std::sqrt(sum2 / count);
  if (rms_m > max_misfit_m) {
    return fail(Fault::bad_input,
                "the touches fit their spots to {:.1f} mm only, at most {:.0f} mm are usual; touch "
                "more spots, and the spots once more",
                to_mm(rms_m), to_mm(max_misfit_m));
  }
  const double variance_m2 = (believed_residuals * touch_sd_m * touch_sd_m + sum2) /
                             (believed_residuals + 3.0 * count - 6.0);
  pose.place_covariance_m2 = Matrix3::Identity() * (variance_m2 / count);
  pose.turn_covariance_rad2 = variance_m2 * inertia.inverse();
  return pose;
}

}  // namespace tuina::session
