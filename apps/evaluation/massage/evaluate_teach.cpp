// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <limits>
#include <mutex>
#include <nlohmann/json.hpp>

#include "apps/cli/table.hpp"
#include "apps/evaluation/cells.hpp"
#include "apps/evaluation/verbs.hpp"
#include "apps/simulated/play_motion.hpp"
#include "apps/simulated/simulated_session.hpp"
#include "apps/simulated/teaching.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/core/io/scratch_folder.hpp"
#include "tuina/core/parallel.hpp"
#include "tuina/core/units.hpp"

namespace tuina::app {
namespace {

using nlohmann::ordered_json;

/// The points that the stroke is meant to pass, on the left side.
constexpr std::array stroke_points = {"SI11_L", "BL47_L", "BL50_L"};
constexpr double strokes_n = 5.0;  // above this the tool works, below it is on its way

constexpr const char* automatic_stroke = R"(name = "one_stroke"
description = """
The stroke that the masseur shows, planned."""
[[part]]
technique = "stroke"
points = ["SI11", "BL47", "BL50"]
side = "left"
force_n = 12
speed_mm_per_s = 60
repeats = 2
)";

/// How one person got the stroke in one way.
struct Given {
  std::string failed = {};  ///< why not; the rest is then empty
  double time_s = 0.0;      ///< until it was given, what has to be done for this person included
  double passes_m = 0.0;    ///< the true points by so much, mean of three
  double force_rmse_n = 0.0;
};

struct Ways {
  std::string person;
  Given taught, carried, automatic;
};

template <typename Outcome, typename Visit>
requires std::is_same_v<std::remove_const_t<Outcome>, Ways>
void visit_fields(Outcome& ways, const Visit& visit) {
  visit("person", ways.person);
  const auto visit_way = [&](const std::string& way, auto& given) {
    visit((way + "_failed").c_str(), given.failed);
    visit((way + "_time_s").c_str(), given.time_s);
    visit((way + "_passes_m").c_str(), given.passes_m);
    visit((way + "_force_rmse_n").c_str(), given.force_rmse_n);
  };
  visit_way("taught", ways.taught);
  visit_way("carried", ways.carried);
  visit_way("automatic", ways.automatic);
}

/// How near a tool came to the points while it worked, mean of the points.
template <typename Rows, typename Place>
double passes_m(const Rows& rows, const std::vector<Acupoint>& truth, const Place& place) {
  double sum_m = 0.0;
  for (const char* name : stroke_points) {
    const auto point = std::find_if(truth.begin(), truth.end(),
                                    [&](const Acupoint& one) { return one.name == name; });
    double nearest_m = std::numeric_limits<double>::infinity();
    for (const auto& row : rows) {
      if (row.true_force_n < strokes_n) continue;
      nearest_m = std::min(nearest_m, (place(row) - point->at_in_couch).norm());
    }
    sum_m += nearest_m / static_cast<double>(stroke_points.size());
  }
  return sum_m;
}

/// The masseur shows the stroke on this very person, and the arm repeats it.
Given by_teaching(const std::string& person, const session::Config& config,
                  const CommonOptions& common) {
  const auto shown = record_by_hand({.person = person}, config, common);
  if (!shown) return {.failed = shown.error().message};
  const auto played = play_motion(shown->motion, person, config, common);
  if (!played) return {.failed = played.error().message};
  if (played->stop) return {.failed = *played->stop};
  const auto truth = sim::parse_person(person, shown->motion.position, common.seed);
  if (!truth) return {.failed = truth.error().message};
  return {.time_s = shown->motion.duration_s() + played->truth.back().time_s,
          .passes_m = passes_m(played->truth, truth->acupoints,
                               [](const TeachRow& row) { return row.tool_in_couch; }),
          .force_rmse_n = played->force_rmse_n};
}

/// Scan, map, plan and stroke; the person sits.
Given by_session(const std::string& person, const std::string& programme,
                 const session::Config& config, const CommonOptions& common) {
  SessionOrder order{.person = person, .position = BodyPosture::sitting, .programme = programme};
  const auto done = run_simulated_session(order, config, common);
  if (!done) return {.failed = done.error().message};
  if (!done->session.stops.empty())
    return {.failed = safety::name_of(done->session.stops.front().cause)};
  // The record has places as the session believed the robot to stand.
  const Transform true_from_believed =
      robot::mount_for(BodyPosture::sitting).base_from_couch.inverse() *
      done->session.base_from_couch;
  const double compute_s =
      1e-3 * (done->session.scan.compute_ms + done->session.locate_ms + done->session.plan_ms);
  return {.time_s = done->session.scan.sweep_s + compute_s + done->session.massage_s,
          .passes_m = passes_m(done->truth.trace, done->person.acupoints,
                               [&](const telemetry::TraceRow& row) {
                                 return Vector3(true_from_believed * row.tool_in_couch);
                               }),
          .force_rmse_n = done->truth.force.rmse_n};
}

/// Three columns of one way to get the stroke.
void add_columns(std::vector<telemetry::Column>& columns, const std::string& key,
                 const std::string& head) {
  columns.push_back({.head = head + ", s", .key = key + ".time_s", .digits = 0});
  columns.push_back({.head = "passes by, mm", .key = key + ".passes_mm", .digits = 1});
  columns.push_back({.head = "force error, N", .key = key + ".force_rmse_n", .digits = 2});
  columns.push_back({.key = key + ".failed"});
}

void add_cells(std::vector<telemetry::Cell>& cells, const Given& given) {
  if (given.failed.empty()) {
    cells.insert(cells.end(), {given.time_s, to_mm(given.passes_m), given.force_rmse_n, {}});
  } else {
    cells.insert(cells.end(), {{}, {}, {}, given.failed});
  }
}

/// Over those who got it.
Given mean_of(const std::vector<Ways>& all, Given Ways::*way) {
  Given mean;
  double count = 0.0;
  for (const Ways& one : all) {
    const Given& given = one.*way;
    if (!given.failed.empty()) continue;
    mean.time_s += given.time_s;
    mean.passes_m += given.passes_m;
    mean.force_rmse_n += given.force_rmse_n;
    count += 1.0;
  }
  if (count == 0.0) return {.failed = "nobody got it"};
  mean.time_s /= count;
  mean.passes_m /= count;
  mean.force_rmse_n /= count;
  return mean;
}

/// The comparison of [thesis] 5.5: one stroke of the left side, shown anew to each person, shown
/// once and carried to all, and planned.
class EvaluateTeach final : public Verb {
 public:
  [[nodiscard]] const char* name() const override { return "evaluate teach"; }
  [[nodiscard]] const char* summary() const override {
    return "one stroke for many people: shown and played, carried, and planned";
  }
  [[nodiscard]] const char* example() const override { return "tuina evaluate teach --people 10"; }
  void describe(Options& options) override {
    options.add("--people", people_, "that sit, slim, medium and hefty in turn")
        .between(1, 1000)
        .show_default();
    cells_.describe(options);
  }

