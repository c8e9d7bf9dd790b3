// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "tuina/core/result.hpp"
#include "tuina/robot/arm_table.hpp"
#include "tuina/robot/mount.hpp"
#include "tuina/safety/robot_guard.hpp"

namespace tuina::link {

/// All that a guard is told before a massage: the robot, where it stands, what surrounds it, and
/// this person's back. A session writes it once its plan is made.
struct Arming {
  robot::ArmTable arm;
  robot::RobotMount mount;
  safety::RobotGuard::Options options;
};

/// A binary file of this version, with a check sum, for its owner alone. Fails with Fault::file.
[[nodiscard]] Result<void> write_arming(const std::string& file, const Arming& arming);

/// Fails with Fault::file, Fault::bad_input where the file is cut, spoilt or of another version, or
/// where a value in it is impossible: a guard begins with what it has understood whole, or not.
[[nodiscard]] Result<Arming> read_arming(const std::string& file);

/// The same for bytes of a file that is called `name` in errors.
[[nodiscard]] Result<Arming> parse_arming(const std::string& bytes, const std::string& name);

/// One line for people: robot, surroundings, caps, cells of the back, check sum.
[[nodiscard]] std::string describe(const Arming& arming);

}  // namespace tuina::link
