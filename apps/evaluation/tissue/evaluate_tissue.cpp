// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <nlohmann/json.hpp>
#include <thread>

#include "apps/cli/table.hpp"
#include "apps/evaluation/cells.hpp"
#include "apps/evaluation/thesis/tissue.hpp"
#include "apps/evaluation/tissue/outcome_fields.hpp"
#include "apps/evaluation/tissue/page.hpp"
#include "apps/evaluation/tissue/trials.hpp"
#include "apps/evaluation/tissue/world_trials.hpp"
#include "apps/evaluation/verbs.hpp"
#include "tuina/core/io/file.hpp"

namespace tuina::app {
namespace {

/// JSON has no infinity: never is null.
nlohmann::json number(double value) {
  return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json();
}

bool has_interval(TrialMethod method) {
  return method == TrialMethod::tuina || method == TrialMethod::kalman ||
         method == TrialMethod::batch;
}

nlohmann::json to_json(const TrialResult& r, TrialMethod method) {
  nlohmann::json json = {{"runs", r.runs},
                         {"t95_s", number(r.t95_s)},
                         {"q95_first_press", number(r.first_press_q95)},
                         {"q95_last", number(r.last_q95)},
                         {"alpha_bias", number(r.alpha_bias)},
                         {"beta_bias", number(r.beta_bias)},
                         {"kept_share", r.kept_share},
                         {"detectable_change", number(r.detectable_change)}};
  json["coverage"] =
      has_interval(method) ? number(std::min(r.coverage_alpha, r.coverage_beta)) : nlohmann::json();
  if (method == TrialMethod::tuina) {
    json["converged_share"] = r.converged_share;
    json["converged_median_s"] = number(r.converged_median_s);
    json["false_converged_share"] = r.false_converged_share;
  }
  return json;
}

/// The worst of the three tissues, key by key.
TrialResult worst_of(const std::array<TrialResult, 3>& results) {
  TrialResult worst = results[0];
  const auto larger = [](double a, double b) {
    return std::isnan(a) ? b : std::isnan(b) ? a : std::max(a, b);
  };
  const auto wider = [](double a, double b) { return std::abs(b) > std::abs(a) ? b : a; };
  for (const TrialResult& r : results) {
    worst.t95_s = larger(worst.t95_s, r.t95_s);
    worst.first_press_q95 = larger(worst.first_press_q95, r.first_press_q95);
    worst.last_q95 = larger(worst.last_q95, r.last_q95);
    worst.alpha_bias = wider(worst.alpha_bias, r.alpha_bias);
    worst.beta_bias = wider(worst.beta_bias, r.beta_bias);
    worst.detectable_change = larger(worst.detectable_change, r.detectable_change);
    worst.coverage_alpha = std::min(worst.coverage_alpha, r.coverage_alpha);
    worst.coverage_beta = std::min(worst.coverage_beta, r.coverage_beta);
    worst.kept_share = std::min(worst.kept_share, r.kept_share);
    worst.converged_share = std::min(worst.converged_share, r.converged_share);
    worst.converged_median_s = larger(worst.converged_median_s, r.converged_median_s);
    worst.false_converged_share = larger(worst.false_converged_share, r.false_converged_share);
  }
  return worst;
}

std::string cell(double value, double scale) {
  if (std::isnan(value)) return "-";
  if (std::isinf(value)) return "never";
  const double shown = scale * value;
  if (std::abs(shown) >= 999.5) return ">999";
  return fmt::format("{:.{}f}", shown, std::abs(shown) >= 99.95 ? 0 : scale == 1.0 ? 2 : 1);
}

/// Three tissues in one cell; "never/never/never" says no more than "never".
std::string three_of(const std::array<TrialResult, 3>& r, double TrialResult::*member,
                     double scale) {
  const std::array cells = {cell(r[0].*member, scale), cell(r[1].*member, scale),
                            cell(r[2].*member, scale)};
  if (cells[0] == cells[1] && cells[1] == cells[2]) return cells[0];
  return fmt::format("{}/{}/{}", cells[0], cells[1], cells[2]);
}

telemetry::Table empty_table() {
  telemetry::Table table{
      .note =
          "Bone/hard/soft. t95: from then on 95 % of the runs stay within 5 %. Errors: 95 % "
          "quantile of the worse one of α and β. Bias and coverage of the 95 % intervals: α/β of "
          "the worst tissue. Detectable: smallest change of α between two such records that can "
          "be told from noise. False: called converged while beyond the promise, of all runs."};
  for (const char* head : {"method", "t95, s", "one press, %", "at the end, %", "bias, %",
                           "coverage", "detectable, %", "converged, %", "after, s", "false, %"})
    table.columns.push_back({.head = head});
  return table;
}

std::vector<telemetry::Cell> cells_of(TrialMethod method, const std::array<TrialResult, 3>& r) {
  const TrialResult worst = worst_of(r);
  const bool ours = method == TrialMethod::tuina;
  return {name_of(method),
          three_of(r, &TrialResult::t95_s, 1.0),
          three_of(r, &TrialResult::first_press_q95, 100.0),
          three_of(r, &TrialResult::last_q95, 100.0),
          fmt::format("{}/{}", cell(worst.alpha_bias, 100.0), cell(worst.beta_bias, 100.0)),
          has_interval(method)
              ? fmt::format("{:.2f}/{:.2f}", worst.coverage_alpha, worst.coverage_beta)
              : "-",
          three_of(r, &TrialResult::detectable_change, 100.0),
          ours ? three_of(r, &TrialResult::converged_share, 100.0) : "-",
          ours ? three_of(r, &TrialResult::converged_median_s, 1.0) : "-",
          ours ? cell(worst.false_converged_share, 100.0) : "-"};
}

/// Every estimator on many simulated people, sensors and disturbances (docs/tissue.md).
class EvaluateTissue final : public Verb {
 public:
  [[nodiscard]] const char* name() const override { return "evaluate tissue"; }
  [[nodiscard]] const char* summary() const override {
    return "estimators of tissue on simulated presses, scenario by scenario";
  }
  [[nodiscard]] const char* example() const override {
    return "tuina evaluate tissue --runs 50 --scenario N0 --out tissue.html";
  }
  void describe(Options& options) override {
    options.add("--runs", runs_, "per scenario and tissue").between(1, 100000).show_default();
    options
        .add("--arm-runs", arm_runs_,
             "per scenario and tissue pressed by the simulated arm; 0 leaves them out")
        .between(0, 100000)
        .show_default();
    options
        .add("--world-runs", world_runs_,
             "per world, tissue and way of pressing; 0 leaves the worlds out")
        .between(0, 100000)
        .show_default();
    std::vector<std::string> names;
    for (const auto& scenario : sim::press_scenarios()) names.push_back(scenario.name);
    for (const auto& scenario : loop_scenarios()) names.push_back(scenario.name);
    for (const auto& world : sim::tissue_worlds()) names.push_back(world.name);
    auto scenario =
        options.add("--scenario", scenario_, "one scenario or world only").one_of(names);
    options.flag("--thesis", thesis_, "chapter 6 of the thesis, claim by claim").excludes(scenario);
    options.add("--out", out_, "the tables and curves as one HTML page");
    cells_.describe(options, &out_);
  }

