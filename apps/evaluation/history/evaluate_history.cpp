// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "apps/evaluation/cells.hpp"
#include "apps/evaluation/history/tables.hpp"
#include "apps/evaluation/verbs.hpp"
#include "apps/simulated/atlas_source.hpp"
#include "tuina/core/parallel.hpp"

namespace tuina::app {

namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

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
    return "people who come back: probing spared, their acupoints, power of the change test";
  }
  [[nodiscard]] const char* example() const override {
    return "tuina evaluate history --people 6 --tested 20";
  }
  void describe(Options& options) override {
    options.add("--people", people_, "who come back, each to six sessions after a first one")
        .between(0, 1000)
        .show_default();
    options
        .add("--tested", tested_, "people of 20 places for the test of real changes, in each world")
        .between(0, 1000)
        .show_default();
    options.add(
        "--bodies", bodies_,
        "labelled bodies whose acupoints are found in a second scan, with what a finger has "
        "shown in the first, and with the history of each other");
    cells_.describe(options);
  }

  [[nodiscard]] Result<Answer> run(const CommonOptions& common) override {
    const auto config = effective_config(common);
    if (!config) return tl::unexpected(config.error());
    if (auto opened = cells_.open(common, *config); !opened) return tl::unexpected(opened.error());
    auto come_back = returning(common.seed);
    if (!come_back) return tl::unexpected(come_back.error());
    std::optional<ReturningPeople>& bodies = *come_back;
    const auto people = static_cast<std::size_t>(people_);
    const auto tested = power_worlds.size() * static_cast<std::size_t>(tested_);
    std::vector<Result<DaysOfOne>> days(people);
    std::vector<Result<PowerOutcome>> powers(tested);
    std::vector<Result<PointsOutcome>> points(bodies ? bodies->size() : 0);
    for_each_in_parallel(
        people + tested + points.size(),
        [&](std::size_t i) {
          if (i < people)
            days[i] = days_of(i, common.seed, *config);
          else if (i < people + tested)
            powers[i - people] = power_of(i - people, common.seed);
          else
            points[i - people - tested] = points_of(*bodies, i - people - tested);
        },
        progress_bar(common, "people"));
    for (const auto& one : days)
      if (!one) return tl::unexpected(one.error());
    for (const auto& one : powers)
      if (!one) return tl::unexpected(one.error());
    for (const auto& one : points)
      if (!one) return tl::unexpected(one.error());
    return cells_.answer([&] { return answer(days, powers, points); });
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

  [[nodiscard]] Result<std::optional<ReturningPeople>> returning(std::uint64_t seed) const {
    std::optional<ReturningPeople> people;
    if (bodies_.empty()) return people;
    auto bodies = read_labelled({bodies_});
    if (!bodies) return tl::unexpected(bodies.error());
    auto atlas = open_atlas("");
    if (!atlas) return tl::unexpected(atlas.error());
    people.emplace(std::move(*bodies), std::move(*atlas), seed);
    return people;
  }

  [[nodiscard]] Result<PointsOutcome> points_of(ReturningPeople& people, std::size_t k) {
    return cells_.at<PointsOutcome>("points " + people.id(k),
                                    [&]() -> Result<PointsOutcome> { return people.come_back(k); });
  }

  [[nodiscard]] Result<PowerOutcome> power_of(std::size_t k, std::uint64_t seed) {
    const PowerWorld& world = power_worlds[k % power_worlds.size()];
    const std::uint64_t drawn_by = seed + k / power_worlds.size();
    return cells_.at<PowerOutcome>(
        fmt::format("power {} {} {}", world.tissue, world.scatter, drawn_by),
        [&]() -> Result<PowerOutcome> { return try_power(world, drawn_by); });
  }

  static Answer answer(const std::vector<Result<DaysOfOne>>& days,
                       const std::vector<Result<PowerOutcome>>& powers,
                       const std::vector<Result<PointsOutcome>>& people) {
    const auto back = days_table(days), power = power_table(powers), points = points_table(people),
               others = others_table(people);
    ordered_json refusals = ordered_json::array();
    for (const Result<DaysOfOne>& person : days) {
      for (const ReturnOutcome& day : person->days)
        if (!day.refused.empty()) refusals.push_back(day.refused);
    }
    ordered_json json{
        {"returns", to_json_by_name(back)}, {"refusals", refusals}, {"power", to_json(power)}};
    std::string text = to_text(back) + "\n" + to_text(power);
    if (!people.empty()) {
      json["points"] = to_json(points);
      json["others"] = to_json(others);
      text += "\n" + to_text(points) + "\n" + to_text(others);
    }
    return {.json = json.dump(2), .text = text};
  }

  Cells cells_;
  int people_ = 6, tested_ = 20;
  std::string bodies_;
};

}  // namespace

std::unique_ptr<Verb> make_evaluate_history() {
  return std::make_unique<EvaluateHistory>();
}

}  // namespace tuina::app
