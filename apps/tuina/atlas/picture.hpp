// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "tuina/body/atlas.hpp"

namespace tuina::app {

/// A row for each position as one SVG: the mean back with its acupoints, and the back two standard
/// deviations to either side along each of the first three modes.
[[nodiscard]] std::string atlas_picture(const body::Atlas& atlas);

}  // namespace tuina::app
