// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "tuina/core/result.hpp"
#include "tuina/robot/arm_table.hpp"

namespace tuina::robot {

/// The arm of a URDF file between two of its links.
struct UrdfArm {
  std::string robot;  ///< name of the robot in the file
  ArmTable table;
  Transform link_from_shoulder = Transform::Identity();  ///< DH frame 0 in the base link
  /// What was taken otherwise than it stands in the file, for people; empty where nothing was.
  std::string note;
};

/// Reads the chain from `base_link` to `tip_link`, whose origin is the centre of the sphere and
/// whose x axis points out of the handle. Joints between them that are fixed belong to their link,
/// and so does what hangs from a link before the tip; beyond the tip is the sphere.
/// The Denavit-Hartenberg rows that any chain of turning joints has are found from the joints'
/// axes, which count as parallel up to a sine of 1e-4, the rounding of angles; the tool keeps its
/// own turn. Rotors are not in URDF: zero; radii are 50 mm and the sphere
/// weighs 0.16 kg, to be mended in the table. Refused with line, element and value: other than six
/// or seven turning joints, sliding ones, joints without limits or axis, inertias that are not
/// numbers.
[[nodiscard]] Result<UrdfArm> read_urdf(std::string_view text, std::string_view name,
                                        const std::string& base_link, const std::string& tip_link);

}  // namespace tuina::robot
