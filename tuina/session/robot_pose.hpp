// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tuina/core/acupoint.hpp"
#include "tuina/core/result.hpp"
#include "tuina/robot/arm_model.hpp"
#include "tuina/robot/touch.hpp"

namespace tuina::session {

/// Where the robot stands for the scanner, from spots that its tool has touched. The thesis
/// measures this with a tape and a camera (5.5).
struct RobotPose {
  Transform base_from_couch = Transform::Identity();
  Vector3 middle_in_couch = Vector3::Zero();  ///< mean of the spots, where the pose is known best
  Matrix3 turn_covariance_rad2 =
      Matrix3::Zero();  ///< rotation about `middle_in_couch`, axes of the couch
  Matrix3 place_covariance_m2 =
      Matrix3::Zero();             ///< covariance of `middle_in_couch`, axes of the couch
  std::vector<double> residual_m;  ///< distance between the spot and the arm's tip, for each touch

  /// Root mean square of the error that is to be expected of a place on the back.
  [[nodiscard]] double expected_error_m(const Vector3& place_in_couch) const;
};

/// Rigid motion by least squares over the centres of the sphere [arun1987], [umeyama1991]. The
/// scatter of one touch is estimated from the residuals, together with 1.5 mm believed beforehand
/// as if six more residuals had told it. Refused, naming the touch or the cause: fewer than three
/// spots, spots near one line, distances between spots that differ from those the arm measures,
/// one touch that the others contradict, a robot that leans or is on the wrong side of the surface.
[[nodiscard]] Result<RobotPose> locate_robot(std::span<const robot::Touch> touches,
                                             const PerArm<robot::ArmModel>& arms);

/// The columns of touches.csv: arm (0 left, 1 right), rail_mm, q1_deg ..., x_mm, y_mm, z_mm,
/// normal_x, normal_y, normal_z. One row a touch, so touch i stands in line i + 2.
[[nodiscard]] Result<std::vector<robot::Touch>> read_touches(const std::filesystem::path& file,
                                                             const robot::ArmTable& table);
/// The same columns of touches, written.
[[nodiscard]] std::string to_csv(std::span<const robot::Touch> touches);

/// Content of robot.toml: where the robot stands, and for people in which position.
struct PlacedRobot {
  std::string robot = "thesis";  ///< whose arms touched: a shipped robot or the file of its table
  BodyPosture position = BodyPosture::sitting;
  Transform base_from_couch = Transform::Identity();
};
/// Serialises it; reading it back gives the same place.
[[nodiscard]] std::string to_toml(const PlacedRobot& robot);
/// Unknown, missing and malformed keys are refused together, each with its line.
[[nodiscard]] Result<PlacedRobot> parse_robot_pose(std::string_view text, std::string_view name);
/// Reads such a file; fails as parse_robot_pose() does, and where there is no such file.
[[nodiscard]] Result<PlacedRobot> read_robot_pose(const std::filesystem::path& file);

}  // namespace tuina::session
