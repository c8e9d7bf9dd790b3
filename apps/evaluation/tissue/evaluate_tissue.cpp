// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <nlohmann/json.hpp>
#include <thread>

#include "apps/cli/table.hpp"
#include "apps/evaluation/cells.hpp"
#include "apps/evaluation/thesis/tissue.hpp"
#include "apps/evaluation/tissue/outcome_fields.hpp"
#include "apps/evaluation/tissue/page.hpp"
#include "apps/evaluation/tissue/trial_table.hpp"
#include "apps/evaluation/tissue/trials.hpp"
#include "apps/evaluation/tissue/world_trials.hpp"
#include "apps/evaluation/verbs.hpp"
#include "tuina/core/io/file.hpp"

namespace tuina::app {
namespace {

/// Every estimator on many simulated people, sensors and disturbances (docs/tissue_measured.md).
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
    choose();
    // An experiment with the arm takes about ten times as long as one drawn from a formula.
    const double all = 3.0 * (static_cast<double>(scenarios_.size()) * runs_ +
                              10.0 * static_cast<double>(loops_.size()) * arm_runs_ +
                              3.0 * static_cast<double>(worlds_.size()) * world_runs_);
    double done = 0.0;
    const Part part = [&](double weight, double share) {
      if (progress) progress(std::min(1.0, (done + weight * share) / all));
      if (share >= 1.0) done += weight;
    };
    for (const auto judge : {&EvaluateTissue::judge_scenarios, &EvaluateTissue::judge_loops,
                             &EvaluateTissue::judge_worlds}) {
      if (auto judged = (this->*judge)(part); !judged) return tl::unexpected(judged.error());
    }
    return cells_.answer([&] { return answer(); });
  }

 private:
  /// Tells that a share of something of this weight is done.
  using Part = std::function<void(double weight, double share)>;

  void choose() {
    const auto wanted = [&](const auto& all, bool any, auto& chosen) {
      for (const auto& one : all) {
        if (any && (scenario_.empty() || one.name == scenario_)) chosen.push_back(one);
      }
    };
    wanted(sim::press_scenarios(), true, scenarios_);
    wanted(loop_scenarios(), arm_runs_ > 0, loops_);
    wanted(sim::tissue_worlds(), world_runs_ > 0, worlds_);
    seed_ = common_->seed * 1000003ULL;
  }

  /// One cell for each tissue; `weight` is that of one.
  template <typename Scenario, typename Trials>
  [[nodiscard]] Result<void> judge_tissues(const Scenario& scenario, double weight,
                                           const Part& part, const Trials& trials) {
    std::array<TrialResults, 3> results;
    for (std::size_t k = 0; k < 3; ++k) {
      const TrialTissue& tissue = trial_tissues[k];
      auto found = cells_.at<TrialResults>(fmt::format("{} {}", scenario.name, tissue.name), [&] {
        return trials(tissue, [&](double share) { part(weight, std::min(share, 0.999)); });
      });
      if (!found) return tl::unexpected(found.error());
      results[k] = std::move(*found);
      part(weight, 1.0);
    }
    take(scenario.name, scenario.about, results);
    return {};
  }

  [[nodiscard]] Result<void> judge_scenarios(const Part& part) {
    for (const sim::PressScenario& scenario : scenarios_) {
      const auto trials = [&](const TrialTissue& tissue,
                              const Progress& told) -> Result<TrialResults> {
        TrialResults results = run_trials(scenario, tissue, runs_, seed_, threads_, told);
        // Tissue of another law has no true alpha: there only the claim to know it can be judged.
        if (scenario.law != sim::PressScenario::TissueModel::tangent) {
          for (TrialResult& r : results) r.false_converged_share = r.converged_share;
        }
        return results;
      };
      if (auto judged = judge_tissues(scenario, runs_, part, trials); !judged) return judged;
    }
    return {};
  }

  [[nodiscard]] Result<void> judge_loops(const Part& part) {
    for (const LoopScenario& scenario : loops_) {
      const auto trials = [&](const TrialTissue& tissue, const Progress& told) {
        return run_loop_trials(scenario, tissue, arm_runs_, seed_, threads_, told);
      };
      auto judged = judge_tissues(scenario, 10.0 * arm_runs_, part, trials);
      if (!judged) return judged;
    }
    return {};
  }

  [[nodiscard]] Result<void> judge_worlds(const Part& part) {
    const double weight = 9.0 * world_runs_;
    for (const sim::TissueWorld& world : worlds_) {
      const auto result = cells_.at<WorldResult>(world.name, [&]() -> Result<WorldResult> {
        return run_world(world, world_runs_, seed_, threads_,
                         [&](double share) { part(weight, std::min(share, 0.999)); });
      });
      if (!result) return tl::unexpected(result.error());
      page_.worlds.rows.push_back(row_of(world, *result));
      part(weight, 1.0);
    }
    return {};
  }

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
                                  .group = fmt::format("{}: {}", name, about),
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
  std::vector<sim::PressScenario> scenarios_;
  std::vector<LoopScenario> loops_;
  std::vector<sim::TissueWorld> worlds_;
  std::uint64_t seed_ = 1;
  const unsigned threads_ = std::clamp(std::thread::hardware_concurrency(), 1U, 8U);
  Cells cells_;
  nlohmann::json table_ = nlohmann::json::object();
  TissuePage page_{.table = empty_table(), .worlds = empty_world_table(), .curves = {}};
};

}  // namespace

std::unique_ptr<Verb> make_evaluate_tissue() {
  return std::make_unique<EvaluateTissue>();
}

}  // namespace tuina::app
