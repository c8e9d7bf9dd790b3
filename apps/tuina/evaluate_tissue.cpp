// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <cmath>
#include <nlohmann/json.hpp>
#include <thread>

#include "apps/tuina/tissue_trials.hpp"
#include "apps/tuina/verbs.hpp"

namespace tuina::app {
namespace {

/// JSON has no infinity: never is null.
nlohmann::json number(double value) {
  return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json();
}

nlohmann::json to_json(const TrialResult& r, TrialMethod method) {
  nlohmann::json json = {{"runs", r.runs},
                         {"t95_s", number(r.t95_s)},
                         {"q95_first_press", number(r.first_press_q95)},
                         {"q95_last", number(r.last_q95)},
                         {"alpha_bias", number(r.alpha_bias)},
                         {"detectable_change", number(r.detectable_change)}};
  const bool interval = method == TrialMethod::tuina || method == TrialMethod::batch;
  json["coverage"] =
      interval ? number(std::min(r.coverage_alpha, r.coverage_beta)) : nlohmann::json();
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
  for (const TrialResult& r : results) {
    worst.t95_s = larger(worst.t95_s, r.t95_s);
    worst.first_press_q95 = larger(worst.first_press_q95, r.first_press_q95);
    worst.last_q95 = larger(worst.last_q95, r.last_q95);
    if (std::abs(r.alpha_bias) > std::abs(worst.alpha_bias)) worst.alpha_bias = r.alpha_bias;
    worst.detectable_change = larger(worst.detectable_change, r.detectable_change);
    worst.coverage_alpha = std::min(worst.coverage_alpha, r.coverage_alpha);
    worst.coverage_beta = std::min(worst.coverage_beta, r.coverage_beta);
    worst.converged_share = std::min(worst.converged_share, r.converged_share);
    worst.converged_median_s = larger(worst.converged_median_s, r.converged_median_s);
    worst.false_converged_share = larger(worst.false_converged_share, r.false_converged_share);
  }
  return worst;
}

std::string cell(double value, double scale, const char* none) {
  if (std::isnan(value)) return "-";
  return std::isfinite(value) ? fmt::format("{:.{}f}", scale * value, scale == 1.0 ? 2 : 1) : none;
}

std::string row_of(const std::string& scenario, TrialMethod method,
                   const std::array<TrialResult, 3>& r) {
  const auto three = [&](auto member, double scale, const char* none) {
    return fmt::format("{}/{}/{}", cell(r[0].*member, scale, none), cell(r[1].*member, scale, none),
                       cell(r[2].*member, scale, none));
  };
  const TrialResult worst = worst_of(r);
  std::string row = fmt::format("{:<14} {:<12} {:<18} {:<18} {:<18}", scenario, name_of(method),
                                three(&TrialResult::t95_s, 1.0, "never"),
                                three(&TrialResult::first_press_q95, 100.0, "-"),
                                three(&TrialResult::last_q95, 100.0, "-"));
  if (method == TrialMethod::tuina || method == TrialMethod::batch) {
    row += fmt::format(" {:.2f}/{:.2f}", worst.coverage_alpha, worst.coverage_beta);
  }
  if (method == TrialMethod::tuina) {
    row += fmt::format("   {:<18} {:.1f}", three(&TrialResult::converged_median_s, 1.0, "never"),
                       100.0 * worst.false_converged_share);
  }
  return row + "\n";
}

/// Every estimator on many simulated people, sensors and disturbances (docs/tissue.md).
class EvaluateTissue final : public Verb {
 public:
  [[nodiscard]] const char* name() const override { return "evaluate tissue"; }
  [[nodiscard]] const char* summary() const override {
    return "estimators of tissue on simulated presses, scenario by scenario";
  }
  [[nodiscard]] const char* example() const override {
    return "tuina evaluate tissue --runs 50 --scenario N0";
  }
  void describe(CLI::App& command) override {
    command.add_option("--runs", runs_, "per scenario, tissue and method")
        ->check(CLI::Range(1, 100000))
        ->capture_default_str();
    std::vector<std::string> names;
    for (const auto& scenario : sim::press_scenarios()) names.push_back(scenario.name);
    command.add_option("--scenario", scenario_, "one only")->check(CLI::IsMember(names));
  }

  [[nodiscard]] Result<Answer> run(const CommonOptions& common) override {
    const Progress progress = progress_bar(common, "tissue");
    const unsigned threads = std::clamp(std::thread::hardware_concurrency(), 1U, 8U);
    std::vector<sim::PressScenario> scenarios;
    for (const auto& scenario : sim::press_scenarios()) {
      if (scenario_.empty() || scenario.name == scenario_) scenarios.push_back(scenario);
    }
    nlohmann::json table;
    Answer answer;
    answer.text = fmt::format(
        "{} runs each; bone/hard/soft. t95: from when 95 % of the runs stay within 5 %; errors: 95 "
        "% quantile of the\n"
        "worse one of alpha and beta. Simulated presses only; nothing here was shown on people.\n"
        "{:<14} {:<12} {:<18} {:<18} {:<18} {:<11} {:<18} {}\n",
        runs_, "scenario", "method", "t95 s", "one press %", "at the end %", "coverage",
        "converged s", "falsely %");
    const double all =
        static_cast<double>(scenarios.size() * trial_methods.size() * trial_tissues.size());
    double done = 0.0;
    for (const auto& scenario : scenarios) {
      const bool lawful = scenario.law == sim::PressScenario::Law::tangent;
      for (const TrialMethod method : trial_methods) {
        std::array<TrialResult, 3> results;
        for (std::size_t k = 0; k < trial_tissues.size(); ++k) {
          // A batch fit takes a thousand times as long; a fifth of the runs shows as much.
          const int runs = method == TrialMethod::batch ? std::max(1, runs_ / 5) : runs_;
          results[k] = run_trials(scenario, trial_tissues[k], method, runs,
                                  common.seed * 1000003ULL, threads);
          // Tissue of another law has no true alpha: there only the claim to know it can be judged.
          if (!lawful) results[k].false_converged_share = results[k].converged_share;
          if (progress) progress(++done / all);
        }
        nlohmann::json entry = to_json(worst_of(results), method);
        for (std::size_t k = 0; k < trial_tissues.size(); ++k) {
          entry["by_tissue"][trial_tissues[k].name] = to_json(results[k], method);
        }
        table[scenario.name][name_of(method)] = entry;
        answer.text += row_of(scenario.name, method, results);
      }
    }
    answer.text.pop_back();
    answer.json = nlohmann::json{{"runs", runs_}, {"seed", common.seed}, {"tissue", table}}.dump(2);
    return answer;
  }

 private:
  int runs_ = 200;
  std::string scenario_;
};

}  // namespace

std::unique_ptr<Verb> make_evaluate_tissue() {
  return std::make_unique<EvaluateTissue>();
}

}  // namespace tuina::app
