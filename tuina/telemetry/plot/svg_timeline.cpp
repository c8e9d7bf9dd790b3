// SPDX-License-Identifier: Apache-2.0
#include "tuina/telemetry/plot/svg_timeline.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "tuina/telemetry/plot/svg_parts.hpp"

namespace tuina::telemetry {

std::string to_svg(const Timeline& timeline) {
  constexpr double row_px = 34;
  constexpr double bar_px = 22;
  constexpr double thin_px = 4;
  constexpr double left = 76;
  const double width = timeline.width_px - left - 14.0;
  const double top = timeline.marks.empty() ? 8.0 : 24.0;
  const double bottom = top + row_px * static_cast<double>(timeline.rows.size());
  const double end_s = std::max(timeline.end_s, 1e-3);
  const auto px = [&](double time_s) {
    return left + width * std::clamp(time_s / end_s, 0.0, 1.0);
  };
  std::string svg = open_svg(timeline.width_px, static_cast<int>(bottom + 42), timeline.title);
  const auto at = ticks(0.0, end_s, std::max(3, static_cast<int>(width / 90)));
  for (const double time_s : at) {
    svg += fmt::format("<path d=\"M{:.1f} {:.1f}V{:.1f}\" stroke=\"{}\"/>", px(time_s), top,
                       bottom + 4, css(palette::hairline));
    svg += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>",
                       px(time_s), bottom + 18, tick_text(time_s, at));
  }
  svg += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"end\">{}</text>", left + width,
                     bottom + 34, escaped(timeline.x_label));
  for (std::size_t row = 0; row < timeline.rows.size(); ++row) {
    const double y = top + row_px * static_cast<double>(row) + (row_px - bar_px) / 2;
    svg += fmt::format(
        "<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"end\" font-weight=\"600\">{}</text>",
        left - 10, y + bar_px / 2 + 4, escaped(timeline.rows[row].name));
    svg += fmt::format(
        "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"#f2f3f5\" "
        "rx=\"3\"/>",
        left, y, width, bar_px);
    for (const Span& span : timeline.rows[row].spans) {
      const double x = px(span.begin_s);
      const double wide = std::max(1.0, px(span.end_s) - x);
      const double high = span.thin ? thin_px : bar_px;
      svg += fmt::format(
          "<g><title>{} ({:.1f} – {:.1f} s)</title><rect x=\"{:.1f}\" y=\"{:.1f}\" "
          "width=\"{:.1f}\" height=\"{:.1f}\" rx=\"2\" fill=\"{}\"/>",
          escaped(span.text), span.begin_s, span.end_s, x, y + (bar_px - high) / 2, wide, high,
          css(span.colour));
      if (!span.thin && wide > letter_px * static_cast<double>(span.text.size()) + 8) {
        svg += fmt::format(
            "<text x=\"{:.1f}\" y=\"{:.1f}\" fill=\"#fff\" text-anchor=\"middle\" "
            "font-size=\"10.5\">{}</text>",
            x + wide / 2, y + bar_px / 2 + 4, escaped(span.text));
      }
      svg += "</g>";
    }
  }
  for (const Mark& mark : timeline.marks) {
    svg += fmt::format("<path d=\"M{:.1f} {:.1f}V{:.1f}\" stroke=\"{}\" stroke-width=\"2\"/>",
                       px(mark.x), top - 4, bottom, css(mark.colour));
    const bool late = mark.x > 0.7 * end_s;
    svg += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\" fill=\"{}\">{}</text>",
                       px(mark.x) + (late ? -4 : 4), top - 10, late ? "end" : "start",
                       css(mark.colour), escaped(mark.text));
  }
  return svg + "</svg>";
}

}  // namespace tuina::telemetry
