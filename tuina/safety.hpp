// SPDX-License-Identifier: Apache-2.0
#pragma once

/// @file
/// Room safety: what stands between a controller and the person.

#include "tuina/safety/arm_separation.hpp"
#include "tuina/safety/guard.hpp"
#include "tuina/safety/limits.hpp"
#include "tuina/safety/robot_guard.hpp"
#include "tuina/safety/zone_field.hpp"
