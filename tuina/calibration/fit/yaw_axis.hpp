// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "tuina/calibration/board/views.hpp"
#include "tuina/core/geometry.hpp"

namespace tuina::calibration {

struct YawAxis {
  Vector3 point_in_camera = Vector3::Zero();  ///< that nearest to the camera
  Vector3 direction_in_camera = -Vector3::UnitY();
};

/// The line that the unit turns about, from boards that stood still while it turned (views of one
/// pose at several yaws). Fails, with the cause, when there are none, when the unit hardly turned,
/// and when the angles of the motor contradict the pictures. Brings the corners of each such board
/// into one order, and `camera_from_board` with them, since a chessboard does not tell which of
/// its corners is the first.
[[nodiscard]] Result<YawAxis> find_yaw_axis(Views& views,
                                            std::vector<Transform>& camera_from_board);

}  // namespace tuina::calibration
