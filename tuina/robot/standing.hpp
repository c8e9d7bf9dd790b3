// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tuina/robot/description.hpp"

namespace tuina::robot {

enum class Kind : std::uint8_t { thesis, successor };
[[nodiscard]] constexpr const char* name_of(Kind kind) {
  return kind == Kind::thesis ? "thesis" : "successor";
}
[[nodiscard]] std::optional<Kind> parse_kind(std::string_view name);

/// A robot as it stands for a person.
struct Standing {
  Kind kind = Kind::thesis;
  ArmTable arm;
  RobotMount mount;
  double waist_pitch_rad = 0.0;  ///< of the successor
};

/// The thesis' robot as `mount_for` puts it. The successor bends over its waist: sitting, it stands
/// behind the person; prone, before the head, its base under the bed. Its linear base is the way
/// ahead of its wheels. In both the left arm is the one on the side of the couch's positive x.
[[nodiscard]] Standing stand(Kind kind, Position position, bool head_at_plus_y = false);

/// The whole of it in `base` with what it stands around, and where its joints are: those of the
/// arms at zero, those of the rest held there by their drives.
struct WholeRobot {
  Description description;
  std::vector<double> q;
  std::string rail;  ///< the part that is the linear base
};
[[nodiscard]] WholeRobot whole_of(const Standing& standing, const PerArm<ArmTable>& arms);

}  // namespace tuina::robot
