// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "apps/tuina/mount/plate.hpp"
#include "tuina/core/units.hpp"

namespace tuina::app {

/// What carries the parts of a scanner (docs/build_a_scanner.md).
struct MountSizes {
  double baseline_m = 200.0_mm;  ///< from the camera's lens to where the laser's beam begins
  double lean_rad = 17.0_deg;    ///< of the laser towards the camera
  double laser_diameter_m = 9.0_mm;
  double thickness_m = 6.0_mm;
  double play_m = 0.2_mm;  ///< between what is put into each other
};

/// The bar on the motor's horn with camera and laser at its ends; two rings that stand in it and
/// hold the laser; the shelf in which the motor sits. In that order, to be printed flat.
[[nodiscard]] std::vector<Plate> scanner_mount(const MountSizes& sizes);

}  // namespace tuina::app
