// SPDX-License-Identifier: Apache-2.0
#pragma once

/// @file
/// Room ros2: a session as a node of ROS 2, without ROS.

#include "tuina/ros2/names.hpp"
#include "tuina/ros2/node.hpp"
#include "tuina/ros2/services.hpp"
