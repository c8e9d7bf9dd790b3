// SPDX-License-Identifier: Apache-2.0
#include "tuina/telemetry/plot/svg_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "tuina/telemetry/plot/svg_parts.hpp"

namespace tuina::telemetry {
namespace {

struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();

  void extend(const std::vector<double>& values) {
    for (const double value : values) {
      if (!std::isfinite(value)) continue;
      low = std::min(low, value);
      high = std::max(high, value);
    }
  }
  /// Never empty, whatever the data.
  void settle(std::optional<double> fixed_low, std::optional<double> fixed_high, double margin) {
    if (low > high) {
      low = 0.0;
      high = 1.0;
    }
    if (high - low < 1e-12 * std::max(1.0, std::abs(high))) {
      low -= 0.5;
      high += 0.5;
    }
    const double spare = margin * (high - low);
    low = fixed_low.value_or(low - spare);
    high = fixed_high.value_or(high + spare);
    if (!(high > low)) high = low + 1.0;
  }
};

/// The frame of a plot in pixels and the way from data to it.
struct Frame {
  double left, top, width, height;
  Range x, y;
  [[nodiscard]] double px(double value) const {
    return left + width * (value - x.low) / (x.high - x.low);
  }
  [[nodiscard]] double py(double value) const {
    return top + height * (y.high - value) / (y.high - y.low);
  }
};

/// The stretch of a series between two interruptions, in pixels. Within one pixel column the first,
/// lowest, highest and last point stay: what is left looks the same and its extremes are true.
std::string path_of(const Series& series, const Frame& frame) {
  std::string d;
  char pen = 'M';
  const auto put = [&](double x, double y) {
    d += fmt::format("{}{:.1f} {:.1f}", pen, x, y);
    pen = 'L';
  };
  std::size_t k = 0;
  while (k < series.x.size()) {
    if (!std::isfinite(series.x[k]) || !std::isfinite(series.y[k])) {
      pen = 'M';
      ++k;
      continue;
    }
    const double column = std::floor(frame.px(series.x[k]));
    std::size_t end = k;
    std::size_t lowest = k;
    std::size_t highest = k;
    while (end < series.x.size() && std::isfinite(series.x[end]) && std::isfinite(series.y[end]) &&
           std::floor(frame.px(series.x[end])) == column) {
      if (series.y[end] < series.y[lowest]) lowest = end;
      if (series.y[end] > series.y[highest]) highest = end;
      ++end;
    }
    std::vector<std::size_t> keep = {k, lowest, highest, end - 1};
    std::sort(keep.begin(), keep.end());
    keep.erase(std::unique(keep.begin(), keep.end()), keep.end());
    for (const std::size_t point : keep) put(frame.px(series.x[point]), frame.py(series.y[point]));
    k = end;
  }
  return d;
}

std::string axes(const Plot& plot, const Frame& frame) {
  std::string svg;
  const auto y_ticks =
      ticks(frame.y.low, frame.y.high, std::max(3, static_cast<int>(frame.height / 38)));
  const auto x_ticks = (plot.x_counts ? whole_ticks : ticks)(
      frame.x.low, frame.x.high, std::max(3, static_cast<int>(frame.width / 80)));
  for (const double value : y_ticks) {
    svg += fmt::format("<path d=\"M{:.1f} {:.1f}h{:.1f}\" stroke=\"{}\"/>", frame.left,
                       frame.py(value), frame.width,
                       css(std::abs(value) < 1e-12 ? palette::grey : palette::hairline));
    svg += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"end\">{}</text>",
                       frame.left - 7, frame.py(value) + 4, tick_text(value, y_ticks));
  }
  for (const double value : x_ticks) {
    svg += fmt::format("<path d=\"M{:.1f} {:.1f}v4\" stroke=\"{}\"/>", frame.px(value),
                       frame.top + frame.height, css(palette::grey));
    svg += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>",
                       frame.px(value), frame.top + frame.height + 17, tick_text(value, x_ticks));
  }
  svg +=
      fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"end\">{}</text>",
                  frame.left + frame.width, frame.top + frame.height + 33, escaped(plot.x_label));
  svg += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\">{}</text>", frame.left - 34, 12.0,
                     escaped(plot.y_label));
  return svg;
}

