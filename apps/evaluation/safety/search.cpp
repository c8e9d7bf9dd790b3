// SPDX-License-Identifier: Apache-2.0
#include "apps/evaluation/safety/search.hpp"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>

#include "apps/evaluation/safety/judge.hpp"
#include "tuina/core/parallel.hpp"
#include "tuina/core/units.hpp"

namespace tuina::app {
namespace {

enum Choice : std::uint8_t {
  place,
  stage,
  moment,
  severity,
  tilt,
  alpha,
  beta,
  friction,
  elbow,
  joint,
  belief
};

constexpr std::size_t parents = 4;
constexpr double changed_share = 0.3, change = 0.15;

double between(double share, double low, double high) {
  return low + share * (high - low);
}

template <class List>
const auto& one_of(const List& list, double share) {
  const auto at = static_cast<std::size_t>(share * static_cast<double>(list.size()));
  return list[std::min(at, list.size() - 1)];
}

struct Individual {
  Choices choices = {};
  double force_n = -1.0;
};

/// A child of two parents: of each choice one of theirs, some of them changed.
Choices child_of(const std::vector<Individual>& adults, Random& random) {
  const auto any = [&]() -> const Choices& { return adults[random() % adults.size()].choices; };
  const Choices &mother = any(), &father = any();
  Choices child = {};
  for (std::size_t i = 0; i < child.size(); ++i) {
    child[i] = random() % 2 == 0 ? mother[i] : father[i];
    if (uniform(random, 0.0, 1.0) >= changed_share) continue;
    const bool of_a_list = i == place || i == stage || i == joint || i == belief;
    child[i] = of_a_list ? uniform(random, 0.0, 1.0)
                         : std::clamp(child[i] + gaussian(random, change), 0.0, 1.0);
  }
  return child;
}

Result<WorstTrial> search_class(const FaultClass& fault, const std::vector<Site>& sites,
                                std::size_t trials, Random random) {
  std::vector<Individual> adults;
  for (std::size_t k = 0; k < trials; ++k) {
    Individual next{.choices =
                        adults.size() < parents ? any_choices(random) : child_of(adults, random)};
    const auto outcome = run_trial(trial_of(fault, sites, next.choices));
    if (!outcome) return tl::unexpected(outcome.error());
    if (outcome->tried) next.force_n = outcome->worst_force_n;
    const auto weaker = std::find_if(adults.begin(), adults.end(), [&](const Individual& one) {
      return one.force_n < next.force_n;
    });
    adults.insert(weaker, next);
    if (adults.size() > parents) adults.pop_back();
  }
  WorstTrial worst{.fault = &fault, .plan = trial_of(fault, sites, adults.front().choices)};
  worst.worst_force_n = std::max(0.0, adults.front().force_n);
  const bool touches = worst.plan.stage >= Stage::approach || worst.plan.whole;
  worst.allowed_n = allowed_n(fault.promise, touches ? worst.plan.site->force_n : 0.0);
  return worst;
}

}  // namespace

Choices any_choices(Random& random) {
  Choices choices = {};
  for (double& one : choices) one = uniform(random, 0.0, 1.0);
  return choices;
}

TrialPlan trial_of(const FaultClass& fault, const std::vector<Site>& sites,
                   const Choices& choices) {
  constexpr std::array longest_s = {0.12, 0.6, 0.8, 1.5, 0.3};
  constexpr int beliefs = 16;
  const Stage when = one_of(fault.stages, choices[stage]);
  const double until_s = longest_s[static_cast<std::size_t>(when)];
  return {.site = &one_of(sites, choices[place]),
          .stage = when,
          .into_stage_s = fault.whole ? 0.0 : choices[moment] * until_s,
          .onsets = {{.fault = &fault, .severity = between(choices[severity], 0.3, 1.0)}},
          .whole = fault.whole,
          .watched_s = fault.watched_s,
          // beta is a thickness and varies less.
          .alpha_scale = between(choices[alpha], 0.5, 2.0),
          .beta_scale = between(choices[beta], 0.7, 1.4),
          .friction_scale = between(choices[friction], 0.5, 1.5),
          .tilt_rad = between(choices[tilt], -30_deg, 30_deg),
          .joint = static_cast<int>(std::min(3.0, std::floor(4.0 * choices[joint]))),
          .elbow = between(choices[elbow], -1.0, 1.0),
          .seed = 1 + static_cast<std::uint64_t>(beliefs * choices[belief])};
}

Result<std::vector<WorstTrial>> search_worst(const std::vector<Site>& sites,
                                             const std::string& only, std::size_t trials,
                                             std::uint64_t seed, const Progress& progress) {
  std::vector<const FaultClass*> sought;
  for (const FaultClass& fault : fault_classes())
    if (only.empty() || fault.name == only) sought.push_back(&fault);
  std::vector<WorstTrial> worst(sought.size());
  std::mutex guard;
  std::optional<Error> failure;
  for_each_in_parallel(
      sought.size(),
      [&](std::size_t k) {
        auto found =
            search_class(*sought[k], sites, trials, make_random(seed, "search " + sought[k]->name));
        const std::lock_guard lock(guard);
        if (found) worst[k] = std::move(*found);
        if (!found && !failure) failure = found.error();
      },
      progress);
  if (failure) return tl::unexpected(*failure);
  std::stable_sort(worst.begin(), worst.end(), [](const WorstTrial& a, const WorstTrial& b) {
    return a.worst_force_n - a.allowed_n > b.worst_force_n - b.allowed_n;
  });
  return worst;
}

std::string to_json(const std::vector<WorstTrial>& worst) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const WorstTrial& one : worst) {
    const TrialPlan& plan = one.plan;
    rows.push_back({{"class", one.fault->name},
                    {"place", plan.site->name},
                    {"stage", name_of(plan.stage)},
                    {"into_stage_s", plan.into_stage_s},
                    {"severity", plan.onsets.front().severity},
                    {"tilt_rad", plan.tilt_rad},
                    {"alpha_scale", plan.alpha_scale},
                    {"beta_scale", plan.beta_scale},
                    {"friction_scale", plan.friction_scale},
                    {"joint", plan.joint},
                    {"elbow", plan.elbow},
                    {"seed", plan.seed},
                    {"worst_force_n", one.worst_force_n},
                    {"allowed_n", one.allowed_n}});
  }
  return rows.dump(1);
}

