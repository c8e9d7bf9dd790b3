// SPDX-License-Identifier: Apache-2.0
// Force against depth, a small drawing for each point and its mirror image.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tuina/core/units.hpp"
#include "tuina/telemetry/plot/svg_parts.hpp"
#include "tuina/telemetry/report/figures.hpp"

namespace tuina::telemetry::figures {
namespace {

constexpr double shown_n = 30.0;  // as hard as a massage presses
constexpr double left_px = 24.0, top_px = 6.0, gap_px = 14.0, panel_px = 84.0, row_gap_px = 22.0;
constexpr int columns = 3, width_px = 400;
constexpr double panel_width_px = (width_px - left_px - columns * gap_px) / columns;

/// Where the small drawings stand, and their common axes from zero.
struct Axes {
  double max_mm = 1.0;

  [[nodiscard]] static double left(int panel) {
    return left_px + panel % columns * (panel_width_px + gap_px);
  }
  [[nodiscard]] static double bottom(int panel) {
    return top_px + (panel / columns + 1) * (panel_px + row_gap_px);
  }
  [[nodiscard]] double px(int panel, double depth_mm) const {
    return left(panel) + panel_width_px * depth_mm / max_mm;
  }
  [[nodiscard]] static double py(int panel, double force_n) {
    return bottom(panel) - panel_px * force_n / shown_n;
  }
};

double depth_mm(const TangentTissue& tissue, double force_n) {
  return to_mm(std::atan(force_n / tissue.alpha_n) / tissue.beta_per_m);
}

/// One law up to a force.
std::string curve(const Axes& axes, int panel, const TangentTissue& tissue, double to_n,
                  std::string_view stroke) {
  constexpr int pieces = 40;
  std::string d;
  for (int k = 0; k <= pieces; ++k) {
    const double force_n = to_n * k / pieces;
    d += fmt::format("{}{:.1f} {:.1f}", k == 0 ? 'M' : 'L',
                     axes.px(panel, depth_mm(tissue, force_n)), Axes::py(panel, force_n));
  }
  return fmt::format("<path d=\"{}\" fill=\"none\" {}/>", d, stroke);
}

/// Lines and numbers behind the curves of one point.
std::string grid(const Axes& axes, int panel, bool numbers_beneath) {
  const double left = Axes::left(panel);
  std::string svg;
  for (const double force_n : {0.0, 10.0, 20.0, 30.0}) {
    const double y = Axes::py(panel, force_n);
    svg += fmt::format("<path d=\"M{:.1f} {:.1f}h{:.1f}\" stroke=\"{}\"/>", left, y, panel_width_px,
                       css(force_n == 0.0 ? palette::grey : palette::hairline));
    if (panel % columns == 0)
      svg += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"end\">{:.0f}</text>",
                         left - 5, y + 4, force_n);
  }
  const std::vector<double> depths = ticks(0.0, axes.max_mm, 3);
  for (const double depth : depths) {
    if (depth > axes.max_mm) continue;
    const double x = axes.px(panel, depth);
    svg += fmt::format("<path d=\"M{:.1f} {:.1f}v3\" stroke=\"{}\"/>", x, Axes::bottom(panel),
                       css(palette::grey));
    if (numbers_beneath)
      svg += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>", x,
                         Axes::bottom(panel) + 15, tick_text(depth, depths));
  }
  return svg;
}

/// What was felt at a point, and the strongest press there: nobody knows what is beyond.
struct Pressed {
  FeltTissue felt;
  double strongest_n = 0.0;

  [[nodiscard]] double deepest_mm() const { return depth_mm(felt.estimate.tissue, strongest_n); }
};

/// One point, or a pair.
struct Place {
  std::string name;  ///< "BL47"
  std::vector<Pressed> sides;
};

double strongest_press_n(const ReportData& data, const std::string& acupoint) {
  double strongest_n = 0.0;
  for (const PerformedPath& done : data.paths) {
    if (done.path.technique == Technique::press && !done.path.acupoints.empty() &&
        done.path.acupoints.front() == acupoint)
      strongest_n = std::max(strongest_n, std::min(done.given_n, shown_n));
  }
  return strongest_n;
}