struct Entry {
  std::string name;
  Colour colour;
  bool dots, dashed, band;
};

constexpr double key_px = 40.0, row_px = 15.0;
std::vector<Entry> entries_of(const Plot& plot) {
  std::vector<Entry> entries;
  for (const Band& band : plot.bands) {
    if (!band.name.empty()) entries.push_back({band.name, band.colour, false, false, true});
  }
  for (const Series& series : plot.series) {
    if (!series.name.empty())
      entries.push_back({series.name, series.colour, series.dots, series.dashed, false});
  }
  return entries;
}

/// What the legend needs beside the name of the y axis: a row of its own where both do not fit.
double legend_row_px(const Plot& plot) {
  double width_px = letter_px * static_cast<double>(plot.y_label.size()) + 24.0;
  for (const Entry& entry : entries_of(plot))
    width_px += letter_px * static_cast<double>(entry.name.size()) + key_px;
  return width_px > plot.width_px + key_px ? row_px : 0.0;
}

std::string legend(const Plot& plot, double right) {
  std::string svg;
  const auto entries = entries_of(plot);
  double x = right;
  for (auto entry = entries.rbegin(); entry != entries.rend(); ++entry) {
    x -= letter_px * static_cast<double>(entry->name.size());
    svg += fmt::format("<text x=\"{:.1f}\" y=\"12\">{}</text>", x, escaped(entry->name));
    const std::string colour = css(entry->colour);
    if (entry->band) {
      svg += fmt::format(
          "<rect x=\"{:.1f}\" y=\"4\" width=\"16\" height=\"9\" fill=\"{}\" fill-opacity=\".25\"/>",
          x - 22, colour);
    } else if (entry->dots) {
      svg += fmt::format("<circle cx=\"{:.1f}\" cy=\"8.5\" r=\"3\" fill=\"{}\"/>", x - 12, colour);
    } else {
      svg += fmt::format("<path d=\"M{:.1f} 8.5h18\" stroke=\"{}\" stroke-width=\"2.4\"{}/>",
                         x - 24, colour, entry->dashed ? " stroke-dasharray=\"5 3\"" : "");
    }
    x -= key_px;
  }
  const double row = legend_row_px(plot);
  return row == 0.0 ? svg : fmt::format("<g transform=\"translate(0 {:.0f})\">{}</g>", row, svg);
}

/// The frame that holds all data, or what the plot fixes.
Frame frame_of(const Plot& plot) {
  const double top = (plot.marks.empty() ? 24.0 : 40.0) + legend_row_px(plot);
  Frame frame{.left = 46,
              .top = top,
              .width = plot.width_px - 46.0 - 16.0,
              .height = plot.height_px - top - 40.0,
              .x = {},
              .y = {}};
  for (const Series& series : plot.series) {
    assert(series.x.size() == series.y.size());
    frame.x.extend(series.x);
    frame.y.extend(series.y);
  }
  for (const Band& band : plot.bands) {
    frame.x.extend(band.x);
    frame.y.extend(band.low);
    frame.y.extend(band.high);
  }
  frame.x.settle(plot.x_low, plot.x_high, 0.0);
  frame.y.settle(plot.y_low, plot.y_high, 0.06);
  return frame;
}

std::string drawn(const Band& band, const Frame& frame) {
  std::string d;
  for (std::size_t k = 0; k < band.x.size(); ++k) {
    d += fmt::format("{}{:.1f} {:.1f}", k == 0 ? 'M' : 'L', frame.px(band.x[k]),
                     frame.py(band.high[k]));
  }
  for (std::size_t k = band.x.size(); k-- > 0;)
    d += fmt::format("L{:.1f} {:.1f}", frame.px(band.x[k]), frame.py(band.low[k]));
  return fmt::format("<path d=\"{}Z\" fill=\"{}\" fill-opacity=\".2\"/>", d, css(band.colour));
}

double radius_px(const Series& series) {
  return 1.6 * series.width_px;
}

