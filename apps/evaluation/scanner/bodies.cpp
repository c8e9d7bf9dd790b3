// SPDX-License-Identifier: Apache-2.0
#include "apps/evaluation/scanner/trials.hpp"
#include "tuina/core/units.hpp"
#include "tuina/sim/person/solids.hpp"

namespace tuina::app {
namespace {

// 1 m before the scanner that looks at one who sits (sim::usual_mount).
const Vector3 place_in_couch(0.0, 0.13, 0.41);

}  // namespace

Result<BoxTrial> box_trial(const sim::LaserScannerOptions& options, std::uint64_t seed) {
  const Vector3 size_m(150.0_mm, 150.0_mm, 200.0_mm);
  auto cloud =
      scan_of_body(sim::box_mesh(place_in_couch, sim::corner_towards_y(), size_m), options, seed);
  if (!cloud) return tl::unexpected(cloud.error());
  const auto found = scanner::find_box(*cloud, size_m);
  if (!found) return tl::unexpected(found.error());
  return BoxTrial{.cloud = std::move(*cloud), .found = *found};
}

Result<SphereTrial> sphere_trial(const sim::LaserScannerOptions& options, std::uint64_t seed) {
  constexpr double radius_m = 75.0_mm;
  auto cloud = scan_of_body(sim::ball_mesh(place_in_couch, radius_m), options, seed);
  if (!cloud) return tl::unexpected(cloud.error());
  const auto found = scanner::find_sphere(*cloud, 2.0 * radius_m);
  if (!found) return tl::unexpected(found.error());
  return SphereTrial{.cloud = std::move(*cloud), .found = *found};
}

}  // namespace tuina::app
