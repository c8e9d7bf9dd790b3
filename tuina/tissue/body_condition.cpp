// SPDX-License-Identifier: Apache-2.0
#include "tuina/tissue/body_condition.hpp"

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <string_view>

namespace tuina::tissue {
namespace {

constexpr std::array<std::string_view, 3> builds = {"slim", "medium", "hefty"};
constexpr std::array<double, 3> index_of = {19.5, 23.0, 29.0}, index_sd = {1.5, 2.0, 3.0};
// Per cent: means of the men of Table 6-2, and the excess of its one woman of medium build.
constexpr std::array<double, 3> fat_of_men = {11.0, 17.15, 23.7};
constexpr double more_in_women = 6.75, fat_sd = 3.0;
// With two or three people per build the spread is not known, so it is at least this share of the
// whole table's.
constexpr double min_spread_share = 0.6;
// Standard deviation of ln alpha and ln beta between places of one name: Table 6-1 against the men
// of medium build in Table 6-2, RMS over the three tissues.
constexpr double place_alpha_sd = 0.1, place_beta_sd = 0.25;
// The tangent of layered tissue depends on the force at which it is taken, by 0.46 and 0.28 from
// half of a press to all of it, and on whether the place was pressed before [palevski2006]. Table
// 6-2 tells neither.
constexpr double method_alpha_sd = 0.3, method_beta_sd = 0.16;
// How the three tissues of one person differ alike from others of their build: mean correlation of
// what Table 6-2 leaves around the builds.
constexpr double alike = 0.5;

double log_density(double value, double mean, double sd) {
  const double off = (value - mean) / sd;
  return -0.5 * off * off - std::log(sd);
}

Eigen::Vector2d logs(const TangentTissue& tissue) {
  return {std::log(tissue.alpha_n), std::log(tissue.beta_per_m)};
}

/// Log-likelihood of the presses on people of this group, up to a common constant: of Student's t,
/// since the spread is known from a few people only. Each tissue tells what the others have not.
template <typename InGroup>
double log_likelihood(std::span<const KnownPress> presses, std::span<const Subject> table,
                      const InGroup& in_group) {
  double sum = 0.0, tissues = 0.0;
  const double freedom =
      std::max(1.0, static_cast<double>(table.size()) - static_cast<double>(builds.size()));
  for (std::size_t k = 0; k < 3; ++k) {
    Eigen::Vector2d all = Eigen::Vector2d::Zero(), group = all, square = all, felt = all;
    double people = 0.0, count = 0.0;
    for (const Subject& subject : table) {
      all += logs(subject.tissue[k]) / static_cast<double>(table.size());
      if (!in_group(subject)) continue;
      group += logs(subject.tissue[k]);
      people += 1.0;
    }
    for (const Subject& subject : table)
      square += (logs(subject.tissue[k]) - all).cwiseAbs2() / static_cast<double>(table.size());
    for (const KnownPress& press : presses) {
      if (press.at != static_cast<TissueClass>(k)) continue;
      felt += logs(press.tissue);
      count += 1.0;
    }
    if (people == 0.0 || count == 0.0) continue;
    // All presses of one person at one tissue are one observation.
    const Eigen::Vector2d off = felt / count - group / people;
    const Eigen::Vector2d place(std::hypot(place_alpha_sd, method_alpha_sd),
                                std::hypot(place_beta_sd, method_beta_sd));
    const Eigen::Vector2d variance =
        square * (min_spread_share * min_spread_share * (1.0 + 1.0 / people)) + place.cwiseAbs2();
    const double distance2 = off.cwiseAbs2().cwiseQuotient(variance).sum();
    sum -= 0.5 * ((freedom + 2.0) * std::log1p(distance2 / freedom) + std::log(variance.prod()));
    tissues += 1.0;
  }
  return tissues > 0.0 ? sum / (1.0 + (tissues - 1.0) * alike) : 0.0;
}

}  // namespace

BodyCondition find_body_condition(std::span<const KnownPress> presses, const BodyFacts& facts,
                                  std::span<const Subject> table) {
  std::array<double, 3> weight = {};
  double sum = 0.0;
  for (std::size_t b = 0; b < builds.size(); ++b) {
    double log_weight = log_likelihood(
        presses, table, [&](const Subject& subject) { return subject.build == builds[b]; });
    if (facts.mass_index) log_weight += log_density(*facts.mass_index, index_of[b], index_sd[b]);
    if (facts.fat_percent) {
      const double man = log_density(*facts.fat_percent, fat_of_men[b], fat_sd);
      const double woman = log_density(*facts.fat_percent, fat_of_men[b] + more_in_women, fat_sd);
      log_weight += std::log(std::exp(man) + std::exp(woman));
    }
    sum += weight[b] = std::exp(log_weight);
  }
  BodyCondition condition;
  if (std::isfinite(sum) && sum > 0.0) {
    condition.slim = weight[0] / sum;
    condition.medium = weight[1] / sum;
    condition.hefty = weight[2] / sum;
  }
  const double woman =
      log_likelihood(presses, table, [](const Subject& subject) { return subject.female; });
  const double man =
      log_likelihood(presses, table, [](const Subject& subject) { return !subject.female; });
  if (std::isfinite(woman) && std::isfinite(man))
    condition.female = 1.0 / (1.0 + std::exp(man - woman));
  return condition;
}

}  // namespace tuina::tissue
