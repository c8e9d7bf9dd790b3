// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "tuina/core/acupoint.hpp"
#include "tuina/core/result.hpp"
#include "tuina/massage/back_chart.hpp"
#include "tuina/massage/programme.hpp"

namespace tuina::massage {

/// The place that one path serves: an acupoint, or the points or the line that a stroke runs along.
struct Target {
  std::string name;              ///< "BL47_L", "SI11_L to BL50_L", "scapula_R"
  std::vector<Acupoint> points;  ///< Empty for a named line.
  double side = 1.0;             ///< Positive where the path begins on the person's left.
};

/// The targets of a part in the order in which they are served; the two sides of a point follow
/// each other. Fails when the map of this back lacks a point.
[[nodiscard]] Result<std::vector<Target>> targets_of(const Part& part, const BackChart& chart,
                                                     std::span<const Acupoint> acupoints);

/// Places that the line of a stroke runs through, named or its own, from its beginning.
[[nodiscard]] std::vector<Place> places_of(const Part& stroke, const BackChart& chart, double side);

}  // namespace tuina::massage
