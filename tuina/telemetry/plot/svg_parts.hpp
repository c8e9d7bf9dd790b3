// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "tuina/telemetry/plot/colours.hpp"

/// Pieces that all SVG drawings share.
namespace tuina::telemetry {

/// Mean width of a letter at 11.5 px, for laying out.
inline constexpr double letter_px = 6.3;

/// Text as it may stand in HTML and SVG, in content and in attributes.
[[nodiscard]] std::string escaped(std::string_view text);

/// A vertical hairline with a word above the plot.
struct Mark {
  double x = 0.0;
  std::string text;
  Colour colour = palette::hairline;
};

/// The beginning of a drawing; the title is read out by screen readers and shown by no one.
[[nodiscard]] std::string open_svg(int width, int height, std::string_view title);

/// Round numbers from at or above low to at or below high, about `wanted` of them.
[[nodiscard]] std::vector<double> ticks(double low, double high, int wanted);
/// The same of whole numbers only, for an axis that counts things.
[[nodiscard]] std::vector<double> whole_ticks(double low, double high, int wanted);

/// With as many decimals as the distance between ticks needs.
[[nodiscard]] std::string tick_text(double value, const std::vector<double>& ticks);

}  // namespace tuina::telemetry
