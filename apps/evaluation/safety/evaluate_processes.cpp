// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "apps/evaluation/safety/process_trials.hpp"
#include "apps/evaluation/verbs.hpp"

namespace tuina::app {
namespace {

using nlohmann::ordered_json;

/// Sessions in three processes, of which one is really killed while a tool presses.
class EvaluateProcesses final : public Verb {
 public:
  [[nodiscard]] const char* name() const override { return "evaluate processes"; }
  [[nodiscard]] const char* summary() const override {
    return "kill, starve and hold up controller and guard of sessions while they press";
  }
  [[nodiscard]] const char* example() const override {
    return "tuina evaluate processes --trials 20";
  }
  void describe(Options& options) override {
    options.add("--trials", trials_, "of each kind").between(1, 1000).show_default();
    std::set<std::string> names;
    for (const ProcessBlow& one : process_blows()) names.insert(name_of(one.blow));
    options.add("--blow", blows_, "only these; a disk that is full takes a whole session")
        .one_of({names.begin(), names.end()});
    options.add("--pace", pace_, "real, or max: each process waits for the others")
        .one_of({"max", "real"})
        .show_default();
  }
  [[nodiscard]] Result<Answer> run(const CommonOptions& common) override {
    ordered_json rows = ordered_json::array();
    std::string text = fmt::format("{:<12}{:<20}{:>7}{:>7}{:>12}{:>16}{:>16}\n", "process", "blow",
                                   "trials", "held", "worst, N", "first act, ms", "left, N");
    int held = 0, tried = 0, done = 0;
    double worst_n = 0.0;
    const auto kinds = static_cast<int>(
        std::count_if(process_blows().begin(), process_blows().end(),
                      [this](const ProcessBlow& one) { return is_wanted(one.blow); }));
    const Progress bar = progress_bar(common, "processes");
    for (const auto& [victim, blow] : process_blows()) {
      if (!is_wanted(blow)) continue;
      int held_here = 0, tried_here = 0;
      double worst_here_n = 0.0, act_ms = 0.0, left_n = 0.0;
      for (int i = 0; i < trials_; ++i) {
        const auto outcome = run_process_trial({.victim = victim,
                                                .blow = blow,
                                                .seed = common.seed + static_cast<std::uint64_t>(i),
                                                .real_pace = pace_ == "real"});
        if (bar) bar(static_cast<double>(++done) / (kinds * trials_));
        if (!outcome) {
          // A session may end before anybody is pressed: nothing is said of a blow then.
          if (i + 1 == trials_ && tried_here == 0) return tl::unexpected(outcome.error());
          rows.push_back({{"process", name_of(victim)},
                          {"blow", name_of(blow)},
                          {"seed", common.seed + static_cast<std::uint64_t>(i)},
                          {"not_tried", outcome.error().message}});
          continue;
        }
        ++tried_here;
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
      }
      held += held_here;
      tried += tried_here;
      worst_n = std::max(worst_n, worst_here_n);
      text += fmt::format("{:<12}{:<20}{:>7}{:>7}{:>12.1f}{:>16.0f}{:>16.1f}\n", name_of(victim),
                          name_of(blow), tried_here, held_here, worst_here_n, act_ms, left_n);
    }
    text.pop_back();
    const ordered_json found = {
        {"trials", tried}, {"held", held}, {"worst_force_n", worst_n}, {"rows", rows}};
    return Answer{.json = ordered_json{{"processes", found}}.dump(2),
                  .text = text,
                  .exit_code = held == tried ? 0 : 4};
  }

 private:
  [[nodiscard]] bool is_wanted(Blow blow) const {
    return blows_.empty() || std::find(blows_.begin(), blows_.end(), name_of(blow)) != blows_.end();
  }

  int trials_ = 3;
  std::vector<std::string> blows_;
  std::string pace_ = "max";
};

}  // namespace

std::unique_ptr<Verb> make_evaluate_processes() {
  return std::make_unique<EvaluateProcesses>();
}

}  // namespace tuina::app
