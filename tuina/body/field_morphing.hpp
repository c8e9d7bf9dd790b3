// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "tuina/core/geometry.hpp"

namespace tuina::body {

/// A feature line on the plane of the back, from P to Q.
struct FeatureLine {
  Vector2 p = Vector2::Zero();
  Vector2 q = Vector2::Zero();
};

/// Constants of [thesis] (5.4). The thesis prints no values; these are the middle of the ranges in
/// [beier1992], with `a` in metres: at 10 mm from a line its influence is halved.
struct FieldWeights {
  double a_m = 10e-3;
  double b = 1.5;
  double p = 0.5;
};

/// Field warping of one point, [thesis] (5.1)-(5.5) and Algorithm 2, [beier1992]: maps a point of
/// the destination picture to the source picture, where `destination[i]` corresponds to
/// `source[i]`. Both need equally many lines, at least one, none of zero length.
[[nodiscard]] Vector2 warp(const Vector2& x, const std::vector<FeatureLine>& destination,
                           const std::vector<FeatureLine>& source,
                           const FieldWeights& weights = {});

/// Inverse of `warp`: the point of the destination picture (the person) that `warp` maps to `mark`
/// in the source (the standard). A few Newton steps; where the warp folds, the closest point they
/// reach.
[[nodiscard]] Vector2 carry(const Vector2& mark, const std::vector<FeatureLine>& destination,
                            const std::vector<FeatureLine>& source,
                            const FieldWeights& weights = {});

}  // namespace tuina::body