Result<std::vector<WorstTrial>> parse_worst(const std::string& json,
                                            const std::vector<Site>& sites) {
  std::vector<WorstTrial> worst;
  try {
    for (const auto& row : nlohmann::json::parse(json)) {
      const std::string name = row.at("class"), place_name = row.at("place");
      const std::string stage_name = row.at("stage");
      const auto& all = fault_classes();
      const auto fault =
          std::find_if(all.begin(), all.end(), [&](const auto& one) { return one.name == name; });
      const auto site = std::find_if(sites.begin(), sites.end(),
                                     [&](const Site& one) { return one.name == place_name; });
      if (fault == all.end() || site == sites.end())
        return fail(Fault::bad_input, "trial {}: there is no `{}` at `{}`", worst.size() + 1, name,
                    place_name);
      const auto when = std::find_if(fault->stages.begin(), fault->stages.end(),
                                     [&](Stage one) { return name_of(one) == stage_name; });
      if (when == fault->stages.end())
        return fail(Fault::bad_input, "trial {}: `{}` does not come in `{}`", worst.size() + 1,
                    name, stage_name);
      TrialPlan plan = trial_of(*fault, sites, {});
      plan.site = &*site;
      plan.stage = *when;
      plan.into_stage_s = row.at("into_stage_s");
      plan.onsets.front().severity = row.at("severity");
      plan.tilt_rad = row.at("tilt_rad");
      plan.alpha_scale = row.at("alpha_scale");
      plan.beta_scale = row.at("beta_scale");
      plan.friction_scale = row.at("friction_scale");
      plan.joint = row.at("joint");
      plan.elbow = row.at("elbow");
      plan.seed = row.at("seed");
      worst.push_back({&*fault, plan, row.at("worst_force_n"), row.at("allowed_n")});
    }
  } catch (const nlohmann::json::exception& wrong) {
    return fail(Fault::bad_input, "trial {}: {}", worst.size() + 1, wrong.what());
  }
  return worst;
}

}  // namespace tuina::app
