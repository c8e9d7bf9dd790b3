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

/// The constants of [thesis] (5.4). The thesis prints no values; these are the middle of the ranges
/// that [beier1992] recommends, with `a` in metres: at 10 mm from a line the line holds half as
/// strongly.
struct FieldWeights {
  double a_m = 10e-3;
  double b = 1.5;
  double p = 0.5;
};

/// Field warping of one point, [thesis] (5.1)-(5.5) and Algorithm 2, [beier1992]: `destination[i]`
/// corresponds to `source[i]`; a point of the destination picture is answered by its place in the
/// source picture. Equally many lines, at least one, none of zero
/// length.
[[nodiscard]] Vector2 warp(const Vector2& x, const std::vector<FeatureLine>& destination,
                           const std::vector<FeatureLine>& source,
                           const FieldWeights& weights = {});

/// Where the picture way would put a mark of the source: the place of the destination picture that
/// `warp` answers with `mark`. The lines of the person are `destination` here, those of the
/// standard `source`. A few Newton steps; where the warp folds, the nearest they come.
[[nodiscard]] Vector2 carry(const Vector2& mark, const std::vector<FeatureLine>& destination,
                            const std::vector<FeatureLine>& source,
                            const FieldWeights& weights = {});

}  // namespace tuina::body