std::string drawn(const Series& series, const Frame& frame) {
  if (!series.dots)
    return fmt::format("<path d=\"{}\" stroke=\"{}\" stroke-width=\"{:.1f}\"{}/>",
                       path_of(series, frame), css(series.colour), series.width_px,
                       series.dashed ? " stroke-dasharray=\"5 3\"" : "");
  std::string svg;
  for (std::size_t k = 0; k < series.x.size(); ++k) {
    if (!std::isfinite(series.x[k]) || !std::isfinite(series.y[k])) continue;
    svg += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:.1f}\" fill=\"{}\"/>",
                       frame.px(series.x[k]), frame.py(series.y[k]), radius_px(series),
                       css(series.colour));
  }
  return svg;
}

/// The words above the hairlines. One that would cover its neighbour is left out; its hairline
/// stays.
std::string mark_words(const Plot& plot, const Frame& frame) {
  std::string svg;
  double free_from = 0.0;
  for (const Mark& mark : plot.marks) {
    const double x = frame.px(mark.x) + 3;
    if (x < free_from || x + letter_px * static_cast<double>(mark.text.size()) > plot.width_px)
      continue;
    svg += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" font-size=\"10.5\" fill=\"{}\">{}</text>",
                       x, frame.top - 4, css(palette::grey), escaped(mark.text));
    free_from = x + letter_px * static_cast<double>(mark.text.size()) + 4;
  }
  return svg;
}

}  // namespace

std::string to_svg(const Plot& plot) {
  const Frame frame = frame_of(plot);
  std::string svg = open_svg(plot.width_px, plot.height_px, plot.title) + axes(plot, frame) +
                    legend(plot, frame.left + frame.width);
  // A dot on the edge is drawn whole.
  double over_px = 0.0;
  for (const Series& series : plot.series)
    if (series.dots) over_px = std::max(over_px, radius_px(series));
  // Several drawings share a page, so the clip is an inner <svg> and needs no name.
  svg += fmt::format(
      "<svg x=\"{0:.1f}\" y=\"{1:.1f}\" width=\"{2:.1f}\" height=\"{3:.1f}\" viewBox=\"{0:.1f} "
      "{1:.1f} {2:.1f} {3:.1f}\" fill=\"none\" stroke-linejoin=\"round\">",
      frame.left - over_px, frame.top - over_px, frame.width + 2 * over_px,
      frame.height + 2 * over_px);
  for (const Band& band : plot.bands) svg += drawn(band, frame);
  for (const Mark& mark : plot.marks) {
    svg += fmt::format("<path d=\"M{:.1f} {:.1f}v{:.1f}\" stroke=\"{}\"/>", frame.px(mark.x),
                       frame.top, frame.height, css(mark.colour));
  }
  for (const Series& series : plot.series) svg += drawn(series, frame);
  return svg + "</svg>" + mark_words(plot, frame) + "</svg>";
}

std::string hardness_bar_svg(double low, double high, std::string_view label) {
  constexpr int width = 300;
  constexpr int steps = 60;
  constexpr double left = 14;
  constexpr double bar = width - 2 * left;
  std::string svg = open_svg(width, 58, label);
  svg += fmt::format("<text x=\"{}\" y=\"11\">{}</text>", left, escaped(label));
  for (int k = 0; k < steps; ++k) {
    svg += fmt::format(
        "<rect x=\"{:.2f}\" y=\"18\" width=\"{:.2f}\" height=\"14\" shape-rendering=\"crispEdges\" "
        "fill=\"{}\"/>",
        left + bar * k / steps, bar / steps + 0.3, css(hardness_colour((k + 0.5) / steps)));
  }
  const auto at = ticks(low, std::max(high, low + 1e-9), 4);
  for (const double value : at) {
    const double x = left + bar * (value - low) / std::max(high - low, 1e-9);
    svg += fmt::format(
        "<path d=\"M{:.1f} 32v4\" stroke=\"{}\"/><text x=\"{:.1f}\" y=\"49\" "
        "text-anchor=\"middle\">{}</text>",
        x, css(palette::grey), x, tick_text(value, at));
  }
  return svg + "</svg>";
}

}  // namespace tuina::telemetry
