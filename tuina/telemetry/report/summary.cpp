// SPDX-License-Identifier: Apache-2.0
#include "tuina/telemetry/report/summary.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "tuina/core/units.hpp"
#include "tuina/telemetry/report/conduct.hpp"
#include "tuina/telemetry/report/figures.hpp"

namespace tuina::telemetry {
namespace {

std::string minutes(const Language& say, double seconds) {
  const auto whole = static_cast<long>(std::lround(std::max(0.0, seconds)));
  if (whole < 60) return say("{} seconds", whole);
  return say("{} min {} s", whole / 60, whole % 60);
}

/// "a, b and c"
std::string listed(const Language& say, const std::vector<std::string>& words) {
  std::string text;
  for (std::size_t k = 0; k < words.size(); ++k) {
    if (k > 0) text += k + 1 == words.size() ? say(" and ") : say(", ");
    text += words[k];
  }
  return text;
}

std::string in_words(const Language& say, std::size_t count) {
  constexpr std::array<const char*, 13> words = {"zero", "one",    "two",   "three", "four",
                                                 "five", "six",    "seven", "eight", "nine",
                                                 "ten",  "eleven", "twelve"};
  return count < words.size() ? say(words[count]) : fmt::format("{}", count);
}

/// What the scan has given.
std::string scanned_in_words(const ReportData& data) {
  if (data.acupoints.empty()) return "";
  const Language& say = data.language;
  double widest = 0.0;
  for (const FoundAcupoint& found : data.acupoints)
    widest = std::max(widest, found.acupoint.uncertainty_m);
  std::string text = say(
      "A laser scan of the back gave the places of {} acupoints, each known to within {:.0f} mm",
      in_words(say, data.acupoints.size()), std::ceil(to_mm(widest)));
  if (const auto error = mean_error(data)) {
    const double mean_mm = to_mm(error->mean_m);
    text += error->points == data.acupoints.size()
                ? say("; they were {:.0f} mm from their true places on average", mean_mm)
                : say("; the main {} were {:.0f} mm from their true places on average",
                      in_words(say, error->points), mean_mm);
  }
  return text + say(". ");
}

/// What the arms did at how many points.
std::string done_in_words(const ReportData& data) {
  const Language& say = data.language;
  std::vector<std::string> done;
  bool left = false, right = false;
  for (const Technique technique : all_techniques) {
    std::set<std::string> places;
    std::size_t count = 0;
    for (const PerformedPath& performed : data.paths) {
      const bool touched = performed.ended_s() > performed.begin_s;
      if (performed.path.technique != technique || !touched) continue;
      ++count;
      (performed.arm == Arm::left ? left : right) = true;
      places.insert(performed.path.acupoints.begin(), performed.path.acupoints.end());
    }
    if (count == 0) continue;
    const std::size_t served = places.empty() ? count : places.size();
    const char* did = row_of(technique).did;
    done.push_back(served == 1 ? say("{} {} point", did, in_words(say, served))
                               : say("{} {} points", did, in_words(say, served)));
  }
  if (done.empty()) return "";
  if (left && right) return say("Two arms {}. ", listed(say, done));
  return left ? say("The left arm {}. ", listed(say, done))
              : say("The right arm {}. ", listed(say, done));
}

/// Where the tissue is hardest and softest, if presses that have settled tell the two apart.
std::string extremes_in_words(const ReportData& data) {
  const FeltTissue* softest = nullptr;
  const FeltTissue* hardest = nullptr;
  for (const FeltTissue& felt : data.tissue) {
    if (!felt.mapped || !felt.estimate.converged) continue;
    const double stiffness = felt.stiffness_n_per_mm;
    if (softest == nullptr || stiffness < softest->stiffness_n_per_mm) softest = &felt;
    if (hardest == nullptr || stiffness > hardest->stiffness_n_per_mm) hardest = &felt;
  }
  if (softest == hardest) return {};
  const double apart = hardest->stiffness_n_per_mm - softest->stiffness_n_per_mm;
  if (apart < std::hypot(hardest->stiffness_ci95_n_per_mm, softest->stiffness_ci95_n_per_mm))
    return {};
  return data.language("The tissue felt hardest at {} and softest at {}. ",
                       figures::spoken(hardest->name, data.language),
                       figures::spoken(softest->name, data.language));
}

}  // namespace

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

std::string summary(const ReportData& data) {
  const Language& say = data.language;
  std::string text =
      say("{} {} for a massage of {}. ", data.simulated ? "A simulated person" : "A person",
          data.position == BodyPosture::sitting ? "sat" : "lay face down",
          minutes(say, data.duration_s));
  text += scanned_in_words(data) + done_in_words(data);
  if (!data.trace.empty())
    text += say("The firmest touch was {:.0f} N, the weight of {:.1f} kg. ", peak_force_n(data),
                peak_force_n(data) / gravity_m_per_s2);
  text += extremes_in_words(data);
  text += given_in_words(data);
  for (const double time_s : data.rescans_s)
    text += say("The person had moved and was scanned again after {}. ", minutes(say, time_s));
  if (data.stops.empty())
    text += say("Nothing had to be stopped.");
  else if (data.stops.front().cause.key == "stopped_as_asked")
    text += say("The session was stopped after {}, as somebody asked.",
                minutes(say, data.stops.front().time_s));
  else
    text += say("The session was stopped for safety after {}: {}.",
                minutes(say, data.stops.front().time_s), say(data.stops.front().cause));
  return text;
}

}  // namespace tuina::telemetry
