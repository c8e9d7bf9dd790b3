// SPDX-License-Identifier: Apache-2.0
#include "apps/evaluation/history/known_back.hpp"

#include <algorithm>
#include <limits>
#include <map>

#include "apps/simulated/session_files.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/history/remembered.hpp"

namespace tuina::app {
namespace {

constexpr const char* programme = R"(name = "presses"
[[part]]
technique = "press"
points = ["SI11", "BL47", "BL50", "GV4"]
force_n = 22
repeats = 2
hold_s = 0.5
)";

bool probed_a_place(const session::Decision& made) {
  return made.rule == std::string_view("A1") && made.from_n == 0.0;
}

ReturnOutcome judge(const SessionResult& done) {
  ReturnOutcome outcome{.known = static_cast<int>(done.session.known.size()),
                        .massage_s = done.session.massage_s,
                        .over_cap_n = -std::numeric_limits<double>::infinity(),
                        .over_trip_n = -std::numeric_limits<double>::infinity()};
  for (const session::Decision& made : done.session.decisions) {
    if (made.rule != std::string_view("A1")) continue;
    if (!probed_a_place(made)) {
      ++outcome.dropped;
      continue;
    }
    ++outcome.places;
    for (const session::Performed& performed : done.session.performed) {
      if (performed.path == made.path && performed.begin_s <= made.time_s &&
          made.time_s <= performed.end_s)
        outcome.probing_s += made.time_s - performed.begin_s;
    }
  }
  std::map<std::string, int> probes;
  for (const GivenPress& press : done.truth.presses) {
    if (press.technique != Technique::press) continue;
    (press.probing ? outcome.probed : outcome.given).push_back(press.given());
    if (press.probing) ++probes[press.place];
  }
  for (const auto& [place, presses] : probes) outcome.spared += presses == 1 ? 1 : 0;
  std::vector<Touched> all_touched = done.truth.touched;
  all_touched.push_back(done.truth.unplanned);
  for (const Touched& touched : all_touched) {
    outcome.over_cap_n = std::max(outcome.over_cap_n, touched.over_cap_n);
    outcome.over_trip_n = std::max(outcome.over_trip_n, touched.over_trip_n);
  }
  return outcome;
}

}  // namespace

Result<std::array<ReturnOutcome, returns.size()>> come_back(const sim::Person& person,
                                                            std::uint64_t seed,
                                                            const session::Config& config,
                                                            const std::filesystem::path& folder) {
  if (auto written = sim::write_person(person, folder); !written)
    return tl::unexpected(written.error());
  SessionOrder order{.person = folder / (person.name + ".ply"),
                     .programme = folder / "presses.toml"};
  if (auto written = write_file(order.programme, programme); !written)
    return tl::unexpected(written.error());
  std::array<ReturnOutcome, returns.size()> outcomes;
  const auto first = run_simulated_session(order, config, {.quiet = true, .seed = seed});
  if (!first) {
    for (ReturnOutcome& outcome : outcomes) outcome.refused = "at first: " + first.error().message;
    return outcomes;
  }
  record::SessionFile file = session_file(*first, order, seed);
  file.visit = {"somebody", "first", "2026-01-01T09:00:00Z"};
  const std::vector<history::Visit> visits = {history::visit_of(file, folder)};
  const session::KnownTissue known = history::known_tissue(visits.front(), visits);
  for (std::size_t i = 0; i < returns.size(); ++i) {
    session::Config changed = config;
    changed.simulation.tissue_change_share = returns[i].tissue_change_share;
    if (returns[i].known)
      order.known = known;
    else
      order.known.reset();
    const auto again =
        run_simulated_session(order, changed, {.quiet = true, .seed = seed + 1'000'000});
    outcomes[i] = again ? judge(*again) : ReturnOutcome{.refused = again.error().message};
  }
  return outcomes;
}

}  // namespace tuina::app
