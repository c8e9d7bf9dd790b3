// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "tuina/telemetry/plot/colours.hpp"
#include "tuina/telemetry/plot/svg_parts.hpp"

namespace tuina::telemetry {

/// A stretch of time in a row.
struct Span {
  double begin_s = 0.0;
  double end_s = 0.0;
  std::string text;  ///< shown where there is room, and when pointed at
  Colour colour;
  bool thin = false;  ///< a line through the middle of the row, for what matters less
};

/// What one thing does over time.
struct TimelineRow {
  std::string name;
  std::vector<Span> spans = {};
};

/// Rows over one axis of time.
struct Timeline {
  std::string title;
  std::string x_label = "time, s";
  double end_s = 0.0;
  std::vector<TimelineRow> rows = {};
  std::vector<Mark> marks = {};  ///< x in seconds
  int width_px = 1000;
};

/// A whole `<svg>` element: no script, no file beside it, readable in print.
[[nodiscard]] std::string to_svg(const Timeline& timeline);

}  // namespace tuina::telemetry
