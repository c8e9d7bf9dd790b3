// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>

#include "tuina/core/acupoint.hpp"
#include "tuina/core/result.hpp"
#include "tuina/core/surface.hpp"

namespace tuina::body {

/// A point on the smoothed skin.
struct SurfacePoint {
  Vector3 at_in_couch = Vector3::Zero();
  Vector3 normal_in_couch = Vector3::UnitZ();  ///< unit, out of the body, smoothed over about 15 mm
  double distance_m = 0.0;                     ///< distance from the query
};

/// The person's skin from a scan: cleaned cloud, evenly thinned, with outward normals, interpolated
/// by moving least squares. Cheap to move; const functions are thread-safe.
class BackSurface {
 public:
  /// `cloud_in_couch` needs normals. `fit_back` is the usual constructor.
  BackSurface(PointCloud cloud_in_couch, BodyPosture position, double spacing_m);
  BackSurface(BackSurface&&) noexcept;
  BackSurface& operator=(BackSurface&&) noexcept;
  ~BackSurface();

  /// Projection of a point onto the smoothed surface; beyond the rim of the scan, the rim.
  [[nodiscard]] SurfacePoint nearest(const Vector3& place_in_couch) const;

  /// First intersection of a ray with the smoothed surface, within 3 m.
  [[nodiscard]] std::optional<SurfacePoint> along(const Vector3& origin_in_couch,
                                                  const Vector3& direction_in_couch) const;

  /// Index of the nearest point of the cloud.
  [[nodiscard]] std::size_t closest(const Vector3& place_in_couch) const;

  [[nodiscard]] BodyPosture position() const;  ///< position that the scan was taken in
  /// Points in couch, with normals out of the body.
  [[nodiscard]] const PointCloud& points() const;
  [[nodiscard]] double spacing_m() const;  ///< typical distance of neighbouring points

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

/// Rotation of the person about the vertical from the usual pose on the couch (rad), from the skin
/// alone, so that it turns exactly with the person. Within a quarter turn, since a lying head may
/// be at either end.
[[nodiscard]] double heading(const PointCloud& back_in_couch, BodyPosture position);

/// How a back is fitted to a scan.
struct BackOptions {
  std::optional<BodyPosture> position;  ///< absent: recognised from the scan
};

/// Segments the person in a scan: removes couch, chair, bed and disconnected parts, recognises the
/// position, estimates normals. Fails with cause and number without a person, with less than a
/// back, with more than one person, or when the cloud is not in metres.
[[nodiscard]] Result<BackSurface> fit_back(const PointCloud& scan_in_couch,
                                           const BackOptions& options = {});

}  // namespace tuina::body
