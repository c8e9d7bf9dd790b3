// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "tuina/calibration/board/views.hpp"
#include "tuina/core/geometry.hpp"

namespace tuina::calibration {

/// The axis that the turntable turns about, in the frame of the camera.
struct YawAxis {
  Vector3 point_in_camera = Vector3::Zero();  ///< the point nearest to the camera
  Vector3 direction_in_camera = -Vector3::UnitY();
};

/// Fits the yaw axis from standing boards, views of one pose at several yaws. Fails, with the
/// cause, without such boards, with too small a turn, and when motor angles contradict the
/// pictures. The corners of each standing board and `camera_from_board` are brought into one order,
/// since the first corner of a chessboard is ambiguous.
[[nodiscard]] Result<YawAxis> find_yaw_axis(Views& views,
                                            std::vector<Transform>& camera_from_board);

}  // namespace tuina::calibration
