// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "tuina/core/geometry.hpp"

namespace tuina::telemetry {

/// Viewpoint of a picture: an eye a few metres away, so that the perspective is gentle.
struct View {
  Vector3 toward_eye = Vector3::UnitY();
  Vector3 up = Vector3::UnitZ();
  double distance_m = 3.0;
  int width_px = 900;  ///< the picture is as large as the surface needs, within width and height
  int height_px = 1100;
  double margin_px = 12.0;
};

/// Where a place of the world is in a picture, so that labels find their point.
class Projection {
 public:
  /// Shows all of these places from this side.
  Projection(const View& view, const std::vector<Vector3>& seen);

  /// x right and y down in pixels; z is the height towards the eye, in metres.
  [[nodiscard]] Vector3 operator()(const Vector3& place) const;
  /// The axes of the picture: x right, y up, z towards the eye, in metres from what it shows.
  [[nodiscard]] Vector3 in_view(const Vector3& place) const;
  /// From the eye through a point of the picture, in the axes of the picture; one metre deep.
  [[nodiscard]] Vector3 ray(double column, double row) const;
  [[nodiscard]] double distance_m() const { return distance_m_; }  ///< distance of the eye
  /// A direction of the world along the axes of the picture.
  [[nodiscard]] Vector3 turned(const Vector3& direction) const {
    return view_from_world_ * direction;
  }
  /// @{
  /// Scale in the middle of the picture, and its size.
  [[nodiscard]] double px_per_m() const { return scale_ / distance_m_; }
  [[nodiscard]] int width_px() const { return width_px_; }
  [[nodiscard]] int height_px() const { return height_px_; }
  /// @}

 private:
  Matrix3 view_from_world_ = Matrix3::Identity();
  Vector3 centre_ = Vector3::Zero();
  double distance_m_ = 1.0;
  double scale_ = 1.0;
  Vector2 shift_px_ = Vector2::Zero();
  int width_px_ = 1;
  int height_px_ = 1;
};

}  // namespace tuina::telemetry
