// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "apps/evaluation/safety/process_trials.hpp"
#include "apps/evaluation/verbs.hpp"

namespace tuina::app {
namespace {

using nlohmann::ordered_json;

constexpr std::array both_victims = {Victim::controller, Victim::guard};
constexpr std::array all_blows = {Blow::kill, Blow::stop, Blow::crash};

/// Sessions in three processes, of which one is really killed while a tool presses.
class EvaluateProcesses final : public Verb {
 public:
  [[nodiscard]] const char* name() const override { return "evaluate processes"; }
  [[nodiscard]] const char* summary() const override {
    return "kill, stop and crash the controller and the guard of sessions while they press";
  }
  [[nodiscard]] const char* example() const override {
    return "tuina evaluate processes --trials 20";
  }
  void describe(Options& options) override {
    options.add("--trials", trials_, "of each kind").between(1, 1000).show_default();
    options.add("--pace", pace_, "real, or max: each process waits for the others")
        .one_of({"max", "real"})
        .show_default();
  }
  [[nodiscard]] Result<Answer> run(const CommonOptions& common) override {
    ordered_json rows = ordered_json::array();
    std::string text = fmt::format("{:<12}{:<20}{:>7}{:>7}{:>12}{:>16}{:>16}\n", "process", "blow",
                                   "trials", "held", "worst, N", "first act, ms", "left, N");
    int held = 0, done = 0;
    double worst_n = 0.0;
    const int kinds = static_cast<int>(both_victims.size() * all_blows.size());
    const Progress bar = progress_bar(common, "processes");
    for (const Victim victim : both_victims) {
      for (const Blow blow : all_blows) {
        int held_here = 0;
        double worst_here_n = 0.0, act_ms = 0.0, left_n = 0.0;
        for (int i = 0; i < trials_; ++i) {
          const auto outcome =
              run_process_trial({.victim = victim,
                                 .blow = blow,
                                 .seed = common.seed + static_cast<std::uint64_t>(i),
                                 .real_pace = pace_ == "real"});
          if (!outcome) return tl::unexpected(outcome.error());
          held_here += outcome->held ? 1 : 0;
          worst_here_n = std::max(worst_here_n, outcome->max_force_n);
          act_ms = std::max(act_ms, outcome->first_action_ms);
          left_n = std::max(left_n, outcome->left_n);
          rows.push_back({{"process", name_of(victim)},
                          {"blow", name_of(blow)},
                          {"seed", outcome->trial.seed},
                          {"force_before_n", outcome->before_n},
                          {"max_force_n", outcome->max_force_n},
                          {"first_action_ms", outcome->first_action_ms < 0.0
                                                  ? ordered_json()
                                                  : ordered_json(outcome->first_action_ms)},
                          {"released_ms", outcome->released_ms},
                          {"left_n", outcome->left_n},
                          {"held", outcome->held}});
          if (bar) bar(static_cast<double>(++done) / (kinds * trials_));
        }
        held += held_here;
        worst_n = std::max(worst_n, worst_here_n);
        text += fmt::format("{:<12}{:<20}{:>7}{:>7}{:>12.1f}{:>16.0f}{:>16.1f}\n", name_of(victim),
                            name_of(blow), trials_, held_here, worst_here_n, act_ms, left_n);
      }
    }
    text.pop_back();
    const int all = kinds * trials_;
    const ordered_json found = {
        {"trials", all}, {"held", held}, {"worst_force_n", worst_n}, {"rows", rows}};
    return Answer{.json = ordered_json{{"processes", found}}.dump(2),
                  .text = text,
                  .exit_code = held == all ? 0 : 4};
  }

 private:
  int trials_ = 3;
  std::string pace_ = "max";
};

}  // namespace

std::unique_ptr<Verb> make_evaluate_processes() {
  return std::make_unique<EvaluateProcesses>();
}

}  // namespace tuina::app
