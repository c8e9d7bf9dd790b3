// SPDX-License-Identifier: Apache-2.0
#include "apps/evaluation/thesis/subjects.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <optional>

#include "apps/evaluation/contact/contact_experiment.hpp"
#include "apps/evaluation/tissue/trials.hpp"
#include "tuina/baselines/thesis_estimator.hpp"
#include "tuina/core/parallel.hpp"
#include "tuina/core/random.hpp"
#include "tuina/core/units.hpp"
#include "tuina/robot/arm_table.hpp"
#include "tuina/telemetry/plot/svg_plot.hpp"
#include "tuina/tissue/body_condition.hpp"
#include "tuina/tissue/press_estimator.hpp"

namespace tuina::app {
namespace {

namespace palette = telemetry::palette;

constexpr double minute_s = 60.0, signals_s = 10.0, curve_every_s = 0.25;
constexpr double believed_torso_n_per_m = 35e3;
// Fig. 6-12 of [thesis] has bone blue, hard muscle green, soft muscle red.
constexpr std::array colours = {palette::rub, palette::stroke, palette::press};
constexpr int shown_people = 4;  // in Fig. 6-12

/// What a minute at one place of one subject gave.
struct Place {
  TangentTissue truth, found;
  double theirs_error = 0.0;  // relative, the worse one of alpha and beta
  std::optional<double> converged_s, error_then;
  bool stopped = false;
  std::vector<double> time_s, alpha_n, beta_per_m;
  std::vector<tissue::TimedPress> signals;  // the first ten seconds from the first touch
};

double worse_error(const TangentTissue& found, const TangentTissue& truth) {
  return std::max(std::abs(found.alpha_n / truth.alpha_n - 1.0),
                  std::abs(found.beta_per_m / truth.beta_per_m - 1.0));
}

Result<Place> press_place(const TangentTissue& truth, double peak_n, Random& random) {
  ContactExperiment experiment;
  experiment.tissue = truth;
  experiment.force_n = peak_n;
  experiment.window = {.edge_s = 0.8, .hold_s = 0.2, .steepness = 4.0};
  experiment.torso_n_per_m = believed_torso_n_per_m * (1.0 + uniform(random, -0.2, 0.2));
  experiment.surface_error_m = uniform(random, -3_mm, 3_mm);
  experiment.breathing = {3_mm, 0.25};
  experiment.duration_s = minute_s;
  experiment.seed = random();
  auto outcome = run_contact(experiment);
  if (!outcome) return tl::unexpected(outcome.error());

  Place place{.truth = truth, .found = {}, .stopped = outcome->stopped};
  const auto touch =
      std::find_if(outcome->trace.begin(), outcome->trace.end(),
                   [](const ContactSample& sample) { return sample.true_force_n > 0.0; });
  const double touch_s = touch != outcome->trace.end() ? touch->time_s : 0.0;
  tissue::PressEstimator ours(
      tissue::pressed_by_robot(believed_torso_n_per_m, robot::thesis_arm().tool_mass_kg));
  baselines::ThesisEstimator theirs({.initial_covariance = 1e3, .only_in_contact = true});
  std::optional<double> skin_m;
  for (const tissue::TimedPress& sample : outcome->felt) {
    ours.update(sample.time_s, sample.press);
    const double time_s = sample.time_s - touch_s;
    if (time_s < 0.0) continue;
    if (!skin_m) skin_m = sample.press.depth_m;
    const Press from_skin{sample.press.depth_m - *skin_m, sample.press.force_n};
    theirs.update(sample.time_s, from_skin);
    const TissueEstimate& estimate = ours.estimate();
    if (estimate.converged && !place.converged_s) {
      place.converged_s = estimate.converged_after_s;
      place.error_then = worse_error(estimate.tissue, truth);
    }
    if (time_s < signals_s) place.signals.push_back({time_s, from_skin});
    if (time_s >= static_cast<double>(place.time_s.size()) * curve_every_s) {
      place.time_s.push_back(time_s);
      place.alpha_n.push_back(estimate.tissue.alpha_n);
      place.beta_per_m.push_back(estimate.tissue.beta_per_m);
    }
  }
  place.found = ours.estimate().tissue;
  place.theirs_error = worse_error(theirs.estimate().tissue, truth);
  return place;
}

std::string name_of(std::size_t subject) {
  const tissue::Subject& who = tissue::table_6_2()[subject];
  return fmt::format("{} {} {}", subject + 1, who.build, who.female ? "f" : "m");
}

using Places = std::vector<std::array<Place, 3>>;  // of every subject over bone, hard and soft

telemetry::Table table_of_presses(const Places& all) {
  telemetry::Table table{
      "6.3.2: the seven subjects of Table 6-2, pressed for a minute",
      "Simulated bodies with the printed alpha and beta, pressed to 25-30 N every two seconds by "
      "the simulated arm under force control, with its friction and sensors, on a breath of 3 mm "
      "and a torso of 35 N/mm known to 20 %; depth from joint angles. The thesis' least squares "
      "(gain 0.1) is told where the skin is at the first touch and holds in the air. Errors are "
      "the worse one of alpha and beta.",
      telemetry::named_columns({"subject", "tissue", "alpha N", "beta /mm", "thesis after 60 s %",
                                "ours after 60 s %", "ours converged s", "error then %"})};
  const auto percent = [](double error) {
    return error < 10.0 ? fmt::format("{:.1f}", 100.0 * error) : std::string(">999");
  };
  for (std::size_t s = 0; s < all.size(); ++s) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Place& place = all[s][k];
      table.add({name_of(s), trial_tissues[k].name, fmt::format("{:.2f}", place.truth.alpha_n),
                 fmt::format("{:.3f}", from_mm(place.truth.beta_per_m)),
                 percent(place.theirs_error),
                 place.stopped ? "stopped" : percent(worse_error(place.found, place.truth)),
                 place.converged_s ? fmt::format("{:.1f}", *place.converged_s) : "never",
                 place.error_then ? percent(*place.error_then) : "-"});
    }
  }
  return table;
}

