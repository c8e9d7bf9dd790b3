// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <array>
#include <type_traits>

#include "apps/evaluation/history/change_power.hpp"
#include "apps/evaluation/history/known_back.hpp"
#include "apps/evaluation/history/known_points.hpp"

namespace tuina::app {

/// The days of one person; fields are found by `visit_fields`, as every cell's.
struct DaysOfOne {
  std::array<ReturnOutcome, returns.size()> days;
};

template <typename Days, typename Visit>
requires std::is_same_v<std::remove_const_t<Days>, DaysOfOne>
void visit_fields(Days& of_one, const Visit& visit) {
  for (std::size_t i = 0; i < returns.size(); ++i) {
    auto& day = of_one.days[i];
    const auto field = [&](const char* key, auto& value) {
      visit(fmt::format("{} {}", i, key).c_str(), value);
    };
    field("refused", day.refused);
    field("places", day.places);
    field("known", day.known);
    field("spared", day.spared);
    field("dropped", day.dropped);
    field("probing_s", day.probing_s);
    field("massage_s", day.massage_s);
    field("given", day.given);
    field("probed", day.probed);
    field("over_cap_n", day.over_cap_n);
    field("over_trip_n", day.over_trip_n);
  }
}

template <typename Outcome, typename Visit>
requires std::is_same_v<std::remove_const_t<Outcome>, PowerOutcome>
void visit_fields(Outcome& outcome, const Visit& visit) {
  visit("places", outcome.places);
  visit("found", outcome.found);
  visit("found_of_all", outcome.found_of_all);
  visit("found_whole", outcome.found_whole);
  visit("false_alarm", outcome.false_alarm);
  visit("whole_change", outcome.whole_change);
  visit("scatter", outcome.scatter);
}

template <typename Outcome, typename Visit>
requires std::is_same_v<std::remove_const_t<Outcome>, PointsOutcome>
void visit_fields(Outcome& outcome, const Visit& visit) {
  visit("refused", outcome.refused);
  visit("misfit_mm", outcome.misfit_mm);
  visit("error_mm", outcome.error_mm);
  visit("within", outcome.within);
  visit("others", outcome.others);
  visit("noticed", outcome.noticed);
  visit("harm_mm", outcome.harm_mm);
  visit("beyond", outcome.beyond);
}

}  // namespace tuina::app
