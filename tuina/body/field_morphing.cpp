// SPDX-License-Identifier: Apache-2.0
#include "tuina/body/field_morphing.hpp"

#include <Eigen/LU>
#include <cassert>
#include <cmath>

namespace tuina::body {
namespace {

Vector2 perpendicular(const Vector2& v) {
  return {-v.y(), v.x()};
}

}  // namespace

Vector2 warp(const Vector2& x, const std::vector<FeatureLine>& destination,
             const std::vector<FeatureLine>& source, const FieldWeights& weights) {
  assert(!destination.empty() && destination.size() == source.size());
  Vector2 d_sum = Vector2::Zero();
  double weight_sum = 0.0;
  for (std::size_t i = 0; i < destination.size(); ++i) {
    const Vector2& p = destination[i].p;
    const Vector2 pq = destination[i].q - p;
    const Vector2& p_source = source[i].p;
    const Vector2 pq_source = source[i].q - p_source;
    const double length = pq.norm();
    const double u = (x - p).dot(pq) / pq.squaredNorm();       // (5.1)
    const double v = (x - p).dot(perpendicular(pq)) / length;  // (5.2)
    const Vector2 x_source =                                   // (5.3)
        p_source + u * pq_source + v * perpendicular(pq_source) / pq_source.norm();
    // (5.5) prints P and Q; the distances to them are meant.
    const double distance = u < 0.0   ? (x - p).norm()
                            : u > 1.0 ? (x - destination[i].q).norm()
                                      : std::abs(v);
    const double weight =
        std::pow(std::pow(length, weights.p) / (weights.a_m + distance), weights.b);  // (5.4)
    d_sum += weight * (x_source - x);
    weight_sum += weight;
  }
  return x + d_sum / weight_sum;
}

Vector2 carry(const Vector2& mark, const std::vector<FeatureLine>& destination,
              const std::vector<FeatureLine>& source, const FieldWeights& weights) {
  constexpr double enough_m = 1e-7;
  constexpr double step_m = 1e-5;
  constexpr double max_length_m = 50e-3;
  // Warping with exchanged roles of the lines gives a start near the solution.
  Vector2 best = warp(mark, source, destination, weights);
  double best_off = (warp(best, destination, source, weights) - mark).norm();
  Vector2 x = best;
  for (int round = 0; round < 30 && best_off > enough_m; ++round) {
    const Vector2 here = warp(x, destination, source, weights);
    Eigen::Matrix2d slope;
    for (Eigen::Index axis = 0; axis < 2; ++axis) {
      const Vector2 aside = x + step_m * Vector2::Unit(axis);
      slope.col(axis) = (warp(aside, destination, source, weights) - here) / step_m;
    }
    if (std::abs(slope.determinant()) < 1e-3) break;
    Vector2 step = slope.inverse() * (mark - here);
    if (step.norm() > max_length_m) step *= max_length_m / step.norm();
    x += step;
    const double off = (warp(x, destination, source, weights) - mark).norm();
    if (off < best_off) {
      best_off = off;
      best = x;
    }
  }
  return best;
}

}  // namespace tuina::body
