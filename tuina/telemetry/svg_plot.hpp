// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tuina/telemetry/colours.hpp"

namespace tuina::telemetry {

/// Text as it may stand in HTML and SVG, in content and in attributes.
[[nodiscard]] std::string escaped(std::string_view text);

/// One line, or cloud of dots, of a plot. A value that is not a number interrupts the line.
struct Series {
  std::string name;  ///< in the legend; empty for none
  std::vector<double> x = {};
  std::vector<double> y = {};
  Colour colour = palette::ink;
  double width_px = 1.6;
  bool dots = false;
  bool dashed = false;
  std::string tail = {};  ///< a word at the end of the line, upright above it
};

/// The area between two curves.
struct Band {
  std::string name;
  std::vector<double> x = {};
  std::vector<double> low = {};
  std::vector<double> high = {};
  Colour colour = palette::grey;
};

/// A vertical hairline with a word above the plot.
struct Mark {
  double x = 0.0;
  std::string text;
  Colour colour = palette::hairline;
};

struct Plot {
  std::string title;    ///< read out by screen readers and shown by no one
  std::string x_label;  ///< with its unit: "time, s"
  std::string y_label;
  std::vector<Series> series = {};
  std::vector<Band> bands = {};
  std::vector<Mark> marks = {};
  std::optional<double> x_low = {}, x_high = {}, y_low = {}, y_high = {};  ///< else from the data
  int width_px = 760;
  int height_px = 260;
};

struct Span {
  double begin_s = 0.0;
  double end_s = 0.0;
  std::string text;  ///< shown where there is room, and when pointed at
  Colour colour;
  bool thin = false;  ///< a line through the middle of the row, for what matters less
};

struct TimelineRow {
  std::string name;
  std::vector<Span> spans = {};
};

struct Timeline {
  std::string title;
  double end_s = 0.0;
  std::vector<TimelineRow> rows = {};
  std::vector<Mark> marks = {};  ///< x in seconds
  int width_px = 1000;
};

/// A whole `<svg>` element each: no script, no file beside it, readable in print. A line with more
/// points than pixels is thinned so that every extreme stays.
[[nodiscard]] std::string to_svg(const Plot& plot);
[[nodiscard]] std::string to_svg(const Timeline& timeline);

/// The scale of `hardness_colour` from low to high.
[[nodiscard]] std::string hardness_bar_svg(double low, double high, std::string_view label);

/// Round numbers from at or above low to at or below high, about `wanted` of them.
[[nodiscard]] std::vector<double> ticks(double low, double high, int wanted);

}  // namespace tuina::telemetry
