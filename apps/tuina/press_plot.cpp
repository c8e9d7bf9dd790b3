// SPDX-License-Identifier: Apache-2.0
#include "apps/tuina/press_plot.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "tuina/core/units.hpp"
#include "tuina/telemetry/plot/svg_plot.hpp"
#include "tuina/tissue/tangent_model.hpp"

namespace tuina::app {

using telemetry::Band;
using telemetry::Plot;
using telemetry::Series;
namespace palette = telemetry::palette;

std::string plot_fit(const std::vector<tissue::TimedPress>& record, const tissue::CurveFit& fit) {
  Plot plot{.title = "force over depth",
            .x_label = "depth beneath the skin, mm",
            .y_label = "force, N",
            .y_high = 1.1 * fit.peak_force_n,
            .height_px = 420};
  Series samples{.name = "samples", .colour = palette::grey, .width_px = 1.0, .dots = true};
  double deepest_m = 0.0, max_m = 0.0;
  for (const tissue::TimedPress& sample : record) {
    const double depth_m = sample.press.depth_m - fit.contact_m;
    deepest_m = std::max(deepest_m, depth_m);
    max_m = std::min(max_m, depth_m);
    samples.x.push_back(to_mm(depth_m));
    samples.y.push_back(sample.press.force_n - fit.offset_n);
  }
  Series curve{.name = fmt::format("{:.2f} N tan({:.4f}/mm x)", fit.tissue.alpha_n,
                                   from_mm(fit.tissue.beta_per_m)),
               .colour = palette::press,
               .width_px = 2.0};
  Band band{.name = "95 %", .colour = palette::press};
  constexpr int steps = 200;
  for (int i = 0; i <= steps; ++i) {
    const double depth_m = max_m + (deepest_m - max_m) * i / steps;
    const double force_n = tissue::force_at_depth(fit.tissue, depth_m);
    curve.x.push_back(to_mm(depth_m));
    curve.y.push_back(force_n);
    // Alpha and beta err in opposite directions, so each corner of the interval is a curve that
    // could be.
    double low_n = force_n, high_n = force_n;
    for (const double sign : {-1.0, 1.0}) {
      const TangentTissue corner{
          std::max(1e-3, fit.tissue.alpha_n + sign * fit.alpha_ci95_n),
          std::max(1e-3, fit.tissue.beta_per_m - sign * fit.beta_ci95_per_m)};
      low_n = std::min(low_n, tissue::force_at_depth(corner, depth_m));
      high_n = std::max(high_n, tissue::force_at_depth(corner, depth_m));
    }
    band.x.push_back(to_mm(depth_m));
    band.low.push_back(low_n);
    band.high.push_back(high_n);
  }
  plot.bands = {std::move(band)};
  plot.series = {std::move(samples), std::move(curve)};
  return telemetry::to_svg(plot);
}

std::string plot_estimates(const std::vector<TimedEstimate>& estimates,
                           const std::optional<TangentTissue>& truth) {
  Plot alpha{.title = "alpha over time", .x_label = "time, s", .y_label = "alpha, N", .y_low = 0.0};
  Plot beta{.title = "beta over time", .x_label = "time, s", .y_label = "beta, 1/mm", .y_low = 0.0};
  Series alphas{.name = "alpha", .colour = palette::press},
      betas{.name = "beta", .colour = palette::rub};
  Band alpha_band{.name = "95 %", .colour = palette::press},
      beta_band{.name = "95 %", .colour = palette::rub};
  bool was_converged = false;
  for (const auto& [time_s, e] : estimates) {
    const double beta_per_mm = from_mm(e.tissue.beta_per_m), beta_ci = from_mm(e.beta_ci95_per_m);
    alphas.x.push_back(time_s);
    alphas.y.push_back(e.tissue.alpha_n);
    alpha_band.x.push_back(time_s);
    alpha_band.low.push_back(std::max(0.0, e.tissue.alpha_n - e.alpha_ci95_n));
    alpha_band.high.push_back(e.tissue.alpha_n + e.alpha_ci95_n);
    betas.x.push_back(time_s);
    betas.y.push_back(beta_per_mm);
    beta_band.x.push_back(time_s);
    beta_band.low.push_back(std::max(0.0, beta_per_mm - beta_ci));
    beta_band.high.push_back(beta_per_mm + beta_ci);
    if (e.converged && !was_converged) {
      alpha.marks.push_back({.x = time_s, .text = "converged"});
      beta.marks.push_back({.x = time_s, .text = "converged"});
    }
    was_converged = e.converged;
  }
  // The first guess is wide; the picture is about where it goes.
  if (!estimates.empty()) {
    alpha.y_high = 2.5 * estimates.back().estimate.tissue.alpha_n;
    beta.y_high = 2.0 * from_mm(estimates.back().estimate.tissue.beta_per_m);
  }
  alpha.bands = {std::move(alpha_band)};
  alpha.series = {std::move(alphas)};
  beta.bands = {std::move(beta_band)};
  beta.series = {std::move(betas)};
  if (truth && !estimates.empty()) {
    const double begin_s = estimates.front().time_s, end_s = estimates.back().time_s;
    const auto level = [&](double value) {
      return Series{.name = "truth",
                    .x = {begin_s, end_s},
                    .y = {value, value},
                    .colour = palette::ink,
                    .width_px = 1.2,
                    .dashed = true};
    };
    alpha.series.push_back(level(truth->alpha_n));
    beta.series.push_back(level(from_mm(truth->beta_per_m)));
  }
  return fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} "
      "{1}\">\n{2}\n"
      "<g transform=\"translate(0 {3})\">\n{4}\n</g>\n</svg>\n",
      alpha.width_px, alpha.height_px + beta.height_px, telemetry::to_svg(alpha), alpha.height_px,
      telemetry::to_svg(beta));
}

}  // namespace tuina::app
