// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tuina/robot/description.hpp"
#include "tuina/robot/inverse_kinematics.hpp"

namespace tuina::robot {

/// Where a marker of a robot is, and how every joint moves it: waist, base and wheels included, one
/// column a part. `ArmModel` knows one arm and is for the millisecond; this knows all of a robot
/// and is for planning.
struct MarkerKinematics {
  Transform base_from_marker;
  Eigen::Matrix<double, 6, Eigen::Dynamic> jacobian;  ///< rows 0-2 velocity, 3-5 angular velocity
};
[[nodiscard]] MarkerKinematics kinematics_of(const Description& robot, const std::vector<double>& q,
                                             const Marker& marker);
[[nodiscard]] const Marker* find_marker(const Description& robot, const std::string& name);

/// Joint values that put both tools, or one, on the skin.
struct WholePosture {
  std::vector<double> q;
  bool reached = false;
  double worst_m = 0.0;         ///< from the goals
  double worst_tilt_rad = 0.0;  ///< of a tool's axis from the normal
};

/// From `q`, by the joints named in `moving` (a name is that of a part or begins it: "waist",
/// "left_"), the others standing still. Damped least squares inside the joint limits; what the
/// goals leave free stays near the middle of its range. Heap; some milliseconds.
[[nodiscard]] WholePosture reach_with(const Description& robot, std::vector<double> q,
                                      const PerArm<std::optional<ContactGoal>>& goals,
                                      double tool_radius_m, const std::vector<std::string>& moving);

}  // namespace tuina::robot