std::vector<Place> places_of(const ReportData& data) {
  std::vector<Place> places;
  for (FeltTissue& felt : last_felt(data)) {
    const TangentTissue& tissue = felt.estimate.tissue;
    if (!felt.mapped || !(tissue.alpha_n > 0.0) || !(tissue.beta_per_m > 0.0)) continue;
    const std::string name = felt.name.substr(0, felt.name.rfind('_'));
    auto place = std::ranges::find(places, name, &Place::name);
    if (place == places.end()) place = places.insert(places.end(), {.name = name, .sides = {}});
    const double strongest_n = strongest_press_n(data, felt.name);
    place->sides.push_back({std::move(felt), strongest_n});
  }
  return places;
}

/// The curves of one place, each with the letter of its side.
std::string drawn(const Place& place, const Axes& axes, int panel, double hardest) {
  std::string svg =
      fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" font-weight=\"600\">{}</text>",
                  Axes::left(panel) + 4, Axes::py(panel, shown_n) + 13, escaped(place.name));
  const auto deeper = std::ranges::max_element(place.sides, {}, &Pressed::deepest_mm);
  for (const Pressed& side : place.sides) {
    const FeltTissue& felt = side.felt;
    // The palest colours of the map could not be seen as lines on paper.
    const std::string colour =
        css(hardness_colour(std::max(0.15, felt.stiffness_n_per_mm / hardest)));
    if (felt.truth)
      svg += curve(axes, panel, *felt.truth, side.strongest_n,
                   fmt::format("stroke=\"{}\" stroke-dasharray=\"4 3\"", colour));
    svg += curve(axes, panel, felt.estimate.tissue, side.strongest_n,
                 fmt::format("stroke=\"{}\" stroke-width=\"2\"", colour));
    if (place.sides.size() < 2) continue;
    // The letters stand apart where both curves end alike, too.
    const bool is_deeper = &side == &*deeper;
    svg += fmt::format(
        "<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\" font-size=\"10.5\" "
        "fill=\"{}\">{}</text>",
        axes.px(panel, side.deepest_mm()) + (is_deeper ? 2 : -2),
        Axes::py(panel, side.strongest_n) - 3, is_deeper ? "start" : "end", colour,
        felt.name.back());
  }
  return svg;
}

}  // namespace

double hardest_shown(const ReportData& data, double at_least_n_per_mm) {
  double hardest = at_least_n_per_mm;
  for (const FeltTissue& felt : data.tissue)
    hardest = std::max(hardest, felt.mapped ? felt.stiffness_n_per_mm : 0.0);
  const auto round_numbers = ticks(0.0, hardest, 4);
  return round_numbers.back() + (round_numbers.back() < 0.999 * hardest ? round_numbers[1] : 0.0);
}

std::vector<FeltTissue> last_felt(const ReportData& data) {
  std::vector<FeltTissue> last;
  for (const FeltTissue& felt : data.tissue) {
    const auto same = std::find_if(
        last.begin(), last.end(), [&](const FeltTissue& other) { return other.name == felt.name; });
    if (same == last.end())
      last.push_back(felt);
    else
      *same = felt;
  }
  return last;
}

std::string tissue_curves(const ReportData& data) {
  const std::vector<Place> places = places_of(data);
  if (places.empty()) return "";
  Axes axes;
  for (const Place& place : places) {
    for (const Pressed& side : place.sides) {
      axes.max_mm = std::max(axes.max_mm, side.deepest_mm());
      if (side.felt.truth)
        axes.max_mm = std::max(axes.max_mm, depth_mm(*side.felt.truth, side.strongest_n));
    }
  }
  const double hardest = hardest_shown(data);
  const int panels = static_cast<int>(places.size());
  const double bottom = Axes::bottom(panels - 1);
  std::string svg = open_svg(width_px, static_cast<int>(bottom) + 40,
                             data.language("Force against depth at each point"));
  svg += fmt::format("<text y=\"12\">{}</text>", escaped(data.language("force, N")));
  svg += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"end\">{}</text>",
                     width_px - gap_px, bottom + 33,
                     escaped(data.language("depth below the skin, mm")));
  for (int panel = 0; panel < panels; ++panel) {
    svg += grid(axes, panel, panel + columns >= panels) +
           drawn(places[static_cast<std::size_t>(panel)], axes, panel, hardest);
  }
  return svg + "</svg>";
}

}  // namespace tuina::telemetry::figures