  [[nodiscard]] Result<Answer> run(const CommonOptions& common) override {
    common_ = &common;
    const Progress progress = progress_bar(common, "tissue");
    if (thesis_) return thesis(progress);
    const auto config = effective_config(common);
    if (!config) return tl::unexpected(config.error());
    if (auto opened = cells_.open(common, *config); !opened) return tl::unexpected(opened.error());
    const unsigned threads = std::clamp(std::thread::hardware_concurrency(), 1U, 8U);
    const std::uint64_t seed = common.seed * 1000003ULL;
    std::vector<sim::PressScenario> scenarios;
    for (const auto& scenario : sim::press_scenarios()) {
      if (scenario_.empty() || scenario.name == scenario_) scenarios.push_back(scenario);
    }
    std::vector<LoopScenario> loops;
    for (const auto& scenario : loop_scenarios()) {
      if (arm_runs_ > 0 && (scenario_.empty() || scenario.name == scenario_))
        loops.push_back(scenario);
    }
    std::vector<sim::TissueWorld> worlds;
    for (const auto& world : sim::tissue_worlds()) {
      if (world_runs_ > 0 && (scenario_.empty() || world.name == scenario_))
        worlds.push_back(world);
    }
    // An experiment with the arm takes about ten times as long as one drawn from a formula.
    const double all = 3.0 * (static_cast<double>(scenarios.size()) * runs_ +
                              10.0 * static_cast<double>(loops.size()) * arm_runs_ +
                              3.0 * static_cast<double>(worlds.size()) * world_runs_);
    double done = 0.0;
    const auto part = [&](double weight) {
      return [&progress, &done, all, weight](double share) {
        if (progress) progress(std::min(1.0, (done + weight * share) / all));
      };
    };
    for (const auto& scenario : scenarios) {
      std::array<TrialResults, 3> results;
      for (std::size_t k = 0; k < 3; ++k) {
        auto trials = cells_.at<TrialResults>(
            fmt::format("{} {}", scenario.name, trial_tissues[k].name),
            [&]() -> Result<TrialResults> {
              return run_trials(scenario, trial_tissues[k], runs_, seed, threads, part(runs_));
            });
        if (!trials) return tl::unexpected(trials.error());
        results[k] = std::move(*trials);
        done += runs_;
        // Tissue of another law has no true alpha: there only the claim to know it can be judged.
        if (scenario.law != sim::PressScenario::TissueModel::tangent) {
          for (TrialResult& r : results[k]) r.false_converged_share = r.converged_share;
        }
      }
      take(scenario.name, scenario.about, results);
    }
    for (const LoopScenario& scenario : loops) {
      std::array<TrialResults, 3> results;
      for (std::size_t k = 0; k < 3; ++k) {
        auto outcome = cells_.at<TrialResults>(
            fmt::format("{} {}", scenario.name, trial_tissues[k].name), [&] {
              return run_loop_trials(scenario, trial_tissues[k], arm_runs_, seed, threads,
                                     part(10.0 * arm_runs_));
            });
        if (!outcome) return tl::unexpected(outcome.error());
        results[k] = std::move(*outcome);
        done += 10.0 * arm_runs_;
      }
      take(scenario.name, scenario.about, results);
    }
    for (const sim::TissueWorld& world : worlds) {
      const auto result = cells_.at<WorldResult>(world.name, [&]() -> Result<WorldResult> {
        return run_world(world, world_runs_, seed, threads, part(9.0 * world_runs_));
      });
      if (!result) return tl::unexpected(result.error());
      page_.worlds.rows.push_back(row_of(world, *result));
      done += 9.0 * world_runs_;
    }
    return cells_.answer([&] { return answer(); });
  }

