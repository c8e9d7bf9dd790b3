// SPDX-License-Identifier: Apache-2.0
#include "tuina/sim/phantom_form.hpp"

#include <algorithm>
#include <cmath>

#include "tuina/core/units.hpp"

namespace tuina::sim {
namespace {

constexpr double lowest = -0.50;  // of the fine table of radii, in lengths
constexpr double highest = 1.14;
constexpr double height_step = 0.005;
constexpr int rows = 329;  // from lowest to highest
constexpr double angle_step = pi / 90.0;
constexpr int columns = 92;  // from straight back to straight forward, and one more

/// The smaller of two distances, rounded where they are nearer to each other than k.
double blend(double a, double b, double k) {
  const double h = std::max(k - std::abs(a - b), 0.0) / k;
  return std::min(a, b) - h * h * k * 0.25;
}

}  // namespace

Curve::Curve(std::vector<double> x, std::vector<double> y)
    : x_(std::move(x)), y_(std::move(y)), slope_(x_.size(), 0.0) {
  for (std::size_t i = 1; i + 1 < x_.size(); ++i) {
    const double before = x_[i] - x_[i - 1];
    const double after = x_[i + 1] - x_[i];
    slope_[i] = (after * (y_[i] - y_[i - 1]) / before + before * (y_[i + 1] - y_[i]) / after) /
                (before + after);
  }
}

double Curve::operator()(double x) const {
  if (x <= x_.front()) return y_.front();
  if (x >= x_.back()) return y_.back();
  const auto above = std::upper_bound(x_.begin(), x_.end(), x);
  const auto i = static_cast<std::size_t>(above - x_.begin()) - 1;
  const double h = x_[i + 1] - x_[i];
  const double t = (x - x_[i]) / h;
  const double s = 1.0 - t;
  return s * s * (1.0 + 2.0 * t) * y_[i] + t * t * (1.0 + 2.0 * s) * y_[i + 1] +
         h * t * s * (s * slope_[i] - t * slope_[i + 1]);
}

double RoundCone::distance(const Vector3& at) const {
  // The exact distance to the hull of two balls.
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

namespace {

Curve spine_curve(const Proportions& p) {
  return Curve({0.0, p.of[height_l4], p.of[height_l2], p.of[height_t12], p.of[height_t9],
                p.of[height_t7], p.of[height_t3], 1.0},
               {0.0, p.of[depth_l4], p.of[depth_l2], p.of[depth_t12], p.of[depth_t9],
                p.of[depth_t7], p.of[depth_t3], 0.0});
}

}  // namespace

PhantomForm::PhantomForm(const Proportions& proportions, const PhantomShape& shape,
                         const PhantomPose& pose)
    : length_m_(pose.length_m), spine_(spine_curve(proportions)) {
  lay_sections(proportions);
  const auto& of = proportions.of;
  const double heavier = (shape.bmi - 22.0) / 10.0;
  const double woman = shape.woman ? 1.0 : 0.0;
  const bool up = shape.arms_up && pose.position == Position::prone;
  neck_ = {.from = length_m_ * Vector3(0.0, -0.108, 0.98),
           .to = length_m_ * Vector3(pose.head_aside * 0.6, -0.132 + 0.6 * pose.neck, 1.17),
           .from_radius = length_m_ * (0.106 - 0.010 * woman + 0.010 * heavier),
           .to_radius = length_m_ * (0.102 - 0.010 * woman + 0.010 * heavier)};
  const double tilt = pose.position == Position::prone ? 0.015 : 0.0;
  head_middle_ = length_m_ * Vector3(pose.head_aside, -0.167 + tilt + pose.neck, 1.268 + tilt);
  head_size_ = length_m_ * Vector3(0.142, 0.185, 0.197);
  for (const std::size_t side : {0U, 1U}) {
    const Vector3 outward(side == 0 ? 1.0 : -1.0, 1.0, 1.0);
    const Vector3 shoulder =
        length_m_ *
        outward.cwiseProduct(Vector3(of[acromion_x] + (up ? -0.02 : -0.060), of[acromion_y] + 0.012,
                                     of[acromion_z] - (up ? 0.085 : 0.100)));
    const double reach = up ? 0.78 : 0.62;
    arm_[side] = {.from = shoulder,
                  .to = shoulder + length_m_ * reach * pose.arm_in_trunk[side],
                  .from_radius = length_m_ * (0.112 - 0.010 * woman + 0.014 * heavier),
                  .to_radius = length_m_ * (0.076 - 0.006 * woman + 0.012 * heavier)};
    girdle_[side] = {
        .from = length_m_ * outward.cwiseProduct(Vector3(0.12, spine_(0.86) - 0.135, 0.862)),
        .to = shoulder + length_m_ * Vector3(0.0, 0.0, up ? 0.0 : 0.015),
        .from_radius = length_m_ * 0.088,
        .to_radius = length_m_ * (0.098 - 0.006 * woman)};
  }
}

void PhantomForm::lay_sections(const Proportions& proportions) {
  std::vector<Curve> by_height;
  for (std::size_t k = 0; k < section_angles_deg.size(); ++k) {
    std::vector<double> x(section_heights.begin(), section_heights.end());
    std::vector<double> y;
    for (const auto& section : proportions.section) y.push_back(section[k]);
    // Above C7 the sections close; the neck takes over.
    x.push_back(1.08);
    y.push_back(0.6 * y.back());
    x.push_back(highest);
    y.push_back(0.02);
    by_height.emplace_back(std::move(x), std::move(y));
  }
  radius_.resize(static_cast<std::size_t>(rows * columns));
  axis_y_.resize(static_cast<std::size_t>(rows));
  for (int row = 0; row < rows; ++row) {
    const double height = lowest + height_step * row;
    axis_y_[static_cast<std::size_t>(row)] = static_cast<float>(spine_(height) - axis_depth);
    // The section mirrored at the midline, and closed in front, which nobody sees.
    std::vector<double> angle = {-12.0, -6.0};
    std::vector<double> radius = {by_height[2](height), by_height[1](height)};
    for (std::size_t k = 0; k < section_angles_deg.size(); ++k) {
      angle.push_back(section_angles_deg[k]);
      radius.push_back(by_height[k](height));
    }
    const double side = radius.back();
    for (const double beyond : {112.0, 145.0, 190.0}) {
      angle.push_back(beyond);
      radius.push_back(side * 1.06);
    }
    const Curve section(angle, radius);
    for (int column = 0; column < columns; ++column) {
      radius_[static_cast<std::size_t>(row * columns + column)] =
          static_cast<float>(section(to_deg(angle_step * column)));
    }
  }
}

double PhantomForm::trunk(const Vector3& at) const {
  const double height = std::clamp((at.z() / length_m_ - lowest) / height_step, 0.0, rows - 1.001);
  const int row = static_cast<int>(height);
  const double t = height - row;
  const auto r = static_cast<std::size_t>(row);
  const double axis =
      (1.0 - t) * static_cast<double>(axis_y_[r]) + t * static_cast<double>(axis_y_[r + 1]);
  const double x = std::abs(at.x()) / length_m_;
  const double y = at.y() / length_m_ - axis;
  const double from_axis = std::sqrt(x * x + y * y);
  const double angle = std::min(std::atan2(x, y) / angle_step, columns - 1.001);
  const int column = static_cast<int>(angle);
  const double s = angle - column;
  const float* low = radius_.data() + static_cast<std::ptrdiff_t>(row) * columns + column;
  const float* high = low + columns;
  const double a = low[0];
  const double b = low[1];
  const double c = high[0];
  const double d = high[1];
  const double radius = (1.0 - t) * ((1.0 - s) * a + s * b) + t * ((1.0 - s) * c + s * d);
  const double around = ((1.0 - t) * (b - a) + t * (d - c)) / (angle_step * std::max(radius, 0.02));
  const double along = ((1.0 - s) * (c - a) + s * (d - b)) / height_step;
  double distance = (from_axis - radius) / std::sqrt(1.0 + around * around + along * along);
  const double above = at.z() / length_m_ - highest;
  if (above > 0.0) distance = std::hypot(std::max(distance, 0.0), above);
  return length_m_ * distance;
}

double PhantomForm::head(const Vector3& at) const {
  const Vector3 p = at - head_middle_;
  const double k0 = p.cwiseQuotient(head_size_).norm();
  const double k1 = p.cwiseQuotient(head_size_.cwiseAbs2()).norm();
  return k0 < 1e-6 ? -head_size_.minCoeff() : k0 * (k0 - 1.0) / k1;
}

double PhantomForm::operator()(const Vector3& at) const {
  const double body = trunk(at);
  double distance = body;
  if (at.z() > 0.55 * length_m_ || std::abs(at.x()) > 0.2 * length_m_) {
    const std::size_t side = at.x() >= 0.0 ? 0 : 1;
    const double shoulder =
        blend(girdle_[side].distance(at), arm_[side].distance(at), 0.05 * length_m_);
    // Under the armpit skin bridges trunk and arm less than over the shoulder.
    distance = blend(distance, shoulder, 0.07 * length_m_);
  }
  if (at.z() > 0.85 * length_m_) {
    distance = blend(distance, neck_.distance(at), 0.10 * length_m_);
    distance = blend(distance, head(at), 0.06 * length_m_);
  }
  return distance;
}

Vector3 PhantomForm::skin_at(double x_m, double z_m) const {
  double y = 0.45 * length_m_;
  for (int i = 0; i < 200; ++i) {
    const double distance = (*this)({x_m, y, z_m});
    if (std::abs(distance) < 1e-6) break;
    y -= 0.7 * distance;
  }
  return {x_m, y, z_m};
}

Vector3 PhantomForm::onto_skin(Vector3 at) const {
  for (int i = 0; i < 20; ++i) {
    const Vector3 slope = gradient_of(std::cref(*this), at);
    at -= 0.8 * slope * (*this)(at) / std::max(slope.squaredNorm(), 0.1);
  }
  return at;
}

Box PhantomForm::box() const {
  Box box{.low = length_m_ * Vector3(-0.45, -0.40, -0.46),
          .high = length_m_ * Vector3(0.45, 0.25, 1.50)};
  for (const RoundCone& arm : arm_) {
    box.low = box.low.cwiseMin(arm.to - Vector3::Constant(1.2 * arm.to_radius));
    box.high = box.high.cwiseMax(arm.to + Vector3::Constant(1.2 * arm.to_radius));
  }
  box.low.z() = -0.46 * length_m_;
  box.high.y() = 0.25 * length_m_;
  return box;
}

double PhantomForm::before_elbow(const Vector3& at) const {
  const RoundCone& arm = arm_[at.x() >= 0.0 ? 0 : 1];
  const Vector3 beyond = at - arm.to;
  const Vector3 way = (arm.to - arm.from).normalized();
  const double along = beyond.dot(way);
  const bool near_arm = (beyond - along * way).norm() < 1.5 * arm.to_radius;
  return near_arm ? -along : 1.0;
}

}  // namespace tuina::sim
