// SPDX-License-Identifier: Apache-2.0
#pragma once

/// @file
/// Room motion: what two arms do between contacts.

#include "tuina/motion/free_path.hpp"
#include "tuina/motion/ready_plan.hpp"
#include "tuina/motion/two_arm_schedule.hpp"
