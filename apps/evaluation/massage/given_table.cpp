// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "apps/evaluation/massage/page.hpp"

namespace tuina::app {
namespace {

using Presses = std::vector<const GivenPress*>;

double percentile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  const auto k = static_cast<std::size_t>(share * static_cast<double>(values.size()));
  return values[std::min(values.size() - 1, k)];
}

void add_row(telemetry::Table& table, const std::string& name, const Presses& presses) {
  if (presses.empty()) return;
  std::vector<double> given, held;
  double as_planned = 0.0, foretold = 0.0, wrong = 0.0;
  for (const GivenPress* press : presses) {
    given.push_back(100.0 * press->given());
    held.push_back(100.0 * press->held_n / press->planned_n);
    as_planned += press->given() >= min_given && press->given() <= max_given;
    foretold += press->foretold;
    wrong += press->foretold_wrong;
  }
  const double percent = 100.0 / static_cast<double>(presses.size());
  table.add({name, presses.size(), percentile(given, 0.0), percentile(given, 0.1),
             percentile(given, 0.5), percentile(given, 0.9), percentile(given, 1.0),
             percentile(held, 0.5), percent * as_planned, percent * foretold,
             foretold > 0.0 ? telemetry::Cell(100.0 * wrong / foretold) : telemetry::Cell()});
}

}  // namespace

telemetry::Table given_table(const std::vector<const SessionOutcome*>& outcomes) {
  telemetry::Table table{
      .note =
          "Largest true force, per cent of the strongest force of the plan. Held: mean while all "
          "of it was asked for. As planned: 95 to 102 %. Foretold: before it, by those before; "
          "wrong: of these, the true force at the depth that was told is more than 15 % off. "
          "Counted from the first probing press of a place.",
      .columns = {{.head = "given"},
                  {.head = "presses", .key = "presses"},
                  {.head = "least, %", .key = "given_percent.min", .digits = 0},
                  {.head = "10 % below", .key = "given_percent.p10", .digits = 0},
                  {.head = "median", .key = "given_percent.median", .digits = 1},
                  {.head = "90 % below", .key = "given_percent.p90", .digits = 1},
                  {.head = "largest", .key = "given_percent.max", .digits = 1},
                  {.head = "held, median", .key = "held_percent", .digits = 1},
                  {.head = "as planned, %", .key = "as_planned_percent", .digits = 0},
                  {.head = "foretold, %", .key = "foretold_percent", .digits = 0},
                  {.head = "wrong, %", .key = "wrong_percent", .digits = 0}}};
  const auto rows_of = [&](const std::string& name,
                           const std::function<bool(const GivenPress&)>& wanted) {
    Presses chosen;
    for (const SessionOutcome* one : outcomes) {
      for (const GivenPress& press : one->presses) {
        if (press.planned_n > 0.0 && wanted(press)) chosen.push_back(&press);
      }
    }
    add_row(table, name, chosen);
  };
  constexpr int last = 6;
  for (const Technique technique : {Technique::press, Technique::tap}) {
    const char* what = name_of(technique);
    const auto at = [&](const GivenPress& press, bool probing) {
      return press.technique == technique && press.probing == probing;
    };
    for (int k = 1; k <= last; ++k) {
      rows_of(fmt::format("{} {}, probing", what, k),
              [&](const GivenPress& p) { return at(p, true) && p.index == k; });
    }
    for (int k = 1; k <= last; ++k) {
      const bool later = k == last;
      rows_of(fmt::format("{} {}{}", what, k, later ? " and later" : ""), [&](const GivenPress& p) {
        return at(p, false) && (p.index == k || (later && p.index > k));
      });
    }
    rows_of(fmt::format("all from {} 3 on", what),
            [&](const GivenPress& p) { return at(p, false) && p.index >= 3; });
  }
  return table;
}

telemetry::Table felt_table(const std::vector<const SessionOutcome*>& outcomes) {
  telemetry::Table table{
      .note =
          "Of all contacts that press a place, at their ends. The truth is the tangent of the "
          "first "
          "loading of the rested tissue at 10 mm/s. Held: it lies in the 95 % interval that is "
          "said.",
      .columns = {{.head = "felt"},
                  {.head = "contacts", .key = "contacts"},
                  {.head = "converged, %", .key = "converged_percent", .digits = 0},
                  {.head = "held, %", .key = "held_percent", .digits = 0},
                  {.head = "10 % below, %", .key = "error_percent.p10", .digits = 0},
                  {.head = "median", .key = "error_percent.median", .digits = 0},
                  {.head = "90 % below", .key = "error_percent.p90", .digits = 0},
                  {.head = "interval, median +- %", .key = "reach_percent", .digits = 0}}};
  const auto add = [&](const char* name, double FeltTrial::*error, double FeltTrial::*reach) {
    std::vector<double> errors, reaches;
    double converged = 0.0, held = 0.0;
    for (const SessionOutcome* one : outcomes) {
      for (const FeltTrial& felt : one->felt) {
        errors.push_back(100.0 * std::expm1(felt.*error));
        reaches.push_back(100.0 * felt.*reach);
        converged += felt.converged;
        held += std::abs(felt.*error) <= felt.*reach;
      }
    }
    if (errors.empty()) return;
    const double percent = 100.0 / static_cast<double>(errors.size());
    table.add({name, errors.size(), percent * converged, percent * held, percentile(errors, 0.1),
               percentile(errors, 0.5), percentile(errors, 0.9), percentile(reaches, 0.5)});
  };
  add("alpha", &FeltTrial::alpha_error, &FeltTrial::alpha_reach);
  add("beta", &FeltTrial::beta_error, &FeltTrial::beta_reach);
  return table;
}

}  // namespace tuina::app
