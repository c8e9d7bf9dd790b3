// SPDX-License-Identifier: Apache-2.0
#include "tuina/telemetry/plot/heat_map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tuina/telemetry/plot/svg_plot.hpp"

namespace tuina::telemetry {
namespace {

constexpr double cell_width = 52.0, cell_height = 30.0, above = 34.0, below = 46.0;

/// Room for the longest of the ticks beside the rows.
double left_of(const HeatMap& map) {
  std::size_t letters = 0;
  for (const std::string& tick : map.y_ticks) letters = std::max(letters, tick.size());
  return std::max(62.0, letter_px * static_cast<double>(letters) + 16.0);
}

double width_of(const HeatMap& map) {
  return left_of(map) + cell_width * static_cast<double>(map.x_ticks.size()) + 24.0;
}

double height_of(const HeatMap& map) {
  return above + cell_height * static_cast<double>(map.y_ticks.size()) + below;
}

std::string value_text(double value) {
  if (std::isinf(value)) return "stop";
  if (value < 0.095) return "0.0";
  return value < 9.95 ? fmt::format("{:.1f}", value) : fmt::format("{:.0f}", value);
}

std::string text_at(double x, double y, const char* anchor, const std::string& fill,
                    std::string_view text) {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\" fill=\"{}\">{}</text>", x,
                     y, anchor, fill, escaped(text));
}

std::string cells(const HeatMap& map) {
  std::string svg;
  const std::size_t columns = map.x_ticks.size(), rows = map.y_ticks.size();
  const double left = left_of(map);
  for (std::size_t row = 0; row < rows; ++row) {
    const double y = above + cell_height * static_cast<double>(rows - 1 - row);
    for (std::size_t column = 0; column < columns; ++column) {
      const double value = map.values[row * columns + column];
      const double x = left + cell_width * static_cast<double>(column);
      if (std::isnan(value)) continue;
      const double share =
          std::log(std::max(value, map.calm) / map.calm) / std::log(map.wild / map.calm);
      // The lightest fifth of the scale is a yellow that glares beside white paper.
      const Colour colour =
          share <= 0.0 ? Colour{236, 242, 238} : hardness_colour(0.15 + 0.8 * std::min(share, 1.0));
      svg += fmt::format(
          "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"{}\"/>", x + 1,
          y + 1, cell_width - 2, cell_height - 2, css(colour));
      const bool dark = share > 0.42;
      svg += text_at(x + cell_width / 2, y + cell_height / 2 + 4, "middle",
                     css(dark ? palette::paper : palette::ink), value_text(value));
    }
    svg += text_at(left - 8, y + cell_height / 2 + 4, "end", css(palette::grey), map.y_ticks[row]);
  }
  const double under = above + cell_height * static_cast<double>(rows);
  for (std::size_t column = 0; column < columns; ++column) {
    svg += text_at(left + cell_width * (static_cast<double>(column) + 0.5), under + 16, "middle",
                   css(palette::grey), map.x_ticks[column]);
  }
  svg += text_at(left + cell_width * static_cast<double>(columns), under + 36, "end",
                 css(palette::grey), map.x_label);
  svg += text_at(4, 12, "start", css(palette::ink), map.title);
  svg += text_at(4, 27, "start", css(palette::grey), map.y_label);
  return svg;
}

}  // namespace

std::string to_svg(const std::vector<HeatMap>& maps) {
  double width = 0.0, height = 0.0;
  std::string inside;
  for (const HeatMap& map : maps) {
    inside += fmt::format("<g transform=\"translate({:.0f} 0)\">{}</g>\n", width, cells(map));
    width += width_of(map);
    height = std::max(height, height_of(map));
  }
  return fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" height=\"{1:.0f}\" viewBox=\"0 "
      "0 "
      "{0:.0f} {1:.0f}\" role=\"img\" font-family=\"Inter,system-ui,-apple-system,'Segoe "
      "UI',Helvetica,Arial,sans-serif\" font-size=\"11.5\">\n{2}</svg>\n",
      width, height, inside);
}

}  // namespace tuina::telemetry
