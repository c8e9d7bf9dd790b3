// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>

#include "apps/cli/table.hpp"
#include "apps/evaluation/cells.hpp"
#include "apps/evaluation/history/change_power.hpp"
#include "apps/evaluation/history/known_back.hpp"
#include "apps/evaluation/verbs.hpp"
#include "tuina/core/parallel.hpp"

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
  visit("false_alarm", outcome.false_alarm);
  visit("stiffness_change", outcome.stiffness_change);
  visit("scatter", outcome.scatter);
}

namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

constexpr std::array scatters = {0.0, 0.05};

/// A folder of this program that goes with the object.
struct TemporaryFolder {
  explicit TemporaryFolder(std::size_t number)
      : path(fs::temp_directory_path() / fmt::format("tuina-{}-{}", ::getpid(), number)) {
    std::error_code fault;
    fs::create_directories(path, fault);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder() {
    std::error_code fault;
    fs::remove_all(path, fault);
  }
  fs::path path;
};

/// What earlier sessions are good for: known tissue on another day, and the test of real changes.
class EvaluateHistory final : public Verb {
 public:
  [[nodiscard]] const char* name() const override { return "evaluate history"; }
  [[nodiscard]] const char* summary() const override {
    return "people who come back: probing spared where tissue is known, power of the change test";
  }
  [[nodiscard]] const char* example() const override {
    return "tuina evaluate history --people 6 --tested 20";
  }
  void describe(Options& options) override {
    options.add("--people", people_, "who come back, each to six sessions after a first one")
        .between(0, 1000)
        .show_default();
    options
        .add("--tested", tested_,
             "people of 20 places for the test of real changes, with each scatter between sessions")
        .between(0, 1000)
        .show_default();
    cells_.describe(options);
  }

  [[nodiscard]] Result<Answer> run(const CommonOptions& common) override {
    const auto config = effective_config(common);
    if (!config) return tl::unexpected(config.error());
    if (auto opened = cells_.open(common, *config); !opened) return tl::unexpected(opened.error());
    const auto people = static_cast<std::size_t>(people_), tested = scatters.size() * tested_;
    std::vector<Result<DaysOfOne>> days(people);
    std::vector<Result<PowerOutcome>> powers(tested);
    for_each_in_parallel(
        people + tested,
        [&](std::size_t i) {
          if (i < people)
            days[i] = days_of(i, common.seed, *config);
          else
            powers[i - people] = power_of(i - people, common.seed);
        },
        progress_bar(common, "people"));
    for (const auto& one : days)
      if (!one) return tl::unexpected(one.error());
    for (const auto& one : powers)
      if (!one) return tl::unexpected(one.error());
    return cells_.answer([&] { return answer(days, powers); });
  }

 private:
  [[nodiscard]] Result<DaysOfOne> days_of(std::size_t k, std::uint64_t seed,
                                          const session::Config& config) {
    constexpr std::array who = {"phantom:slim", "phantom:medium", "phantom:hefty"};
    const auto position = k / who.size() % 2 == 0 ? BodyPosture::sitting : BodyPosture::prone;
    const std::string name =
        fmt::format("{} {} {}", who[k % who.size()], name_of(position), seed + k);
    return cells_.at<DaysOfOne>(name, [&]() -> Result<DaysOfOne> {
      auto person = sim::parse_person(who[k % who.size()], position, seed + k);
      if (!person) return tl::unexpected(person.error());
      person->name = "person";
      const TemporaryFolder folder(k);
      auto outcomes = come_back(*person, seed + k, config, folder.path);
      if (!outcomes) return tl::unexpected(outcomes.error());
      return DaysOfOne{std::move(*outcomes)};
    });
  }

  [[nodiscard]] Result<PowerOutcome> power_of(std::size_t k, std::uint64_t seed) {
    const double scatter = scatters[k % scatters.size()];
    const std::uint64_t drawn_by = seed + k / scatters.size();
    return cells_.at<PowerOutcome>(
        fmt::format("power {} {}", scatter, drawn_by),
        [&]() -> Result<PowerOutcome> { return try_power(scatter, drawn_by); });
  }

