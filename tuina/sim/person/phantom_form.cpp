// SPDX-License-Identifier: Apache-2.0
#include "tuina/sim/person/phantom_form.hpp"

#include <algorithm>
#include <cmath>

#include "tuina/core/grid.hpp"
#include "tuina/core/units.hpp"

namespace tuina::sim {
namespace {

constexpr double lowest = -0.50;  // start of the fine table of radii, in lengths
constexpr double highest = 1.14;
constexpr double height_step = 0.005;
constexpr int rows = 329;  // from lowest to highest
constexpr double angle_step = pi / 90.0;
constexpr int columns = 92;  // from straight back to straight forward, and one more

/// Smooth minimum with blending distance k.
double blend(double a, double b, double k) {
  const double h = std::max(k - std::abs(a - b), 0.0) / k;
  return std::min(a, b) - h * h * k * 0.25;
}

}  // namespace

Curve::Curve(std::vector<double> x, std::vector<double> y)
    : x_(std::move(x)), y_(std::move(y)), slope_(x_.size(), 0.0) {
  // Slopes of the natural spline: a tridiagonal system (Thomas algorithm).
  const std::size_t n = x_.size();
  std::vector<double> upper(n, 0.0);
  for (std::size_t i = 0; i < n; ++i) {
    double diagonal = 0.0;
    double right = 0.0;
    double lower = 0.0;
    double above = 0.0;
    if (i > 0) {
      const double h = x_[i] - x_[i - 1];
      lower = 1.0 / h;
      diagonal += 2.0 / h;
      right += 3.0 * (y_[i] - y_[i - 1]) / (h * h);
    }
    if (i + 1 < n) {
      const double h = x_[i + 1] - x_[i];
      above = 1.0 / h;
      diagonal += 2.0 / h;
      right += 3.0 * (y_[i + 1] - y_[i]) / (h * h);
    }
    const double pivot = diagonal - (i > 0 ? lower * upper[i - 1] : 0.0);
    upper[i] = above / pivot;
    slope_[i] = (right - (i > 0 ? lower * slope_[i - 1] : 0.0)) / pivot;
  }
  for (std::size_t i = n - 1; i-- > 0;) slope_[i] -= upper[i] * slope_[i + 1];
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

namespace {

Curve spine_curve(const Proportions& p) {
  return Curve({0.0, p.of[height_l4], p.of[height_l2], p.of[height_t12], p.of[height_t9],
                p.of[height_t7], p.of[height_t3], 1.0},
               {0.0, p.of[depth_l4], p.of[depth_l2], p.of[depth_t12], p.of[depth_t9],
                p.of[depth_t7], p.of[depth_t3], 0.0});
}

}  // namespace

PhantomForm::PhantomForm(const Proportions& proportions, const PhantomShape& shape,
                         const PhantomPose& pose, const PartSizes& sizes)
    : length_m_(pose.length_m),
      spine_(spine_curve(proportions)),
      parts_(place_parts(sizes, proportions, shape, pose, spine_(sizes.girdle_z))),
      neck_blend_m_(sizes.neck_blend * length_m_),
      skull_blend_m_(sizes.skull_blend * length_m_),
      girdle_blend_m_(sizes.girdle_blend * length_m_),
      arm_blend_m_(sizes.arm_blend * length_m_) {
  lay_sections(proportions);
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
  radius_.resize(grid_cells(rows, columns));
  axis_y_.resize(static_cast<std::size_t>(rows));
  for (int row = 0; row < rows; ++row) {
    const double height = lowest + height_step * row;
    axis_y_[static_cast<std::size_t>(row)] = static_cast<float>(spine_(height) - axis_depth);
    // The section mirrored at the midline, and closed in front, which is never seen.
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
      radius_[grid_index(row, columns, column)] =
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

double PhantomForm::operator()(const Vector3& at) const {
  double distance = trunk(at);
  const std::size_t side = at.x() >= 0.0 ? 0 : 1;
  if (at.z() > 0.45 * length_m_ || std::abs(at.x()) > 0.2 * length_m_) {
    const double arm =
        std::min(parts_.upper_arm[side].distance(at), parts_.lower_arm[side].distance(at));
    double shoulder = blend(parts_.girdle[side].distance(at), arm, girdle_blend_m_);
    if (parts_.raised) shoulder = blend(shoulder, parts_.fold[side].distance(at), 0.08 * length_m_);
    distance = blend(distance, shoulder, arm_blend_m_);
  }
  if (at.z() > 0.85 * length_m_) {
    double head = blend(parts_.skull.distance(at), parts_.face.distance(at), 0.06 * length_m_);
    head = blend(head, parts_.ear[side].distance(at), 0.012 * length_m_);
    distance =
        blend(distance, blend(parts_.neck.distance(at), head, skull_blend_m_), neck_blend_m_);
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
  Box box{.low = length_m_ * Vector3(-0.45, -0.40, 0.0),
          .high = length_m_ * Vector3(0.45, 0.0, 1.50)};
  for (const RoundCone& arm : parts_.lower_arm) {
    box.low = box.low.cwiseMin(arm.to - Vector3::Constant(1.2 * arm.to_radius));
    box.high = box.high.cwiseMax(arm.to + Vector3::Constant(1.2 * arm.to_radius));
  }
  box.low.z() = -0.40 * length_m_;
  box.high.y() = 0.25 * length_m_;
  return box;
}

double PhantomForm::before_elbow(const Vector3& at) const {
  const RoundCone& arm = parts_.lower_arm[at.x() >= 0.0 ? 0 : 1];
  const Vector3 beyond = at - arm.to;
  const Vector3 way = (arm.to - arm.from).normalized();
  const double along = beyond.dot(way);
  const bool near_arm = (beyond - along * way).norm() < 1.5 * arm.to_radius;
  return near_arm ? -along : 1.0;
}

}  // namespace tuina::sim