  [[nodiscard]] Result<Answer> run(const CommonOptions& common) override {
    const auto config = effective_config(common);
    if (!config) return tl::unexpected(config.error());
    if (auto opened = cells_.open(common, *config); !opened) return tl::unexpected(opened.error());
    CommonOptions quiet = common;
    quiet.quiet = true;
    const auto folder = ScratchFolder::make();
    if (!folder) return tl::unexpected(folder.error());
    const std::string planned = folder->path() / "planned.toml";
    const std::string carried = folder->path() / "carried.toml";
    const auto shown = record_by_hand({}, *config, quiet);
    if (!shown) return tl::unexpected(shown.error());
    const auto programme = session::programme_of(shown->motion);
    if (!programme) return tl::unexpected(programme.error());
    if (auto written = write_file(planned, automatic_stroke); !written)
      return tl::unexpected(written.error());
    if (auto written = write_file(carried, *programme); !written)
      return tl::unexpected(written.error());
    std::vector<Ways> all(static_cast<std::size_t>(people_));
    std::mutex guard;  // of the first failure
    std::optional<Error> failure;
    const auto give = [&](std::size_t i) {
      constexpr std::array builds = {"phantom:slim", "phantom:medium", "phantom:hefty"};
      CommonOptions own = quiet;
      own.seed = common.seed + i;
      const char* person = builds[i % builds.size()];
      const std::string name = fmt::format("{} --seed {}", person, own.seed);
      auto ways = cells_.at<Ways>(name, [&]() -> Result<Ways> {
        return Ways{.person = name,
                    .taught = by_teaching(person, *config, own),
                    .carried = by_session(person, carried, *config, own),
                    .automatic = by_session(person, planned, *config, own)};
      });
      const std::lock_guard lock(guard);
      if (!ways) {
        failure = ways.error();
      } else {
        all[i] = std::move(*ways);
      }
    };
    for_each_in_parallel(all.size(), give, progress_bar(common, "people"));
    if (failure) return tl::unexpected(*failure);
    return cells_.answer([&]() -> Result<Answer> { return answer_of(std::move(all)); });
  }

 private:
  [[nodiscard]] static Answer answer_of(std::vector<Ways> all) {
    all.push_back({.person = "mean of those who got it",
                   .taught = mean_of(all, &Ways::taught),
                   .carried = mean_of(all, &Ways::carried),
                   .automatic = mean_of(all, &Ways::automatic)});
    return answer(all);
  }
  [[nodiscard]] static Answer answer(const std::vector<Ways>& all) {
    telemetry::Table table{.note =
                               "time until it was given; mean distance by which it passes SI11, "
                               "BL47 and BL50; force error, RMS",
                           .columns = {{.head = "person", .key = "person"}}};
    add_columns(table.columns, "taught", "shown and played");
    add_columns(table.columns, "carried", "shown once, carried");
    add_columns(table.columns, "automatic", "planned");
    std::string failures;
    for (const Ways& one : all) {
      std::vector<telemetry::Cell> cells = {one.person};
      for (const Given& given : {one.taught, one.carried, one.automatic}) {
        add_cells(cells, given);
        if (!given.failed.empty()) failures += fmt::format("{}: {}\n", one.person, given.failed);
      }
      table.add(std::move(cells));
    }
    ordered_json people = to_json(table);
    const ordered_json mean = people.back();
    people.erase(people.size() - 1);
    const ordered_json json = {{"teach", {{"people", people}, {"mean", mean}}}};
    return {.json = json.dump(2), .text = to_text(table) + failures};
  }

  Cells cells_;
  int people_ = 10;
};

}  // namespace

std::unique_ptr<Verb> make_evaluate_teach() {
  return std::make_unique<EvaluateTeach>();
}

}  // namespace tuina::app
