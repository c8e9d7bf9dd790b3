// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace tuina::app {

/// A target that walks out of the arm's reach: what a law asks of the joints then.
struct BeyondReach {
  std::string law;
  double max_torque_nm = 0.0;  ///< of a joint, gravity included
  double max_speed_rad_per_s = 0.0;
  bool survived = true;  ///< no torque above 10^6 Nm and every number finite
};

/// Cartesian laws on the model itself, without a person: the target goes 0.2 m beyond the stretched
/// arm at 0.1 m/s. (3.5) is tried with J^-1 as it is printed and with the damped inverse.
[[nodiscard]] std::vector<BeyondReach> pull_beyond_reach();

/// The largest force along the normal that the drives can hold, gravity included, over a seated
/// person's back patch 0.45 m tall and as wide as each arm's half plus 30 mm.
struct ForceAtTool {
  int places = 0, reached = 0;
  double min_n = 0.0, median_n = 0.0;
  double reach_m = 0.0;  ///< of the stretched arm
};
[[nodiscard]] ForceAtTool force_at_tool();

}  // namespace tuina::app
