// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>

#include "tuina/core/acupoint.hpp"
#include "tuina/core/result.hpp"
#include "tuina/core/surface.hpp"

namespace tuina::body {

/// A place on the smoothed skin.
struct SurfacePoint {
  Vector3 at_in_couch = Vector3::Zero();
  Vector3 normal_in_couch = Vector3::UnitZ();  ///< unit, out of the body, smoothed over about 15 mm
  double distance_m = 0.0;                     ///< from what was asked
};

/// The person's skin as the scanner saw it: the cleaned cloud, evenly thinned, with outward
/// normals, and smoothed places between its points (moving least squares). Cheap to move; every
/// question is const and may be asked from several threads.
class BackSurface {
 public:
  /// `cloud_in_couch` has normals. `fit_back` is the usual way to one.
  BackSurface(PointCloud cloud_in_couch, Position position, double spacing_m);
  BackSurface(BackSurface&&) noexcept;
  BackSurface& operator=(BackSurface&&) noexcept;
  ~BackSurface();

  /// The smoothed surface next to a place; beyond the rim of the scan, the rim.
  [[nodiscard]] SurfacePoint nearest(const Vector3& place_in_couch) const;

  /// Where a ray first meets the smoothed surface, within 3 m; nothing if it passes by.
  [[nodiscard]] std::optional<SurfacePoint> along(const Vector3& origin_in_couch,
                                                  const Vector3& direction_in_couch) const;

  /// The index of the nearest point of the cloud.
  [[nodiscard]] std::size_t closest(const Vector3& place_in_couch) const;

  [[nodiscard]] Position position() const;
  [[nodiscard]] const PointCloud& points() const;
  [[nodiscard]] double spacing_m() const;  ///< typical distance of neighbouring points

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

/// How far the person is turned about the vertical from the usual pose on the couch, in radians:
/// found from the skin alone, so that it turns with the person exactly. A lying person's head may
/// be at either end; the answer is within a quarter turn of the usual pose.
[[nodiscard]] double heading(const PointCloud& back_in_couch, Position position);

struct BackOptions {
  std::optional<Position> position;  ///< recognised from the scan when absent
};

/// Finds the person in a scan: couch, chair, bed and what does not hang together with the person
/// are removed, the position is recognised, normals are found. Fails with the cause and the number
/// when there is no person, less than a back, more than one person, or the cloud is not in metres.
[[nodiscard]] Result<BackSurface> fit_back(const PointCloud& scan_in_couch,
                                           const BackOptions& options = {});

}  // namespace tuina::body
