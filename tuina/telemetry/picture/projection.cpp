// SPDX-License-Identifier: Apache-2.0
#include "tuina/telemetry/picture/projection.hpp"

#include <algorithm>
#include <cmath>

namespace tuina::telemetry {

Projection::Projection(const View& view, const std::vector<Vector3>& seen)
    : distance_m_(view.distance_m) {
  const Vector3 forward = view.toward_eye.normalized();
  const Vector3 right = view.up.cross(forward).normalized();
  view_from_world_ << right.transpose(), forward.cross(right).transpose(), forward.transpose();
  Eigen::AlignedBox3d around;
  for (const Vector3& place : seen) around.extend(place);
  if (!seen.empty()) centre_ = around.center();
  // The eye stays well in front of whatever is seen.
  distance_m_ = std::max(distance_m_, 1.2 * around.sizes().norm());
  Eigen::AlignedBox2d on_screen;
  for (const Vector3& place : seen) {
    const Vector3 p = view_from_world_ * (place - centre_);
    on_screen.extend(Vector2(p.x(), -p.y()) / (distance_m_ - p.z()));
  }
  const Vector2 size = seen.empty() ? Vector2(1, 1) : Vector2(on_screen.sizes().cwiseMax(1e-9));
  scale_ = std::min((view.width_px - 2 * view.margin_px) / size.x(),
                    (view.height_px - 2 * view.margin_px) / size.y());
  if (!seen.empty()) shift_px_ = Vector2::Constant(view.margin_px) - scale_ * on_screen.min();
  width_px_ = static_cast<int>(std::ceil(scale_ * size.x() + 2 * view.margin_px));
  height_px_ = static_cast<int>(std::ceil(scale_ * size.y() + 2 * view.margin_px));
}

Vector3 Projection::in_view(const Vector3& place) const {
  return view_from_world_ * (place - centre_);
}

Vector3 Projection::ray(double column, double row) const {
  const Vector2 at = (Vector2(column, row) - shift_px_) / scale_;
  return {at.x(), -at.y(), -1.0};
}

Vector3 Projection::operator()(const Vector3& place) const {
  const Vector3 p = in_view(place);
  const Vector2 at = shift_px_ + scale_ * Vector2(p.x(), -p.y()) / (distance_m_ - p.z());
  return {at.x(), at.y(), p.z()};
}

}  // namespace tuina::telemetry