 private:
  void take(const std::string& name, const std::string& about,
            const std::array<TrialResults, 3>& by_tissue) {
    table_[name]["about"] = about;
    for (std::size_t m = 0; m < trial_methods.size(); ++m) {
      const TrialMethod method = trial_methods[m];
      const std::array<TrialResult, 3> results = {by_tissue[0][m], by_tissue[1][m],
                                                  by_tissue[2][m]};
      nlohmann::json entry = to_json(worst_of(results), method);
      for (std::size_t k = 0; k < results.size(); ++k)
        entry["by_tissue"][trial_tissues[k].name] = to_json(results[k], method);
      table_[name][name_of(method)] = entry;
      page_.table.rows.push_back({.cells = cells_of(method, results),
                                  .group = name + ": " + about,
                                  .emphasised = method == TrialMethod::tuina});
      for (std::size_t k = 0; k < results.size(); ++k)
        page_.curves.push_back(
            {name, name_of(method), trial_tissues[k].name, results[k].worse_q95});
    }
  }

  [[nodiscard]] Result<Answer> thesis(const Progress& progress) const {
    auto found = redo_thesis_tissue(common_->seed, progress);
    if (!found) return tl::unexpected(found.error());
    if (!out_.empty()) {
      if (auto written = write_file(out_, found->html); !written)
        return tl::unexpected(written.error());
    }
    Answer answer;
    answer.json = std::move(found->json);
    answer.text = std::move(found->text);
    return answer;
  }

  [[nodiscard]] Result<Answer> answer() {
    page_.runs = runs_;
    page_.arm_runs = arm_runs_;
    page_.seed = common_->seed;
    if (!out_.empty()) {
      if (auto written = write_file(out_, to_html(page_)); !written)
        return tl::unexpected(written.error());
    }
    Answer answer;
    answer.text = fmt::format(
        "{} runs each, {} by the arm. Simulated presses only; nothing here was "
        "shown on people.\n{}",
        runs_, arm_runs_, page_.table.rows.empty() ? "" : to_text(page_.table));
    if (!page_.worlds.rows.empty()) answer.text += to_text(page_.worlds);
    answer.text.pop_back();
    answer.json = nlohmann::json{{"runs", runs_},
                                 {"arm_runs", arm_runs_},
                                 {"seed", common_->seed},
                                 {"tissue", table_},
                                 {"worlds", to_json_by_name(page_.worlds)}}
                      .dump(2);
    return answer;
  }

  const CommonOptions* common_ = nullptr;
  int runs_ = 200, arm_runs_ = 24, world_runs_ = 8;
  bool thesis_ = false;
  std::string scenario_, out_;
  Cells cells_;
  nlohmann::json table_ = nlohmann::json::object();
  TissuePage page_{.table = empty_table(), .worlds = empty_world_table(), .curves = {}};
};

}  // namespace

std::unique_ptr<Verb> make_evaluate_tissue() {
  return std::make_unique<EvaluateTissue>();
}

}  // namespace tuina::app
