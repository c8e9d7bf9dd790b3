// SPDX-License-Identifier: Apache-2.0
#pragma once

/// @file
/// Room core: the nouns that every room speaks, and the files that they come from.

#include "tuina/core/acupoint.hpp"
#include "tuina/core/arm.hpp"
#include "tuina/core/colour.hpp"
#include "tuina/core/contact.hpp"
#include "tuina/core/geometry.hpp"
#include "tuina/core/image.hpp"
#include "tuina/core/io/csv.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/core/io/png.hpp"
#include "tuina/core/io/surface_file.hpp"
#include "tuina/core/progress.hpp"
#include "tuina/core/random.hpp"
#include "tuina/core/result.hpp"
#include "tuina/core/ring.hpp"
#include "tuina/core/stopwatch.hpp"
#include "tuina/core/surface.hpp"
#include "tuina/core/technique.hpp"
#include "tuina/core/units.hpp"
