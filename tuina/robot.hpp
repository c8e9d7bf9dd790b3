// SPDX-License-Identifier: Apache-2.0
#pragma once

/// @file
/// Room robot: arms as tables: kinematics, dynamics, and the interface of two that massage.

#include "tuina/robot/arm_model.hpp"
#include "tuina/robot/arm_table.hpp"
#include "tuina/robot/clearance.hpp"
#include "tuina/robot/description.hpp"
#include "tuina/robot/inverse_kinematics.hpp"
#include "tuina/robot/mount.hpp"
#include "tuina/robot/position_drives.hpp"
#include "tuina/robot/ready_posture.hpp"
#include "tuina/robot/robot.hpp"
#include "tuina/robot/robot_model.hpp"
#include "tuina/robot/table/read_urdf.hpp"
#include "tuina/robot/table/robot_table.hpp"
#include "tuina/robot/virtual_arm.hpp"
