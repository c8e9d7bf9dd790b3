// SPDX-License-Identifier: Apache-2.0
#include "tuina/session/base_path.hpp"

#include <algorithm>

namespace tuina::session {

BasePath in_base(const ContactPath& path, const Transform& base_from_couch) {
  BasePath moved;
  moved.points.reserve(path.points.size());
  for (const ContactPoint& point : path.points) {
    moved.points.push_back({.time_s = point.time_s,
                            .at_in_base = base_from_couch * point.at_in_couch,
                            .normal_in_base = base_from_couch.linear() * point.normal_in_couch,
                            .force_n = point.force_n});
  }
  return moved;
}

BasePlace place_at(const BasePath& path, double time_s) noexcept {
  const double spacing_s = path.points[1].time_s - path.points[0].time_s;
  const double at =
      std::clamp(time_s / spacing_s, 0.0, static_cast<double>(path.points.size() - 2));
  const auto i = static_cast<std::size_t>(at);
  const double u = std::clamp(time_s / spacing_s - static_cast<double>(i), 0.0, 1.0);
  const bool moves = time_s >= 0.0 && time_s <= path.points.back().time_s;
  const BasePoint& a = path.points[i];
  const BasePoint& b = path.points[i + 1];
  return {.point = {.time_s = time_s,
                    .at_in_base = a.at_in_base + u * (b.at_in_base - a.at_in_base),
                    .normal_in_base =
                        (a.normal_in_base + u * (b.normal_in_base - a.normal_in_base)).normalized(),
                    .force_n = a.force_n + u * (b.force_n - a.force_n)},
          .velocity_in_base_m_per_s =
              moves ? Vector3((b.at_in_base - a.at_in_base) / spacing_s) : Vector3::Zero()};
}

}  // namespace tuina::session
