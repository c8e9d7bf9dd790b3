// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "tuina/core/units.hpp"
#include "tuina/sim/laser_scanner.hpp"
#include "tuina/sim/ray_scene.hpp"

namespace tuina::sim {

ScanTruth compare_with_truth(const PointCloud& cloud_in_couch, const Mesh& skin_in_couch) {
  constexpr double couch_top_m = 15.0_mm;
  constexpr double outlier_m = 5.0_mm;
  const RayScene skin(skin_in_couch);
  ScanTruth truth;
  double sum2 = 0.0;
  for (const Vector3& point : cloud_in_couch.points) {
    if (point.z() < couch_top_m) continue;
    const double distance_m = skin.distance_to(point);
    sum2 += distance_m * distance_m;
    truth.worst_error_m = std::max(truth.worst_error_m, distance_m);
    ++truth.points;
    truth.outliers += distance_m > outlier_m ? 1U : 0U;
  }
  if (truth.points > 0) truth.rms_error_m = std::sqrt(sum2 / static_cast<double>(truth.points));
  return truth;
}

}  // namespace tuina::sim
