// SPDX-License-Identifier: Apache-2.0
#pragma once

/// @file
/// Room scanner: from pictures of a laser line to a cloud.

#include "tuina/scanner/calibration.hpp"
#include "tuina/scanner/camera.hpp"
#include "tuina/scanner/check/check_box.hpp"
#include "tuina/scanner/check/check_sphere.hpp"
#include "tuina/scanner/check/expected_error.hpp"
#include "tuina/scanner/line/laser_line.hpp"
#include "tuina/scanner/recording.hpp"
#include "tuina/scanner/sweep.hpp"
#include "tuina/scanner/triangulation.hpp"
#include "tuina/scanner/turntable.hpp"
