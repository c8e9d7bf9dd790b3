// SPDX-License-Identifier: Apache-2.0
#include "apps/evaluation/thesis/tissue.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "apps/cli/table.hpp"
#include "apps/evaluation/thesis/subjects.hpp"
#include "apps/evaluation/tissue/trials.hpp"
#include "tuina/baselines/model_fits.hpp"
#include "tuina/baselines/thesis_estimator.hpp"
#include "tuina/core/units.hpp"
#include "tuina/telemetry/page.hpp"
#include "tuina/telemetry/plot/svg_plot.hpp"
#include "tuina/tissue/classification.hpp"
#include "tuina/tissue/press_estimator.hpp"
#include "tuina/tissue/tangent_model.hpp"

namespace tuina::app {
namespace {

using Record = std::vector<tissue::TimedPress>;
namespace palette = telemetry::palette;

constexpr double pressed_to_n = 20.0;

/// 6.1.1: down and up at a constant speed; sensors as good as a wrist sensor's.
template <typename Law>
Record press_at(const Law& law, double deepest_m, double speed, Random& random) {
  Record record;
  const double half_s = (deepest_m + 1_mm) / speed;
  const double step_s = std::min(1e-3, half_s / 300.0);
  for (int step = 0; step * step_s < 2.0 * half_s; ++step) {
    const double t = step * step_s;
    const double x = deepest_m - speed * std::abs(t - half_s);
    const double force_n = x > 0.0 ? law(x, t < half_s ? speed : -speed) : 0.0;
    record.push_back({t, {x + gaussian(random, 0.02_mm), force_n + gaussian(random, 0.2)}});
  }
  return record;
}

/// What was pressed, and the law that was fitted to it.
std::string press_plot(const Record& record, const baselines::LawFit& fit,
                       const TangentTissue& truth, const std::string& name) {
  telemetry::Series dots{.name = "pressed", .colour = palette::grey, .dots = true};
  telemetry::Series curve{.name = "fit", .colour = palette::press};
  for (std::size_t i = 0; i < record.size(); i += 4) {
    dots.x.push_back(to_mm(record[i].press.depth_m));
    dots.y.push_back(record[i].press.force_n);
  }
  const double deepest_m = tissue::depth_at_force(truth, pressed_to_n);
  for (int step = 0; step * 0.05_mm < deepest_m; ++step) {
    const double x = step * 0.05_mm;
    curve.x.push_back(to_mm(x));
    curve.y.push_back(
        tissue::force_at_depth({fit.parameters[0], fit.parameters[1]}, x - fit.contact_m));
  }
  return telemetry::to_svg(telemetry::Plot{.title = name,
                                           .x_label = "depth, mm",
                                           .y_label = "force, N",
                                           .series = {dots, curve},
                                           .width_px = 400,
                                           .height_px = 240});
}

telemetry::Table table_6_1(Random& random, std::vector<telemetry::Figure>& figures) {
  telemetry::Table table{
      "6.1: Table 6-1, pressed at 5, 20 and 40 mm/s",
      "Simulated tissue that follows the tangent, force noise 0.2 N, so this shows that the "
      "procedure finds what is there and that an error of 0.2 N is the sensor's; it does "
      "not show that people follow the law.",
      telemetry::named_columns({"tissue", "speed mm/s", "printed alpha N", "alpha N",
                                "printed beta /mm", "beta /mm", "printed RMSE N", "RMSE N"})};
  constexpr std::array printed_rmse_n = {0.1896, 0.2343, 0.3936};
  for (std::size_t k = 0; k < trial_tissues.size(); ++k) {
    const TangentTissue& truth = trial_tissues[k].tissue;
    for (const double speed : {5_mm, 20_mm, 40_mm}) {
      const Record record =
          press_at([&](double x, double) { return tissue::force_at_depth(truth, x); },
                   tissue::depth_at_force(truth, pressed_to_n), speed, random);
      const baselines::LawFit fit = baselines::fit_law(record, baselines::TissueLaw::tangent);
      table.add({trial_tissues[k].name, fmt::format("{:.0f}", to_mm(speed)),
                 fmt::format("{:.3f}", truth.alpha_n), fmt::format("{:.3f}", fit.parameters[0]),
                 fmt::format("{:.4f}", from_mm(truth.beta_per_m)),
                 fmt::format("{:.4f}", from_mm(fit.parameters[1])),
                 fmt::format("{:.4f}", printed_rmse_n[k]), fmt::format("{:.4f}", fit.rmse_n)});
      if (speed != 20_mm) continue;
      figures.push_back(
          {press_plot(record, fit, truth, trial_tissues[k].name), trial_tissues[k].name});
    }
  }
  return table;
}

telemetry::Table table_of_laws(Random& random) {
  telemetry::Table table{
      "6.1: when is the tangent the right law?",
      "Presses to 20 N at 20 mm/s on tissue of the law at the left; by how much the "
      "criterion of Akaike of each fitted law exceeds the best one's. Below 10 two laws "
      "cannot be told apart. The place of the skin is fitted with every law.",
      telemetry::named_columns({"truth"})};
  for (const auto law : baselines::tissue_laws)
    table.columns.push_back({.head = baselines::name_of(law), .key = baselines::name_of(law)});
  const TangentTissue hard = trial_tissues[1].tissue;
  const double deepest_m = tissue::depth_at_force(hard, pressed_to_n);
  const auto row = [&](const std::string& name, double to_m, const auto& law) {
    const Record record = press_at(law, to_m, 20_mm, random);
    std::vector<double> aic;
    aic.reserve(std::size(baselines::tissue_laws));
    for (const auto fitted : baselines::tissue_laws) aic.push_back(fit_law(record, fitted).aic);
    const double best = *std::min_element(aic.begin(), aic.end());
    std::vector<telemetry::Cell> cells = {name};
    for (const double value : aic) cells.emplace_back(fmt::format("{:.0f}", value - best));
    table.add(std::move(cells));
  };
  const auto tangent = [&](double x, double) { return tissue::force_at_depth(hard, x); };
  row("tangent, to 2 alpha", deepest_m, tangent);
  row("tangent, to 1 alpha", tissue::depth_at_force(hard, hard.alpha_n), tangent);
  row("tangent, to alpha/2", tissue::depth_at_force(hard, 0.5 * hard.alpha_n), tangent);
  const double peak_n = pressed_to_n;
  const auto share = [deepest_m](double x) { return x / deepest_m; };
  row("quadratic", deepest_m, [=](double x, double) { return peak_n * std::pow(share(x), 2); });
  row("Hertz", deepest_m, [=](double x, double) { return peak_n * std::pow(share(x), 1.5); });
  row("exponential", deepest_m,
      [=](double x, double) { return peak_n * std::expm1(3.0 * share(x)) / std::expm1(3.0); });
  row("Kelvin-Voigt", deepest_m, [=](double x, double v) { return peak_n * share(x) + 60.0 * v; });
  row("Hunt-Crossley", deepest_m,
      [=](double x, double v) { return peak_n * std::pow(share(x), 1.8) * (1.0 + 5.0 * v); });
  row("tangent, damped", deepest_m,
      [=](double x, double v) { return tissue::force_at_depth(hard, x) * (1.0 + 5.0 * v); });
  return table;
}

struct Convergence {
  double within_5_s = 0.0, within_1_s = 0.0, last = 1.0;
  telemetry::Series alpha, beta;  // relative to the truth
};

Convergence converge(const baselines::ThesisEstimatorOptions& options, const TangentTissue& truth,
                     double noise_n, double late_m, double deeper, std::uint64_t seed) {
  Random random = make_random(seed, "6.3.1");
  baselines::ThesisEstimator estimator(options);
  Convergence result;
  int i = 0;
  for (tissue::TimedPress sample : sim::simulate_thesis_presses(truth, 45.0)) {
    sample.press.depth_m *= deeper;
    sample.press.force_n = deeper == 1.0
                               ? sample.press.force_n
                               : tissue::force_at_depth(truth, std::max(0.0, sample.press.depth_m));
    sample.press.depth_m -= late_m;
    sample.press.force_n += gaussian(random, noise_n);
    estimator.update(sample.time_s, sample.press);
    const TangentTissue found = estimator.estimate().tissue;
    const double a = found.alpha_n / truth.alpha_n, b = found.beta_per_m / truth.beta_per_m;
    result.last = estimator.valid() ? std::max(std::abs(a - 1.0), std::abs(b - 1.0)) : INFINITY;
    if (!(result.last <= 0.05)) result.within_5_s = sample.time_s;
    if (!(result.last <= 0.01)) result.within_1_s = sample.time_s;
    if (i++ % 100 != 0) continue;
    result.alpha.x.push_back(sample.time_s);
    result.alpha.y.push_back(std::clamp(a, 0.0, 2.0));
    result.beta.x.push_back(sample.time_s);
    result.beta.y.push_back(std::clamp(b, 0.0, 2.0));
  }
  return result;
}

/// What was found relative to what is true, over time.
std::string convergence_plot(Convergence found, const std::string& name) {
  found.alpha.name = "alpha";
  found.alpha.colour = palette::press;
  found.beta.name = "beta";
  found.beta.colour = palette::rub;
  return telemetry::to_svg(telemetry::Plot{.title = name,
                                           .x_label = "time, s",
                                           .y_label = "found / true",
                                           .series = {found.alpha, found.beta},
                                           .y_low = 0.0,
                                           .y_high = 2.0,
                                           .width_px = 400,
                                           .height_px = 200});
}

telemetry::Table table_6_3_1(std::uint64_t seed, std::vector<telemetry::Figure>& figures) {
  const baselines::ThesisEstimatorOptions r1{
      .gain_per_s = 0.2, .initial_covariance = 1000.0, .normalised = false};
  const baselines::ThesisEstimatorOptions r2{.gain_per_s = 5.0, .unit_m = 1.0};
  telemetry::Table table{
      "6.3.1: Fig. 6-7, the simulated convergence",
      "Printed: bone in 10 s, both muscles in 20 s, with a gain of 5. Two readings of what "
      "is not printed come close: R1, millimetres, gain 0.2, P(0) = 1000, judged at 1 %; "
      "R2, metres, gain 5, P(0) = 1, normalised, judged at 5 %. Below them the same with "
      "what every sensor has.",
      telemetry::named_columns(
          {"configuration", "bone s", "hard s", "soft s", "error at 45 s, bone/hard/soft %"})};
  struct Case {
    const char* name;
    baselines::ThesisEstimatorOptions options;
    bool at_one_percent;
    double noise_n, late_m, deeper;
  };
  const std::array cases = {Case{"R1", r1, true, 0.0, 0.0, 1.0},
                            Case{"R2", r2, false, 0.0, 0.0, 1.0},
                            Case{"R1, 0.01 N of noise", r1, true, 0.01, 0.0, 1.0},
                            Case{"R2, 0.01 N of noise", r2, false, 0.01, 0.0, 1.0},
                            Case{"R1, skin 0.1 mm off", r1, true, 0.0, 0.1_mm, 1.0},
                            Case{"R2, skin 0.1 mm off", r2, false, 0.0, 0.1_mm, 1.0},
                            Case{"R1, pressed four times as deep", r1, true, 0.0, 0.0, 4.0},
                            Case{"R2, pressed four times as deep", r2, false, 0.0, 0.0, 4.0}};
  const auto seconds = [](double s) {
    return s > 44.9 ? std::string("never") : fmt::format("{:.1f}", s);
  };
  const auto percent = [](double e) {
    return std::isfinite(e) ? fmt::format("{:.1f}", 100.0 * e) : std::string("no root");
  };
  for (const Case& c : cases) {
    std::array<Convergence, 3> found;
    for (std::size_t k = 0; k < 3; ++k)
      found[k] = converge(c.options, trial_tissues[k].tissue, c.noise_n, c.late_m, c.deeper, seed);
    const auto time_of = [&](const Convergence& f) {
      return seconds(c.at_one_percent ? f.within_1_s : f.within_5_s);
    };
    table.add({c.name, time_of(found[0]), time_of(found[1]), time_of(found[2]),
               fmt::format("{}/{}/{}", percent(found[0].last), percent(found[1].last),
                           percent(found[2].last))});
    if (c.noise_n + c.late_m > 0.0 || c.deeper > 1.0) continue;
    for (std::size_t k = 0; k < 3; ++k)
      figures.push_back({convergence_plot(found[k], c.name),
                         fmt::format("{}, {}", c.name, trial_tissues[k].name)});
  }
  return table;
}

}  // namespace

Result<ThesisTissue> redo_thesis_tissue(std::uint64_t seed, const Progress& progress) {
  Random random = make_random(seed, "thesis chapter 6");
  auto subjects = press_thesis_subjects(seed, progress);
  if (!subjects) return tl::unexpected(subjects.error());
  std::vector<telemetry::Figure> fits, curves;
  const telemetry::Table t1 = table_6_1(random, fits), t2 = table_of_laws(random);
  const telemetry::Table t3 = table_6_3_1(seed, curves);
  ThesisTissue result;
  for (const telemetry::Table& table : {t1, t2, t3, subjects->presses, subjects->people})
    result.text += to_text(table) + "\n";
  result.text += "Simulation only: nothing here was shown on living tissue.";
  result.json = nlohmann::json{{"seed", seed},
                               {"table_6_1", to_json(t1)},
                               {"laws", to_json(t2)},
                               {"figure_6_7", to_json(t3)},
                               {"subjects", to_json(subjects->presses)},
                               {"body_condition", to_json(subjects->people)}}
                    .dump(2);
  telemetry::Page page({.title = "Chapter 6 again",
                        .over = "tuina evaluate tissue --thesis",
                        .badges = {"simulation"},
                        .heading = "Chapter 6 of the thesis, again",
                        .lead =
                            "Soft tissue as F = α tan(β x): what is printed, and what comes out "
                            "when it is done again. Nothing here was shown on living tissue."});
  page.section(t1.title, t1.note).figures(fits, 3).table(t1);
  page.section(t2.title, t2.note).table(t2);
  page.section(t3.title, t3.note).figures(curves, 3).table(t3);
  page.section(subjects->presses.title, subjects->presses.note)
      .html(subjects->figures.str())
      .table(subjects->presses);
  page.section(subjects->people.title, subjects->people.note).table(subjects->people);
  result.html = page.str();
  return result;
}

}  // namespace tuina::app
