// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace tuina::telemetry {

/// One value for each pair of two lists: a map of cells, each with its value written in it.
struct HeatMap {
  std::string title;
  std::string x_label, y_label;
  std::vector<std::string> x_ticks, y_ticks;  ///< y from below to above
  std::vector<double> values;  ///< row by row from below; NaN is blank, infinity says `stop`
  double calm = 0.3;   ///< values up to here are light, from `wild` on dark, in between by their
  double wild = 30.0;  ///< logarithm
};

/// Maps side by side, each an `<svg>` of its own inside one.
[[nodiscard]] std::string to_svg(const std::vector<HeatMap>& maps);

}  // namespace tuina::telemetry
