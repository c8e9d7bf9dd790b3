// SPDX-License-Identifier: Apache-2.0
#pragma once

/// @file
/// Room hardware: real devices behind the interfaces of scanner and robot.

#include "tuina/hardware/analog_robot.hpp"
#include "tuina/hardware/armlink.hpp"
#include "tuina/hardware/armlink_robot.hpp"
#include "tuina/hardware/ax12_turntable.hpp"
#include "tuina/hardware/device_file.hpp"
#include "tuina/hardware/position_robot.hpp"
#include "tuina/hardware/v4l2_camera.hpp"
#include "tuina/hardware/wrist_calibration.hpp"
#include "tuina/hardware/wrist_robot.hpp"
#include "tuina/hardware/wrist_sensor.hpp"
