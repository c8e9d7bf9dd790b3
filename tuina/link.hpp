// SPDX-License-Identifier: Apache-2.0
#pragma once

/// @file
/// Room link: guard and robot as processes of their own.

#include "tuina/link/guard_process.hpp"
#include "tuina/link/linked_robot.hpp"
#include "tuina/link/real_time.hpp"
#include "tuina/link/supervisor.hpp"
