// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "apps/evaluation/safety/judge.hpp"
#include "apps/evaluation/safety/report.hpp"
#include "tuina/telemetry/page.hpp"
#include "tuina/telemetry/plot/heat_map.hpp"
#include "tuina/telemetry/plot/svg_plot.hpp"

namespace tuina::app {
namespace {

using telemetry::Plot;
using telemetry::Series;
namespace palette = telemetry::palette;

constexpr double shown_n = 200.0;    // what is above has no end worth a scale
constexpr std::size_t curves = 4;    // more names than that do not fit above the plot
constexpr double shown_ms = 1000.0;  // most peaks have passed by then

double share_of(const CampaignCell& cell) {
  return cell.outcome.worst_force_n / allowed_n(cell.fault->promise, cell.outcome.set_force_n);
}

std::vector<const FaultClass*> tried_classes(const Campaign& campaign) {
  std::vector<const FaultClass*> tried;
  for (const CampaignCell& cell : campaign.cells)
    if (tried.empty() || tried.back() != cell.fault) tried.push_back(cell.fault);
  return tried;
}

std::string margin_map(const Campaign& campaign) {
  telemetry::HeatMap map{.title = "true force as a share of what is allowed, %",
                         .y_label = "above 100 a promise is broken",
                         .calm = 100.0,
                         .wild = 200.0};
  const std::vector<std::pair<std::string, std::string>> states = {
      {"idle", "idle"},         {"travel", "travel"},       {"approach", "appr."},
      {"contact bone", "bone"}, {"contact hard", "hard"},   {"contact soft", "soft"},
      {"contact low", "low"},   {"contact midline", "GV4"}, {"retract", "retract"}};
  for (const auto& [state, tick] : states) map.x_ticks.push_back(tick);
  const auto tried = tried_classes(campaign);
  for (auto fault = tried.rbegin(); fault != tried.rend(); ++fault) {
    map.y_ticks.push_back((*fault)->name);
    for (const auto& [state, tick] : states) {
      double worst = std::numeric_limits<double>::quiet_NaN();
      for (const CampaignCell& cell : campaign.cells) {
        if (cell.fault == *fault && state_of(cell) == state && cell.outcome.tried)
          worst = std::fmax(worst, std::min(999.0, 100.0 * share_of(cell)));
      }
      map.values.push_back(worst);
    }
  }
  return telemetry::to_svg({map});
}

Series level(double force_n, double begin, double end) {
  return {.name = fmt::format("{:.0f} N", force_n),
          .x = {begin, end},
          .y = {force_n, force_n},
          .colour = force_n > seldom_n ? palette::stop : palette::grey,
          .width_px = 1.2,
          .dashed = true};
}

std::string force_plot(const Campaign& campaign) {
  const auto classes = tried_classes(campaign);
  Plot plot{.title = "worst true force of each class",
            .x_label = "class, in the order of the table",
            .y_label = "true force, N",
            .marks = {},
            .y_low = 0.0,
            .y_high = shown_n};
  Series dots{.name = "worst of a class", .colour = palette::press, .width_px = 4.0, .dots = true};
  for (std::size_t i = 0; i < classes.size(); ++i) {
    double worst_n = 0.0;
    for (const CampaignCell& cell : campaign.cells)
      if (cell.fault == classes[i]) worst_n = std::max(worst_n, cell.outcome.worst_force_n);
    for (const auto& [first, group] : {std::pair{"wrist drops out", "wrist sensor"},
                                       {"encoder frozen", "joints"},
                                       {"stall of 2 ms", "time"},
                                       {"torque not a number", "controller, power"},
                                       {"other arm comes", "room"},
                                       {"breathes deeply", "person"}}) {
      if (classes[i]->name == first) plot.marks.push_back({static_cast<double>(i) + 0.5, group});
    }
    dots.x.push_back(static_cast<double>(i + 1));
    dots.y.push_back(std::min(worst_n, shown_n));
  }
  const double last = static_cast<double>(classes.size());
  plot.series = {level(seldom_n, 0.0, last + 1.0), level(never_n, 0.0, last + 1.0), dots};
  return telemetry::to_svg(plot);
}

std::string action_plot(const Campaign& campaign) {
  constexpr double soon_ms = 100.0;
  const std::vector<double> actions_ms = campaign.first_actions_ms();
  const auto must = std::count_if(
      campaign.cells.begin(), campaign.cells.end(),
      [](const CampaignCell& cell) { return cell.fault->promise.duty == Duty::stop; });
  Plot plot{.title = "first action",
            .x_label = "ms from the onset to the first action",
            .y_label = "share of the cells that must act, %",
            .marks = {{10.0, "10 ms"}, {25.0, "watchdog"}},
            .x_low = 0.0,
            .x_high = soon_ms,
            .y_low = 0.0,
            .y_high = 100.0};
  Series line{.name = "", .colour = palette::press, .width_px = 2.0};
  double share = 0.0;
  for (std::size_t i = 0; i < actions_ms.size() && actions_ms[i] <= soon_ms; ++i) {
    line.x.insert(line.x.end(), {actions_ms[i], actions_ms[i]});
    line.y.push_back(share);
    share = 100.0 * static_cast<double>(i + 1) / static_cast<double>(must);
    line.y.push_back(share);
  }
  line.x.push_back(soon_ms);
  line.y.push_back(share);
  plot.series.push_back(std::move(line));
  return telemetry::to_svg(plot);
}

/// The worst cell of each class that breaks a promise, the largest excess first.
std::vector<const CampaignCell*> worst_cells(const Campaign& campaign) {
  std::vector<const CampaignCell*> worst;
  for (const FaultClass& fault : fault_classes()) {
    const CampaignCell* of_class = nullptr;
    for (const CampaignCell& cell : campaign.cells) {
      if (cell.fault != &fault || cell.holds()) continue;
      if (of_class == nullptr || share_of(cell) > share_of(*of_class)) of_class = &cell;
    }
    if (of_class != nullptr) worst.push_back(of_class);
  }
  std::stable_sort(worst.begin(), worst.end(),
                   [](const auto* a, const auto* b) { return share_of(*a) > share_of(*b); });
  return worst;
}

/// A trial to be run again for its curve.
struct Curve {
  std::string name;
  TrialPlan plan;
};

Result<std::string> curve_plot(const char* title, std::vector<Curve> worst) {
  Plot plot{.title = title,
            .x_label = "ms since the onset",
            .y_label = "true force, N",
            .x_low = 0.0,
            .x_high = shown_ms,
            .y_low = 0.0,
            .y_high = shown_n,
            .height_px = 420};
  plot.series = {level(seldom_n, 0.0, shown_ms), level(never_n, 0.0, shown_ms)};
  if (worst.size() > curves) worst.resize(curves);
  for (std::size_t i = 0; i < worst.size(); ++i) {
    worst[i].plan.traced = true;
    const auto outcome = run_trial(worst[i].plan);
    if (!outcome) return tl::unexpected(outcome.error());
    const double share = static_cast<double>(i) / static_cast<double>(worst.size());
    Series line{.name = worst[i].name, .colour = telemetry::hardness_colour(0.15 + 0.85 * share)};
    for (const TrialSample& sample : outcome->trace) {
      line.x.push_back(1e3 * sample.since_onset_s);
      line.y.push_back(std::min(sample.true_force_n, shown_n));
    }
    plot.series.push_back(std::move(line));
  }
  return telemetry::to_svg(plot);
}

std::vector<Curve> curves_of(const std::vector<const CampaignCell*>& worst) {
  std::vector<Curve> all;
  all.reserve(worst.size());
  for (const CampaignCell* cell : worst)
    all.push_back({fmt::format("{}, {}", cell->fault->name, state_of(*cell)), cell->plan});
  return all;
}

std::vector<Curve> curves_of(const std::vector<WorstTrial>& worst) {
  std::vector<Curve> all;
  all.reserve(worst.size());
  for (const WorstTrial& one : worst) all.push_back({one.fault->name, one.plan});
  return all;
}

/// A line for each class that breaks a promise: in how many cells, and what the worst of them did.
std::vector<std::string> unbounded(const Campaign& campaign,
                                   const std::vector<const CampaignCell*>& worst) {
  std::vector<std::string> lines;
  for (const CampaignCell* cell : worst) {
    int broken = 0, cells = 0;
    for (const CampaignCell& other : campaign.cells) {
      if (other.fault != cell->fault) continue;
      ++cells;
      broken += other.holds() ? 0 : 1;
    }
    lines.push_back(fmt::format("{} {}: {} of {} cells. The worst, {} at {}: {}.",
                                cell->fault->number, cell->fault->name, broken, cells,
                                name_of(cell->plan.stage), cell->plan.site->name,
                                fmt::join(cell->broken, "; ")));
  }
  return lines;
}

/// All that comes of the table of cells.
Result<void> add_cells(const Campaign& campaign, telemetry::Page& page) {
  const auto worst = worst_cells(campaign);
  page.section("Margins",
               "The worst of a class in a state, over people, positions and arms. Blank: not "
               "tried there.")
      .figure(margin_map(campaign));
  page.section("Force", "All forces are true ones; 200 N stands for all that is more.")
      .figure(force_plot(campaign));
  page.section("First action",
               "Of the guard, the controller or the drives, where one is owed. What is missing at "
               "the right never came or came later.")
      .figure(action_plot(campaign));
  telemetry::Part& not_bounded = page.section("What is not bounded");
  if (worst.empty()) not_bounded.calm("All promises are kept.");
  for (const std::string& line : unbounded(campaign, worst)) not_bounded.alarm(line);
  if (!worst.empty()) {
    const auto curve = curve_plot("the worst cells", curves_of(worst));
    if (!curve) return tl::unexpected(curve.error());
    page.section("The worst cells", "One of each class, the four that go farthest beyond.")
        .figure(*curve);
  }
  page.section("By class").table(class_table(campaign));
  if (!campaign.pairs.empty()) page.section("Two faults at once").table(pair_table(campaign));
  telemetry::Part places, broken;
  places.table(site_table(campaign));
  broken.table(failed_table(campaign));
  page.section("Cell by cell",
               "People are phantoms; the tissue around a place is of one kind, as hard as in "
               "people of that build.")
      .folded("places", places)
      .folded("every broken promise", broken);
  return {};
}

}  // namespace

Result<std::string> page_of(const Campaign& campaign) {
  telemetry::Page page({.title = "Fault campaign",
                        .over = "tuina evaluate safety",
                        .badges = {"simulation"},
                        .heading = "What faults do to a person under the tool",
                        .lead = summary_of(campaign),
                        .footer = fmt::format("seed {}, {} form, world {}", campaign.order.seed,
                                              campaign.order.full ? "full" : "quick",
                                              campaign.order.config.simulation.realism)});
  if (!campaign.cells.empty())
    if (auto added = add_cells(campaign, page); !added) return tl::unexpected(added.error());
  if (!campaign.worst.empty()) {
    const auto curve = curve_plot("the worst of the search", curves_of(campaign.worst));
    if (!curve) return tl::unexpected(curve.error());
    page.section(
            "Sought on purpose",
            "A search varies size, moment, direction, place, tissue, friction and posture of "
            "each fault for the largest true force; the worst of each class, the first four drawn.")
        .figure(*curve)
        .table(worst_table(campaign));
  }
  if (!campaign.sessions.empty())
    page.section("Scans and sessions",
                 "What goes wrong with a whole scan or session. An acupoint may be 15 mm off, or "
                 "the scan has to be refused.")
        .table(session_table(campaign));
  if (const auto random = random_table(campaign); !random.rows.empty())
    page.section("Random trials").table(random);
  if (const auto people = people_table(campaign); !people.rows.empty())
    page.section(
            "Nobody is stopped for nothing",
            "People who breathe up to 12 mm deep, cough, shift, and whole sessions. None of it may "
            "end a massage by the guard; a controller that lets go of somebody who has moved goes "
            "on after another scan.")
        .table(people);
  page.section("Not in this campaign").table(elsewhere_table());
  return page.str();
}

}  // namespace tuina::app
