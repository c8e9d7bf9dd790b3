// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "tuina/core/contact.hpp"
#include "tuina/core/geometry.hpp"

namespace tuina::session {

/// One sample of a contact path in `base`, where control follows it.
struct BasePoint {
  double time_s = 0.0;                        ///< since the start of its path
  Vector3 at_in_base = Vector3::Zero();       ///< on the undeformed skin
  Vector3 normal_in_base = Vector3::UnitZ();  ///< unit, out of the body
  double force_n = 0.0;                       ///< along minus the normal, onto the person
};

/// The even samples of a contact path, brought from `couch` to `base` once.
struct BasePath {
  std::vector<BasePoint> points;  ///< two or more

  [[nodiscard]] double duration_s() const noexcept { return points.back().time_s; }
};
/// Brings a contact path from `couch` to `base`.
[[nodiscard]] BasePath in_base(const ContactPath& path, const Transform& base_from_couch);

/// A path between its samples, and how the place moves there.
struct BasePlace {
  BasePoint point;
  Vector3 velocity_in_base_m_per_s = Vector3::Zero();
};
/// Linear between the samples; before and after them it rests at the ends. Real-time.
[[nodiscard]] BasePlace place_at(const BasePath& path, double time_s) noexcept;

}  // namespace tuina::session
