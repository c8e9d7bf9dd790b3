// SPDX-License-Identifier: Apache-2.0
#include "tuina/telemetry/report/page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "tuina/core/units.hpp"
#include "tuina/telemetry/plot/svg_plot.hpp"
#include "tuina/telemetry/report/conduct.hpp"
#include "tuina/telemetry/report/figures.hpp"
#include "tuina/telemetry/report/style.hpp"
#include "tuina/telemetry/report/tissue.hpp"

namespace tuina::telemetry {
namespace {

std::string minutes(double seconds) {
  const auto whole = static_cast<long>(std::lround(std::max(0.0, seconds)));
  if (whole < 60) return fmt::format("{} seconds", whole);
  return fmt::format("{} min {} s", whole / 60, whole % 60);
}

/// "a, b and c"
std::string listed(const std::vector<std::string>& words) {
  std::string text;
  for (std::size_t k = 0; k < words.size(); ++k) {
    if (k > 0) text += k + 1 == words.size() ? " and " : ", ";
    text += words[k];
  }
  return text;
}

std::string in_words(std::size_t count) {
  constexpr std::array<const char*, 13> words = {"no",   "one",    "two",   "three", "four",
                                                 "five", "six",    "seven", "eight", "nine",
                                                 "ten",  "eleven", "twelve"};
  return count < words.size() ? words[count] : fmt::format("{}", count);
}

/// Over the seven points of the thesis, as session.json counts it; over all if none of those is
/// there.
struct MeanError {
  double mean_m = 0.0;
  std::size_t points = 0;
};

std::optional<MeanError> mean_error(const ReportData& data) {
  MeanError seven;
  MeanError all;
  for (const FoundAcupoint& found : data.acupoints) {
    if (!found.error_m) continue;
    const bool one_of_seven = std::find(seven_acupoints.begin(), seven_acupoints.end(),
                                        found.acupoint.name) != seven_acupoints.end();
    for (MeanError* mean : {&seven, &all}) {
      if (mean == &seven && !one_of_seven) continue;
      mean->mean_m += *found.error_m;
      ++mean->points;
    }
  }
  MeanError& chosen = seven.points > 0 ? seven : all;
  if (chosen.points == 0) return std::nullopt;
  chosen.mean_m /= static_cast<double>(chosen.points);
  return chosen;
}

double peak_force_n(const ReportData& data) {
  double peak = 0.0;
  for (const TraceRow& row : data.trace)
    peak = std::max(peak, data.simulated ? row.true_force_n : row.measured_force_n);
  return peak;
}

/// What happened, for somebody who treats people and has no use for a plot.
std::string summary(const ReportData& data) {
  std::string text;
  text += fmt::format(
      "{} {} for a massage of {}. ", data.simulated ? "A simulated person" : "A person",
      data.position == Position::sitting ? "sat" : "lay face down", minutes(data.duration_s));
  if (!data.acupoints.empty()) {
    double widest = 0.0;
    for (const FoundAcupoint& found : data.acupoints)
      widest = std::max(widest, found.acupoint.uncertainty_m);
    text += fmt::format(
        "A laser scan of the back gave the places of {} acupoints, each known to "
        "within {:.0f} mm",
        in_words(data.acupoints.size()), std::ceil(to_mm(widest)));
    if (const auto error = mean_error(data)) {
      text += fmt::format(
          "; {} were {:.0f} mm from their true places on average",
          error->points == data.acupoints.size() ? "they" : "the main " + in_words(error->points),
          to_mm(error->mean_m));
    }
    text += ". ";
  }
  std::vector<std::string> done;
  for (const Technique technique : all_techniques) {
    std::set<std::string> places;
    std::size_t count = 0;
    for (const PerformedPath& performed : data.paths) {
      if (performed.path.technique != technique) continue;
      ++count;
      places.insert(performed.path.acupoints.begin(), performed.path.acupoints.end());
    }
    if (count == 0) continue;
    const std::size_t served = places.empty() ? count : places.size();
    done.push_back(fmt::format("{} {} {}", row_of(technique).did, in_words(served),
                               served == 1 ? "point" : "points"));
  }
  if (!done.empty()) text += fmt::format("Two arms {}. ", listed(done));
  if (!data.trace.empty())
    text += fmt::format("The firmest touch was {:.0f} N, the weight of {:.1f} kg. ",
                        peak_force_n(data), peak_force_n(data) / gravity_m_per_s2);
  const FeltTissue* softest = nullptr;
  const FeltTissue* hardest = nullptr;
  for (const FeltTissue& felt : data.tissue) {
    if (!felt.estimate.converged) continue;
    const double stiffness = felt.stiffness_n_per_mm;
    if (softest == nullptr || stiffness < softest->stiffness_n_per_mm) softest = &felt;
    if (hardest == nullptr || stiffness > hardest->stiffness_n_per_mm) hardest = &felt;
  }
  if (softest != hardest)
    text += fmt::format("The tissue felt hardest at {} and softest at {}. ",
                        figures::spoken(hardest->name), figures::spoken(softest->name));
  if (data.stops.empty())
    text += "Nothing had to be stopped.";
  else
    text += fmt::format("The session was stopped for safety after {}: {}.",
                        minutes(data.stops.front().time_s), data.stops.front().cause);
  return escaped(text);
}

std::string tile(const std::string& label, const std::string& value, const std::string& unit,
                 const std::string& remark) {
  return fmt::format(
      "<div class=tile><span class=label>{}</span><b>{}<small>{}</small></b><i>{}</i></div>",
      escaped(label), escaped(value), escaped(unit), escaped(remark));
}

std::string tiles(const ReportData& data) {
  std::string html = "<div class=tiles>";
  const long whole = std::lround(std::max(0.0, data.duration_s));
  html += tile("Massage", fmt::format("{}:{:02}", whole / 60, whole % 60), "min",
               fmt::format("{} paths of two arms", data.paths.size()));
  if (!data.acupoints.empty()) {
    const auto error = mean_error(data);
    html += error ? tile("Acupoints", fmt::format("{:.1f}", to_mm(error->mean_m)), "mm",
                         fmt::format("mean distance of {} to the truth", error->points))
                  : tile("Acupoints", fmt::format("{}", data.acupoints.size()), "", "found");
  }
  if (!data.trace.empty())
    html += tile("Peak force", fmt::format("{:.1f}", peak_force_n(data)), "N",
                 data.simulated ? "true force, whole session" : "measured, whole session");
  for (const TechniqueForce& force : data.forces) {
    if (force.technique == Technique::press)
      html += tile("Force error", fmt::format("{:.2f}", force.rmse_n), "N",
                   "root mean square while pressing");
  }
  for (const KeyNumber& number : data.numbers)
    html += tile(figures::capital(number.label), number.value, number.unit, number.remark);
  return html +
         tile("Stops", fmt::format("{}", data.stops.size()), "",
              data.stops.empty() ? "the guard never stepped in" : "see below") +
         "</div>";
}

std::string acupoint_table(const ReportData& data) {
  const bool truth = std::any_of(data.acupoints.begin(), data.acupoints.end(),
                                 [](const FoundAcupoint& f) { return f.error_m.has_value(); });
  std::string html = "<table><thead><tr><th>Point<th>within, mm";
  if (truth) html += "<th class=sim>distance to<br>the truth, mm";
  html += "</thead><tbody>";
  for (const FoundAcupoint& found : data.acupoints) {
    const Acupoint& point = found.acupoint;
    html += fmt::format("<tr><td>{}<em>{}</em><td>{:.1f}", escaped(figures::spoken(point.name)),
                        escaped(figures::chinese_name(point.name)), to_mm(point.uncertainty_m));
    if (truth)
      html += found.error_m ? fmt::format("<td class=sim>{:.1f}", to_mm(*found.error_m))
                            : "<td class=sim>";
  }
  return html + "</tbody></table>";
}

std::string back_section(const ReportData& data) {
  const std::string figure = figures::back(data);
  std::string html =
      "<section><h2>The back</h2><p>The surface that the scanner saw, with the acupoints that were "
      "found on it and the paths of both arms.</p><div class=two><div>";
  html +=
      figure.empty() ? "<p class=note>There is no scan to show.</p>" : figure + technique_key(data);
  html += "</div><div>";
  if (data.acupoints.empty()) {
    html += "<p class=note>No acupoint was located.</p>";
  } else {
    html +=
        acupoint_table(data) +
        "<p class=note>The pale ring around a point, and the column <i>within</i>, is the radius "
        "that holds the true point in 95 of 100 cases. Left and right are the person’s own.";
    if (mean_error(data))
      html +=
          " The last column compares with the simulated person’s true points, which only a "
          "simulation knows.";
    html += "</p>";
  }
  return html + "</div></div></section>";
}

std::string force_section(const ReportData& data) {
  std::string html =
      "<section class=long><h2>The force on the skin</h2><p>What was asked for, what the "
      "person truly felt, and what the sensor at the wrist said. Contacts stand one behind the "
      "other; the travel between them is left out.</p>";
  bool any = false;
  for (const Technique technique : all_techniques) {
    const std::string figure = figures::force(data, technique);
    if (figure.empty()) continue;
    any = true;
    html += fmt::format("<h3 style=\"color:{}\">{}</h3>", css(colour_of(technique)),
                        figures::capital(row_of(technique).doing));
    for (const TechniqueForce& force : data.forces) {
      if (force.technique == technique)
        html += fmt::format(
            "<p class=note>Root mean square error {:.2f} N, peak {:.1f} N (true force{}).</p>",
            force.rmse_n, force.peak_n, data.simulated ? ", known only in simulation" : "");
    }
    html += "<div class=wide>" + figure + "</div>";
  }
  const std::string close_up = figures::first_press_force(data);
  if (!close_up.empty()) {
    html += "<h3>The first press, close up</h3><div class=even><div class=\"wide half\">" +
            close_up + "</div><div class=\"wide half\">" + figures::first_press_depth(data) +
            "</div></div>";
  }
  if (!any) html += "<p class=note>There is no record of forces.</p>";
  return html + "</section>";
}

std::string stops_section(const ReportData& data) {
  std::string html = "<section><h2>Stops</h2>";
  if (data.stops.empty())
    html += "<p class=calm>The guard watched every millisecond and had no cause to stop.</p>";
  for (const Stop& stop : data.stops)
    html +=
        fmt::format("<p class=stop><b>{:.3f} s</b> &ensp;{}</p>", stop.time_s, escaped(stop.cause));
  std::string troubles;
  for (const PerformedPath& performed : data.paths) {
    if (performed.trouble.empty()) continue;
    troubles += fmt::format("<li>{} arm, {}: {}</li>", name_of(performed.arm),
                            escaped(performed.path.name), escaped(performed.trouble));
  }
  if (!troubles.empty()) html += "<h3>Not carried out as planned</h3><ul>" + troubles + "</ul>";
  return html + "</section>";
}

}  // namespace

std::string report_page(const ReportData& data) {
  const std::string title = fmt::format("Massage of {}, {}", data.person, name_of(data.position));
  std::string html = fmt::format(
      "<!doctype html><html lang=en><head><meta charset=utf-8><meta name=viewport "
      "content=\"width=device-width,initial-scale=1\">"
      "<title>{} · tuina</title><style>{}</style></head><body><main>",
      escaped(title), report_style);
  html += "<header><div class=over><span>tuina massage report</span>";
  if (data.simulated) html += "<span class=badge>simulation</span>";
  if (!data.stops.empty()) html += "<span class=\"badge bad\">stopped</span>";
  html += fmt::format(
      "</div><h1>{}</h1><div class=meta>{}{}seed {}</div><p class=lead>{}</p></header>",
      escaped(data.person + ", " + name_of(data.position)),
      data.programme.empty() ? "" : "programme " + escaped(data.programme) + " &ensp;·&ensp; ",
      data.version.empty() ? "" : "tuina " + escaped(data.version) + " &ensp;·&ensp; ", data.seed,
      summary(data));
  html += tiles(data) + back_section(data) + conduct_section(data) + force_section(data) +
          tissue_section(data) + decisions_section(data) + stops_section(data);
  if (!data.config_toml.empty()) {
    html +=
        "<section class=long><h2>Configuration</h2><details><summary>Every setting of this "
        "session</summary><pre>" +
        escaped(data.config_toml) + "</pre></details></section>";
  }
  html += fmt::format(
      "<footer>{}tuina is open research software. It is not a medical device and makes no "
      "diagnosis.</footer></main></body></html>\n",
      data.simulated
          ? "No person and no robot took part: everything on this page happened in a simulation. "
          : "");
  return html;
}

std::string back_picture(const ReportData& data) {
  return figures::back(data);
}

}  // namespace tuina::telemetry