  static telemetry::Table days_table(const std::vector<Result<DaysOfOne>>& people) {
    telemetry::Table table{
        .title = "People who come back",
        .columns = {
            {.head = "they come back", .key = "return"},
            {.key = "sessions"},
            {.key = "refused"},
            {.head = "places", .key = "places"},
            {.head = "known", .key = "known"},
            {.head = "one press", .key = "spared"},
            {.head = "dropped", .key = "dropped"},
            {.head = "probing, s a place", .key = "probing_s", .digits = 2},
            {.head = "massage, s", .key = "massage_s", .digits = 1},
            {.head = "within 5 %, %", .key = "within_percent", .digits = 1, .truth = true},
            {.head = "highest, % of plan", .key = "highest_percent", .digits = 1, .truth = true},
            {.head = "highest probe, %",
             .key = "highest_probe_percent",
             .digits = 1,
             .truth = true},
            {.head = "over cap, N", .key = "over_cap_n", .digits = 2, .truth = true},
            {.head = "over trip, N", .key = "over_trip_n", .digits = 2, .truth = true}}};
    for (std::size_t i = 0; i < returns.size(); ++i) {
      int refused = 0, sessions = 0, places = 0, known = 0, spared = 0, dropped = 0, within = 0;
      double probing_s = 0.0, massage_s = 0.0, highest = 0.0, highest_probe = 0.0;
      double over_cap_n = -1e9, over_trip_n = -1e9;
      std::size_t given = 0;
      for (const Result<DaysOfOne>& person : people) {
        const ReturnOutcome& day = person->days[i];
        if (!day.refused.empty()) {
          ++refused;
          continue;
        }
        ++sessions;
        places += day.places;
        known += day.known;
        spared += day.spared;
        dropped += day.dropped;
        probing_s += day.probing_s;
        massage_s += day.massage_s;
        given += day.given.size();
        for (const double share : day.given) {
          within += std::abs(share - 1.0) <= 0.05 ? 1 : 0;
          highest = std::max(highest, share);
        }
        for (const double share : day.probed) highest_probe = std::max(highest_probe, share);
        over_cap_n = std::max(over_cap_n, day.over_cap_n);
        over_trip_n = std::max(over_trip_n, day.over_trip_n);
      }
      table.add({returns[i].name, sessions, refused, places, known, spared, dropped,
                 probing_s / std::max(places, 1), massage_s / std::max(sessions, 1),
                 100.0 * within / static_cast<double>(std::max<std::size_t>(given, 1)),
                 100.0 * highest, 100.0 * highest_probe, over_cap_n, over_trip_n});
    }
    return table;
  }

  static telemetry::Table power_table(const std::vector<Result<PowerOutcome>>& tested) {
    telemetry::Table table{
        .title = "Alpha harder by 10 %, five presses, 20 places, 5 % false alarms",
        .columns = {
            {.head = "scatter, %", .key = "scatter_percent", .digits = 0},
            {.key = "people"},
            {.head = "found, one place, %", .key = "power_percent", .digits = 1},
            {.head = "found, all places, %", .key = "power_of_all_percent", .digits = 1},
            {.head = "false alarms, %", .key = "false_percent", .digits = 1},
            {.head = "scatter told, %", .key = "told_percent", .digits = 1},
            {.head = "stiffness at 10 N, %", .key = "stiffness_change_percent", .digits = 1}}};
    for (std::size_t k = 0; k < scatters.size(); ++k) {
      int people = 0, places = 0, found = 0, found_of_all = 0, wrong = 0;
      double told = 0.0, change = 0.0;
      for (std::size_t i = k; i < tested.size(); i += scatters.size()) {
        const PowerOutcome& one = *tested[i];
        ++people;
        places += one.places;
        found += one.found;
        found_of_all += one.found_of_all;
        wrong += one.false_alarm ? 1 : 0;
        told += one.scatter;
        change += one.stiffness_change;
      }
      const double n = std::max(people, 1), of = std::max(places, 1);
      table.add({100.0 * scatters[k], people, 100.0 * found / of, 100.0 * found_of_all / of,
                 100.0 * wrong / n, 100.0 * told / n, 100.0 * change / n});
    }
    return table;
  }

  static Answer answer(const std::vector<Result<DaysOfOne>>& days,
                       const std::vector<Result<PowerOutcome>>& powers) {
    const auto back = days_table(days), power = power_table(powers);
    ordered_json refusals = ordered_json::array();
    for (const Result<DaysOfOne>& person : days) {
      for (const ReturnOutcome& day : person->days)
        if (!day.refused.empty()) refusals.push_back(day.refused);
    }
    return {.json = ordered_json{{"returns", to_json_by_name(back)},
                                 {"refusals", refusals},
                                 {"power", to_json(power)}}
                        .dump(2),
            .text = to_text(back) + "\n" + to_text(power)};
  }

  Cells cells_;
  int people_ = 6, tested_ = 20;
};

}  // namespace

std::unique_ptr<Verb> make_evaluate_history() {
  return std::make_unique<EvaluateHistory>();
}

}  // namespace tuina::app
