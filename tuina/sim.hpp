// SPDX-License-Identifier: Apache-2.0
#pragma once

/// @file
/// Room sim: a person, a scanner and a robot without hardware.

#include "tuina/sim/person/person.hpp"
#include "tuina/sim/person/tissue_map.hpp"
#include "tuina/sim/robot/back_contact.hpp"
#include "tuina/sim/robot/plant.hpp"
#include "tuina/sim/scanner/laser_scanner.hpp"
#include "tuina/sim/scanner/line_renderer.hpp"
#include "tuina/sim/tissue_worlds.hpp"
#include "tuina/sim/world.hpp"
