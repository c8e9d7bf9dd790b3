// SPDX-License-Identifier: Apache-2.0
#include "apps/evaluation/massage/trials.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "apps/evaluation/cells.hpp"
#include "apps/evaluation/massage/outcome_fields.hpp"
#include "tuina/core/parallel.hpp"
#include "tuina/core/units.hpp"
#include "tuina/session/massage_step.hpp"

namespace tuina::app {
namespace {

/// The tool is to press within its contact radius of the true point.
constexpr double wanted_m = 17_mm;

bool bony(massage::Zone zone) {
  return session::guarded_zone(zone) == safety::Zone::bony;
}

bool of_the_seven(const std::string& name) {
  return std::find(seven_acupoints.begin(), seven_acupoints.end(), name) != seven_acupoints.end();
}

/// Of the point as it was mapped last.
double uncertainty_of(const SessionResult& done, const std::string& name) {
  for (const Acupoint& point : done.session.located.acupoints) {
    if (point.name == name) return point.uncertainty_m;
  }
  return 0.0;
}

FeltTrial felt_trial(const TissueEstimate& felt, const TangentTissue& truth) {
  return {.converged = felt.converged,
          .alpha_error = std::log(felt.tissue.alpha_n / truth.alpha_n),
          .alpha_reach = felt.alpha_ci95_n / felt.tissue.alpha_n,
          .beta_error = std::log(felt.tissue.beta_per_m / truth.beta_per_m),
          .beta_reach = felt.beta_ci95_per_m / felt.tissue.beta_per_m};
}

/// The presses from the third of a place on that were not as planned, each with what was decided.
std::vector<std::string> not_as_planned(const SessionResult& done) {
  std::vector<std::string> told;
  for (const GivenPress& press : done.truth.presses) {
    const double given = press.given();
    if (press.probing || press.index < 3 || (given >= min_given && given <= max_given)) continue;
    std::string why = "no rule";
    for (const session::Decision& made : done.session.decisions) {
      const bool meanwhile = made.arm == press.arm && made.time_s >= press.contact_s &&
                             made.time_s <= press.end_s && made.to_n < made.from_n;
      if (meanwhile) why = fmt::format("{}, {}", made.rule, made.reason);
    }
    told.push_back(fmt::format("{} {} of {}: {:.1f} N planned, {:.1f} N given ({})",
                               name_of(press.technique), press.index, press.place, press.planned_n,
                               press.peak_n, why));
  }
  return told;
}

/// Forces against what the true zones bear.
void judge_zone(const Touched& touched, const std::string& where, SessionOutcome& outcome) {
  if (bony(touched.zone)) outcome.bony_peak_n = std::max(outcome.bony_peak_n, touched.peak_n);
  outcome.over_cap_n = std::max(outcome.over_cap_n, touched.over_cap_n);
  outcome.over_trip_n = std::max(outcome.over_trip_n, touched.over_trip_n);
  if (touched.over_cap_n > 0.0)
    outcome.beyond.push_back(fmt::format("{}: {:.1f} N over what {} may be asked for", where,
                                         touched.over_cap_n,
                                         massage::name_of(touched.over_cap_zone)));
}

}  // namespace

SessionOutcome run_session_trial(const SessionTrial& trial, const session::Config& config) {
  SessionOutcome outcome;
  const auto done = run_simulated_session(trial.order, config, {.quiet = true, .seed = trial.seed});
  if (!done) {
    outcome.refused = done.error().message;
    return outcome;
  }
  outcome.position = done->session.located.position;
  outcome.duration_s = done->session.massage_s;
  outcome.rmse_n = done->truth.force.rmse_n;
  outcome.overshoot_n = done->truth.force.overshoot_n;
  outcome.arm_distance_m = done->truth.min_arm_distance_m;
  outcome.scan_to_touch_s = scan_to_touch_s(*done);
  outcome.plan_ms = done->session.plan_ms;
  outcome.presses = done->truth.presses;
  outcome.beyond = not_as_planned(*done);
  outcome.real_time_factor = done->real_time_factor();
  for (const session::Stop& stop : done->session.stops) {
    outcome.stops.push_back(session::explain(stop).words);
  }
  for (const Sentence& note : done->session.ready.plan.notes) {
    if (massage::tells_left_out(note)) outcome.left_out.push_back(note.words);
  }
  outcome.unplanned_n = done->truth.unplanned.peak_n;
  judge_zone(done->truth.unplanned, "outside the planned contacts", outcome);
  for (std::size_t i = 0; i < done->session.performed.size(); ++i) {
    const session::Performed& performed = done->session.performed[i];
    const massage::PlannedPath& planned =
        done->session.ready.plan.paths[static_cast<std::size_t>(performed.path)];
    const ContactPath& path = planned.path;
    const Touched& touched = done->truth.touched[i];
    if (performed.contact_fault != control::ContactFault::none) {
      outcome.troubles.push_back(
          fmt::format("{}: {}", path.name, control::name_of(performed.contact_fault)));
    }
    if (performed.felt && touched.peak_n > 0.0)
      outcome.felt.push_back(felt_trial(*performed.felt, touched.tissue));
    judge_zone(touched, fmt::format("{}, mapped {}", path.name, massage::name_of(planned.zone)),
               outcome);
    const auto off_m = tool_to_acupoint_m(*done, i);
    if (!off_m || !of_the_seven(path.acupoints.front())) continue;
    outcome.tool_to_acupoint_m.push_back(*off_m);
    if (*off_m > wanted_m) {
      outcome.beyond.push_back(fmt::format(
          "{}: the tool was {:.1f} mm from the true point, mapped "
          "to {:.1f} mm",
          path.name, to_mm(*off_m), to_mm(uncertainty_of(*done, path.acupoints.front()))));
    }
  }
  return outcome;
}

Result<std::vector<SessionOutcome>> run_session_trials(const std::vector<SessionTrial>& trials,
                                                       const session::Config& config, Cells& cells,
                                                       const Progress& progress) {
  std::vector<Result<SessionOutcome>> judged(trials.size());
  for_each_in_parallel(
      trials.size(),
      [&](std::size_t i) {
        const SessionOrder& order = trials[i].order;
        const std::string name = fmt::format(
            "{} {} {} {} {}", order.person, order.position ? name_of(*order.position) : "auto",
            order.programme, order.adaptive ? "on" : "off", trials[i].seed);
        judged[i] = cells.at<SessionOutcome>(
            name, [&]() -> Result<SessionOutcome> { return run_session_trial(trials[i], config); });
      },
      progress);
  std::vector<SessionOutcome> outcomes;
  for (auto& one : judged) {
    if (!one) return tl::unexpected(one.error());
    outcomes.push_back(std::move(*one));
  }
  return outcomes;
}

SessionSummary summarise(const std::vector<const SessionOutcome*>& outcomes) {
  SessionSummary sum{.sessions = outcomes.size(),
                     .min_arm_distance_m = std::numeric_limits<double>::infinity()};
  sum.max_over_cap_n = sum.max_over_trip_n = -std::numeric_limits<double>::infinity();
  std::vector<double> factors;
  std::size_t presses = 0;
  for (const SessionOutcome* one : outcomes) {
    if (!one->refused.empty()) {
      ++sum.refused;
      continue;
    }
    sum.stopped += one->stops.empty() ? 0 : 1;
    sum.troubled += one->troubles.empty() ? 0 : 1;
    sum.paths_left_out += one->left_out.size();
    sum.worst_rmse_n = std::max(sum.worst_rmse_n, one->rmse_n);
    sum.mean_rmse_n += one->rmse_n;
    sum.worst_overshoot_n = std::max(sum.worst_overshoot_n, one->overshoot_n);
    sum.max_over_cap_n = std::max(sum.max_over_cap_n, one->over_cap_n);
    sum.max_over_trip_n = std::max(sum.max_over_trip_n, one->over_trip_n);
    sum.max_unplanned_n = std::max(sum.max_unplanned_n, one->unplanned_n);
    sum.bony_peak_n = std::max(sum.bony_peak_n, one->bony_peak_n);
    sum.min_arm_distance_m = std::min(sum.min_arm_distance_m, one->arm_distance_m);
    sum.worst_scan_to_touch_s = std::max(sum.worst_scan_to_touch_s, one->scan_to_touch_s);
    sum.worst_plan_ms = std::max(sum.worst_plan_ms, one->plan_ms);
    sum.mean_duration_s += one->duration_s;
    factors.push_back(one->real_time_factor);
    for (const double off_m : one->tool_to_acupoint_m) {
      sum.mean_tool_to_acupoint_m += off_m;
      sum.max_tool_to_acupoint_m = std::max(sum.max_tool_to_acupoint_m, off_m);
      ++presses;
    }
  }
  if (factors.empty()) return sum;
  sum.mean_rmse_n /= static_cast<double>(factors.size());
  sum.mean_duration_s /= static_cast<double>(factors.size());
  sum.mean_tool_to_acupoint_m /= static_cast<double>(std::max<std::size_t>(presses, 1));
  std::nth_element(factors.begin(), factors.begin() + static_cast<long>(factors.size() / 2),
                   factors.end());
  sum.median_real_time_factor = factors[factors.size() / 2];
  return sum;
}

}  // namespace tuina::app
