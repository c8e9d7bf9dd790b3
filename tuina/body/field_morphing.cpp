// SPDX-License-Identifier: Apache-2.0
#include "tuina/body/field_morphing.hpp"

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

}  // namespace tuina::body
