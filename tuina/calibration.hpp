// SPDX-License-Identifier: Apache-2.0
#pragma once

/// @file
/// Room calibration: from pictures of a board to a scanner's calibration.

#include "tuina/calibration/board/shots.hpp"
#include "tuina/calibration/calibrate.hpp"
