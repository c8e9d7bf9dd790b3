// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tuina/core/arm.hpp"
#include "tuina/core/result.hpp"

namespace tuina::hardware {

/// What a wrist sensor says when nothing touches the tool: its own offset, and the weight of all
/// that hangs behind it.
struct WristCalibration {
  double mass_kg = 0.0;
  Vector3 com_in_tool_m = Vector3::Zero();
  Wrench offset_in_tool;

  /// The weight alone, about the origin of the tool, as the tool stands.
  [[nodiscard]] Wrench weight_in_tool(const Matrix3& base_from_tool) const noexcept;
};

/// One way the tool stood with nothing touching it, and what its sensor said.
struct WristPose {
  Matrix3 base_from_tool = Matrix3::Identity();
  Wrench in_tool;
};

/// What `fit_wrist` finds, with its errors.
struct WristFit {
  WristCalibration found;
  double mass_sd_kg = 0.0, com_sd_m = 0.0, offset_sd_n = 0.0, offset_sd_nm = 0.0;
  double force_rms_n = 0.0, torque_rms_nm = 0.0;  ///< what the fit leaves
  double max_force_n = 0.0;                       ///< left in one pose
  double condition = 0.0;  ///< of the least squares with unit weight; 2 is good, beyond 20 refused
};

/// Linear least squares over f = f0 + W d and t = t0 + W c x d, where d is the direction of gravity
/// in the tool. Fails with Fault::bad_input, naming the line of touches or the cause: fewer than
/// six poses, poses that do not determine it, one pose that the others contradict, no weight, a
/// weight that pulls upward. Pose i stands in line i + 2.
[[nodiscard]] Result<WristFit> fit_wrist(std::span<const WristPose> poses);

/// A table of poses: the columns qw, qx, qy, qz (the turn from tool to base, a unit quaternion),
/// force_x_n to force_z_n, torque_x_nm to torque_z_nm.
[[nodiscard]] Result<std::vector<WristPose>> read_wrist_poses(const std::filesystem::path& file);

/// @{
/// Content of the file that `calibration` in a device file names; `name` is the file's, for errors.
[[nodiscard]] std::string to_toml(const WristCalibration& calibration);
[[nodiscard]] Result<WristCalibration> parse_wrist_calibration(std::string_view text,
                                                               std::string_view name);
/// @}

}  // namespace tuina::hardware
