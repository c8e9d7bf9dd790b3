// SPDX-License-Identifier: Apache-2.0
#pragma once

/// @file
/// Room control: from a contact path to torques, a thousand times a second.

#include "tuina/control/arm_controller.hpp"
#include "tuina/control/cartesian_impedance.hpp"
#include "tuina/control/force_target.hpp"
#include "tuina/control/friction.hpp"
#include "tuina/control/joint_follower.hpp"
#include "tuina/control/late_force.hpp"
#include "tuina/control/motion_profile.hpp"
#include "tuina/control/skin_slope.hpp"
