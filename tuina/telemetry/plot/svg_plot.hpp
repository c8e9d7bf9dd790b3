// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tuina/telemetry/plot/colours.hpp"
#include "tuina/telemetry/plot/svg_parts.hpp"

namespace tuina::telemetry {

/// One line, or cloud of dots, of a plot. A value that is not a number interrupts the line.
struct Series {
  std::string name;  ///< word in the legend; empty: none
  std::vector<double> x = {};
  std::vector<double> y = {};
  Colour colour = palette::ink;
  double width_px = 1.6;
  bool dots = false;
  bool dashed = false;
};

/// The area between two curves.
struct Band {
  std::string name;
  std::vector<double> x = {};
  std::vector<double> low = {};
  std::vector<double> high = {};
  Colour colour = palette::grey;
};

/// Curves over one axis.
struct Plot {
  std::string title;    ///< read out by screen readers and shown by no one
  std::string x_label;  ///< quantity and unit: "time, s"
  std::string y_label;
  std::vector<Series> series = {};
  std::vector<Band> bands = {};
  std::vector<Mark> marks = {};
  std::optional<double> x_low = {}, x_high = {}, y_low = {},
                        y_high = {};  ///< ends of the axes; none: those of the data
  bool x_counts = false;  ///< x counts things, such as sessions: there is no half of one
  int width_px = 760;
  int height_px = 260;
};

/// A whole `<svg>` element: no script, no file beside it, readable in print. A line with more
/// points than pixels is thinned so that every extreme stays.
[[nodiscard]] std::string to_svg(const Plot& plot);

/// The scale of `hardness_colour` from low to high.
[[nodiscard]] std::string hardness_bar_svg(double low, double high, std::string_view label);

}  // namespace tuina::telemetry
