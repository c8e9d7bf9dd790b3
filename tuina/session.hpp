// SPDX-License-Identifier: Apache-2.0
#pragma once

/// @file
/// Room session: the method on one screen, its devices, its configuration and who watches.

#include "tuina/session/config.hpp"
#include "tuina/session/consent.hpp"
#include "tuina/session/control_loop.hpp"
#include "tuina/session/controlled_arm.hpp"
#include "tuina/session/earlier/by_hand.hpp"
#include "tuina/session/force_errors.hpp"
#include "tuina/session/lay_plan.hpp"
#include "tuina/session/live_command.hpp"
#include "tuina/session/observer.hpp"
#include "tuina/session/playback.hpp"
#include "tuina/session/realism.hpp"
#include "tuina/session/relay.hpp"
#include "tuina/session/robot_pose.hpp"
#include "tuina/session/run.hpp"
#include "tuina/session/steering.hpp"
#include "tuina/session/taught_motion.hpp"