telemetry::Table table_of_people(const Places& all) {
  telemetry::Table table{
      "6.3.2: what slim, hefty and female look like in (alpha, beta)",
      "Felt after the minute, and what that says of the person by the other six of Table 6-2. The "
      "slim have a thin, hard layer; the hefty a thick one and softer muscle; the one woman little "
      "alpha and much beta, and being the only one cannot be judged by the others. Seven people "
      "are "
      "few: a hint, never a finding.",
      telemetry::named_columns({"subject", "alpha N, bone/hard/soft", "beta /mm, bone/hard/soft",
                                "slim %", "medium %", "hefty %"})};
  const auto printed = tissue::table_6_2();
  for (std::size_t s = 0; s < all.size(); ++s) {
    std::vector<tissue::Subject> others;
    for (std::size_t i = 0; i < printed.size(); ++i) {
      if (i != s) others.push_back(printed[i]);
    }
    std::vector<tissue::KnownPress> felt;
    for (std::size_t k = 0; k < 3; ++k)
      felt.push_back({all[s][k].found, static_cast<tissue::TissueClass>(k)});
    const tissue::BodyCondition is = tissue::find_body_condition(felt, {}, others);
    const auto percent = [](double share) { return fmt::format("{:.0f}", 100.0 * share); };
    table.add({name_of(s),
               fmt::format("{:.2f}/{:.2f}/{:.2f}", felt[0].tissue.alpha_n, felt[1].tissue.alpha_n,
                           felt[2].tissue.alpha_n),
               fmt::format("{:.3f}/{:.3f}/{:.3f}", from_mm(felt[0].tissue.beta_per_m),
                           from_mm(felt[1].tissue.beta_per_m), from_mm(felt[2].tissue.beta_per_m)),
               percent(is.slim), percent(is.medium), percent(is.hefty)});
  }
  return table;
}

/// Fig. 6-10: displacement and force over bone in the first ten seconds.
void add_signals(telemetry::Part& part, const Place& place) {
  telemetry::Series depth{.colour = palette::ink}, force{.colour = palette::press};
  for (const tissue::TimedPress& sample : place.signals) {
    depth.x.push_back(sample.time_s);
    depth.y.push_back(to_mm(sample.press.depth_m));
    force.x.push_back(sample.time_s);
    force.y.push_back(sample.press.force_n);
  }
  const telemetry::Plot first{.title = "displacement over bone",
                              .x_label = "time, s",
                              .y_label = "displacement, mm",
                              .series = {depth},
                              .width_px = 500,
                              .height_px = 200},
      second{.title = "force over bone",
             .x_label = "time, s",
             .y_label = "force, N",
             .series = {force},
             .width_px = 500,
             .height_px = 200};
  part.heading("As Fig. 6-10: displacement and force of subject 1 over bone, as felt")
      .figures({{.svg = telemetry::to_svg(first)}, {.svg = telemetry::to_svg(second)}});
}

