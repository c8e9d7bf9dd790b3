// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "tuina/body/back_surface.hpp"
#include "tuina/core/geometry.hpp"
#include "tuina/core/result.hpp"

namespace tuina::massage {

/// A curve on the skin, smooth to its second derivative, walked by its own length: cubic B-splines
/// of place and normal through lifted points, [eilers1996]. The knots stand about 15 mm apart,
/// wider than the roughness of a scan and closer than the curves of a back.
class SurfaceCurve {
 public:
  /// `lifted` are at least four points of the skin a few millimetres apart, in order; a closed
  /// curve does not repeat the first one.
  SurfaceCurve(std::span<const body::SurfacePoint> lifted, bool closed);

  [[nodiscard]] double length_m() const { return way_m_.back(); }
  /// Whether its end is its beginning.
  [[nodiscard]] bool closed() const { return closed_; }
  /// Place and unit normal after a way along the curve; a closed curve goes round again, an open
  /// one stays at its ends.
  [[nodiscard]] body::SurfacePoint at(double way_m) const;

 private:
  using Controls = Eigen::Matrix<double, Eigen::Dynamic, 6>;  // places and normals
  [[nodiscard]] Eigen::Matrix<double, 1, 6> value(double u) const;
  [[nodiscard]] Vector3 slope(double u) const;

  bool closed_;
  int spans_;
  Controls controls_;
  std::vector<double> way_m_;  // lengths from the start to evenly spaced parameters
};

/// Brings a guide line onto the person's skin: each guide point is looked for along its own inward
/// direction, then next to it. Fails with what is wrong if the skin is further than 60 mm from the
/// guide, as it is beyond the rim of the scan.
[[nodiscard]] Result<std::vector<body::SurfacePoint>> lift(const body::BackSurface& back,
                                                           std::span<const Vector3> guide,
                                                           std::span<const Vector3> outward);

}  // namespace tuina::massage
