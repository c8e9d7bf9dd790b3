// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "tuina/body/back_surface.hpp"

namespace tuina::baselines {

/// A path as the method before the thesis made it ([thesis] 5.5, Fig. 5-12): its features are two
/// planes fitted to the upper and the lower back, straight lines between the places run on them,
/// and each place of the path is the nearest point of the scan, as it was measured. The thesis
/// prints no more of that method than this. Places are `step_m` apart on the planes.
[[nodiscard]] std::vector<Vector3> two_plane_path(const PointCloud& scan_in_couch,
                                                  const body::BackSurface& back,
                                                  std::span<const Vector3> places_in_couch,
                                                  double step_m);

/// How tortuous a path is that is run through at one speed: the mean square of its third difference
/// in time, m2/s6. `path` is first laid out evenly along its length, so that only its shape counts.
[[nodiscard]] double mean_square_jerk(std::span<const Vector3> path, double speed_m_per_s,
                                      double every_s = 0.02);

}  // namespace tuina::baselines