/// Figs. 6-9 and 6-12: the estimates of one subject over the minute, dashed what is true.
void add_curves(telemetry::Part& part, std::size_t subject, const std::array<Place, 3>& places) {
  telemetry::Plot alpha{.title = "alpha over time",
                        .x_label = "time, s",
                        .y_label = "alpha, N",
                        .y_low = 0.0,
                        .y_high = 14.0,
                        .width_px = 500,
                        .height_px = 190};
  telemetry::Plot beta = alpha;
  beta.title = "beta over time";
  beta.y_label = "beta, 1/mm";
  beta.y_low = 0.1;
  beta.y_high = 0.35;
  for (std::size_t k = 0; k < 3; ++k) {
    const Place& place = places[k];
    const auto add = [&](telemetry::Plot& plot, const std::vector<double>& found, double truth) {
      plot.series.push_back({.x = {0.0, minute_s},
                             .y = {truth, truth},
                             .colour = colours[k],
                             .width_px = 1.0,
                             .dashed = true});
      telemetry::Series line{
          .name = trial_tissues[k].name, .x = place.time_s, .colour = colours[k]};
      for (const double value : found)
        line.y.push_back(std::clamp(value, *plot.y_low, *plot.y_high));
      plot.series.push_back(std::move(line));
    };
    std::vector<double> beta_per_mm;
    beta_per_mm.reserve(place.beta_per_m.size());
    for (const double value : place.beta_per_m) beta_per_mm.push_back(from_mm(value));
    add(alpha, place.alpha_n, place.truth.alpha_n);
    add(beta, beta_per_mm, from_mm(place.truth.beta_per_m));
  }
  part.heading("Subject " + name_of(subject))
      .figures({{.svg = telemetry::to_svg(alpha)}, {.svg = telemetry::to_svg(beta)}});
}

std::string map_of(const Places& all) {
  telemetry::Plot map{.title = "alpha and beta of the seven",
                      .x_label = "alpha, N",
                      .y_label = "beta, 1/mm",
                      .height_px = 320};
  telemetry::Series truth{.name = "printed", .colour = palette::ink, .dots = true};
  std::array<telemetry::Series, 3> felt;
  for (std::size_t k = 0; k < 3; ++k) {
    felt[k] = {.name = trial_tissues[k].name, .colour = colours[k], .dots = true};
    for (const auto& places : all) {
      truth.x.push_back(places[k].truth.alpha_n);
      truth.y.push_back(from_mm(places[k].truth.beta_per_m));
      felt[k].x.push_back(places[k].found.alpha_n);
      felt[k].y.push_back(from_mm(places[k].found.beta_per_m));
    }
  }
  map.series = {truth, felt[0], felt[1], felt[2]};
  return telemetry::to_svg(map);
}

}  // namespace

Result<ThesisSubjects> press_thesis_subjects(std::uint64_t seed, const Progress& progress) {
  const auto subjects = tissue::table_6_2();
  Places all(subjects.size());
  std::mutex failing;
  std::optional<Error> failed;
  for_each_in_parallel(
      3 * subjects.size(),
      [&](std::size_t i) {
        const std::size_t s = i / 3, k = i % 3;
        Random random = make_random(seed + s, trial_tissues[k].name);
        auto place = press_place(subjects[s].tissue[k], trial_tissues[k].robot_peak_n, random);
        if (place) {
          all[s][k] = std::move(*place);
        } else {
          const std::lock_guard lock(failing);
          failed = place.error();
        }
      },
      progress);
  if (failed) return tl::unexpected(*failed);

  ThesisSubjects result{table_of_presses(all), table_of_people(all), {}};
  add_signals(result.figures, all[0][0]);
  result.figures.note("As Figs. 6-9 and 6-12: what is felt over the minute; dashed what is true.");
  for (std::size_t s = 0; s < shown_people; ++s) add_curves(result.figures, s, all[s]);
  result.figures.heading("All seven").figure(map_of(all));
  return result;
}

}  // namespace tuina::app
