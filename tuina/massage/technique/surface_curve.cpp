// SPDX-License-Identifier: Apache-2.0
#include "tuina/massage/technique/surface_curve.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>

#include "tuina/core/units.hpp"

namespace tuina::massage {
namespace {

constexpr double knot_distance_m = 15_mm;
constexpr int parts_per_span = 16;  // rows of the table of length for a span
// Third differences of the controls cost this much against squared distances: enough to make the
// fit unique where points are few, far too little to flatten a circle.
constexpr double roughness = 1e-3;

std::array<double, 4> basis(double t) {
  const double s = 1.0 - t;
  return {s * s * s / 6.0, (3.0 * t * t * t - 6.0 * t * t + 4.0) / 6.0,
          (3.0 * s * s * s - 6.0 * s * s + 4.0) / 6.0, t * t * t / 6.0};
}

std::array<double, 4> basis_slope(double t) {
  const double s = 1.0 - t;
  return {-0.5 * s * s, 0.5 * (3.0 * t * t - 4.0 * t), 0.5 * (4.0 * s - 3.0 * s * s), 0.5 * t * t};
}

/// The parameter of each point: its share of the polygon's length, from 0 to `spans`.
std::vector<double> parameters(std::span<const body::SurfacePoint> points, bool closed,
                               double& length_m) {
  std::vector<double> way = {0.0};
  for (std::size_t i = 1; i < points.size(); ++i) {
    way.push_back(way.back() + (points[i].at_in_couch - points[i - 1].at_in_couch).norm());
  }
  length_m = way.back();
  if (closed) length_m += (points.front().at_in_couch - points.back().at_in_couch).norm();
  return way;
}

}  // namespace

SurfaceCurve::SurfaceCurve(std::span<const body::SurfacePoint> lifted, bool closed)
    : closed_(closed) {
  double polygon_m = 0.0;
  const std::vector<double> way = parameters(lifted, closed, polygon_m);
  const int max_spans = std::max(1, static_cast<int>(lifted.size()) - (closed ? 1 : 3));
  spans_ = std::clamp(static_cast<int>(std::lround(polygon_m / knot_distance_m)), 1, max_spans);
  if (closed_) spans_ = std::max(spans_, 4);
  const int count = closed_ ? spans_ : spans_ + 3;

  // Normal equations of the penalised least squares; a few dozen unknowns.
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(count, count);
  Controls b = Controls::Zero(count, 6);
  for (std::size_t i = 0; i < lifted.size(); ++i) {
    const double u = spans_ * way[i] / std::max(polygon_m, 1e-9);
    const int span = std::clamp(static_cast<int>(u), 0, spans_ - 1);
    const auto w = basis(u - span);
    Eigen::Matrix<double, 1, 6> value;
    value << lifted[i].at_in_couch.transpose(), lifted[i].normal_in_couch.transpose();
    for (int j = 0; j < 4; ++j) {
      const int row = (span + j) % count;
      b.row(row) += w[static_cast<std::size_t>(j)] * value;
      for (int k = 0; k < 4; ++k) {
        A(row, (span + k) % count) +=
            w[static_cast<std::size_t>(j)] * w[static_cast<std::size_t>(k)];
      }
    }
  }
  const std::array<double, 4> third = {-1.0, 3.0, -3.0, 1.0};
  for (int i = 0; i < (closed_ ? count : count - 3); ++i) {
    for (int j = 0; j < 4; ++j) {
      for (int k = 0; k < 4; ++k) {
        A((i + j) % count, (i + k) % count) +=
            roughness * third[static_cast<std::size_t>(j)] * third[static_cast<std::size_t>(k)];
      }
    }
  }
  A.diagonal().array() += 1e-12;
  controls_ = A.ldlt().solve(b);

  // Simpson's rule over each small part gives the length to far below a micrometre.
  const double h = 1.0 / parts_per_span;
  way_m_ = {0.0};
  for (int i = 0; i < spans_ * parts_per_span; ++i) {
    const double u = i * h;
    way_m_.push_back(way_m_.back() +
                     h / 6.0 *
                         (slope(u).norm() + 4.0 * slope(u + 0.5 * h).norm() + slope(u + h).norm()));
  }
}

Eigen::Matrix<double, 1, 6> SurfaceCurve::value(double u) const {
  const int span = std::clamp(static_cast<int>(u), 0, spans_ - 1);
  const auto w = basis(u - span);
  Eigen::Matrix<double, 1, 6> sum = Eigen::Matrix<double, 1, 6>::Zero();
  for (int j = 0; j < 4; ++j) {
    sum += w[static_cast<std::size_t>(j)] *
           controls_.row((span + j) % static_cast<int>(controls_.rows()));
  }
  return sum;
}

Vector3 SurfaceCurve::slope(double u) const {
  const int span = std::clamp(static_cast<int>(u), 0, spans_ - 1);
  const auto w = basis_slope(u - span);
  Vector3 sum = Vector3::Zero();
  for (int j = 0; j < 4; ++j) {
    sum += w[static_cast<std::size_t>(j)] *
           controls_.row((span + j) % static_cast<int>(controls_.rows())).head<3>().transpose();
  }
  return sum;
}

body::SurfacePoint SurfaceCurve::at(double way_m) const {
  double way = way_m;
  if (closed_) {
    way = std::fmod(way, length_m());
    if (way < 0.0) way += length_m();
  }
  way = std::clamp(way, 0.0, length_m());
  const auto above = std::upper_bound(way_m_.begin() + 1, way_m_.end() - 1, way);
  const auto i = static_cast<std::size_t>(above - way_m_.begin()) - 1;
  // Newton's method on the length, from the chord of the table: two steps reach rounding.
  const double h = 1.0 / parts_per_span;
  const double start = static_cast<double>(i) * h;
  double u = start + h * (way - way_m_[i]) / std::max(way_m_[i + 1] - way_m_[i], 1e-12);
  for (int step = 0; step < 2; ++step) {
    const double d = u - start;
    const double walked =
        way_m_[i] +
        d / 6.0 * (slope(start).norm() + 4.0 * slope(start + 0.5 * d).norm() + slope(u).norm());
    u = std::clamp(u - (walked - way) / std::max(slope(u).norm(), 1e-12), start, start + h);
  }
  const Eigen::Matrix<double, 1, 6> v = value(u);
  return {v.head<3>().transpose(), v.tail<3>().transpose().normalized(), 0.0};
}

Result<std::vector<body::SurfacePoint>> lift(const body::BackSurface& back,
                                             std::span<const Vector3> guide,
                                             std::span<const Vector3> outward) {
  constexpr double above_m = 60_mm;
  constexpr double furthest_m = 60_mm;
  std::vector<body::SurfacePoint> lifted;
  lifted.reserve(guide.size());
  for (std::size_t i = 0; i < guide.size(); ++i) {
    const auto met = back.along(guide[i] + above_m * outward[i], -outward[i]);
    const body::SurfacePoint point =
        met && met->distance_m < above_m + furthest_m ? *met : back.nearest(guide[i]);
    const double off_m = (point.at_in_couch - guide[i]).norm();
    if (!(off_m <= furthest_m)) {
      return fail(Fault::not_found,
                  "the path leaves the scanned back: the skin is {:.0f} mm from it, {:.0f} allowed",
                  to_mm(off_m), to_mm(furthest_m));
    }
    lifted.push_back(point);
  }
  return lifted;
}

}  // namespace tuina::massage
