// SPDX-License-Identifier: Apache-2.0
#include "tuina/tissue/classification.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "tuina/tissue/estimator.hpp"

namespace tuina::tissue {
namespace {

// [thesis] Table 6-2, then Table 6-1; beta printed per millimetre.
constexpr std::array<Subject, 8> subjects = {{
    {"medium", false, {{{4.54, 270.0}, {10.76, 220.0}, {4.17, 210.0}}}},
    {"slim", false, {{{5.14, 270.0}, {11.61, 250.0}, {4.42, 240.0}}}},
    {"hefty", false, {{{4.40, 230.0}, {6.00, 220.0}, {4.08, 190.0}}}},
    {"medium", true, {{{4.13, 270.0}, {6.36, 260.0}, {4.10, 250.0}}}},
    {"medium", false, {{{4.80, 270.0}, {12.08, 230.0}, {4.24, 220.0}}}},
    {"slim", false, {{{5.11, 270.0}, {11.30, 250.0}, {4.12, 250.0}}}},
    {"hefty", false, {{{4.31, 250.0}, {6.84, 220.0}, {4.10, 190.0}}}},
    {"medium", false, {{{4.559, 263.2}, {9.786, 185.4}, {4.275, 143.6}}}},
}};

constexpr double label_from = 0.6;  // minimum probability of a named class
// A twentieth of all presses are none of the three classes, spread over three times their range.
constexpr double none_prior = 0.05, none_spread = 9.0;

Eigen::Vector2d logs(const TangentTissue& tissue) {
  return {std::log(tissue.alpha_n), std::log(tissue.beta_per_m)};
}

struct Statistics {
  std::array<Eigen::Vector2d, 3> mean;
  Eigen::Vector2d centre;
  Eigen::Matrix2d within;  // spread of a class over people
  Eigen::Matrix2d total;
};

Statistics statistics_of(std::span<const Subject> table) {
  Statistics s;
  const double n = static_cast<double>(table.size());
  for (Eigen::Vector2d& mean : s.mean) mean.setZero();
  for (const Subject& subject : table) {
    for (std::size_t k = 0; k < 3; ++k) s.mean[k] += logs(subject.tissue[k]) / n;
  }
  s.centre = (s.mean[0] + s.mean[1] + s.mean[2]) / 3.0;
  s.within = s.total = Eigen::Matrix2d::Zero();
  for (const Subject& subject : table) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Eigen::Vector2d off = logs(subject.tissue[k]) - s.mean[k];
      const Eigen::Vector2d wide = logs(subject.tissue[k]) - s.centre;
      s.within += off * off.transpose() / (3.0 * (n - 1.0));
      s.total += wide * wide.transpose() / (3.0 * n - 1.0);
    }
  }
  return s;
}

double density(const Eigen::Vector2d& off, const Eigen::Matrix2d& covariance) {
  return std::exp(-0.5 * off.dot(covariance.inverse() * off)) / std::sqrt(covariance.determinant());
}

}  // namespace

const char* name_of(TissueClass tissue_class) noexcept {
  switch (tissue_class) {
    case TissueClass::bone:
      return "bone";
    case TissueClass::hard:
      return "hard";
    case TissueClass::soft:
      return "soft";
    case TissueClass::unknown:
      return "unknown";
  }
  return "unknown";
}

std::span<const Subject, 7> table_6_2() noexcept {
  return std::span(subjects).first<7>();
}
std::span<const Subject, 8> tables_6_1_and_6_2() noexcept {
  return subjects;
}

Classification classify(const TissueEstimate& estimate, double nis, const ClassProbabilities& prior,
                        std::span<const Subject> table) noexcept {
  const Statistics s = statistics_of(table);
  const Eigen::Vector2d x = logs(estimate.tissue);
  Eigen::Matrix2d blur = Eigen::Matrix2d::Zero();
  blur(0, 0) = std::pow(estimate.alpha_ci95_n / (1.96 * estimate.tissue.alpha_n), 2);
  blur(1, 1) = std::pow(estimate.beta_ci95_per_m / (1.96 * estimate.tissue.beta_per_m), 2);
  const Eigen::Matrix2d spread = s.within + blur;

  Classification result;
  double sum = none_prior * density(x - s.centre, none_spread * s.total + blur);
  for (std::size_t k = 0; k < 3; ++k) {
    result.of[k] = (1.0 - none_prior) * prior[k] * density(x - s.mean[k], spread);
    sum += result.of[k];
  }
  const bool usable = estimate.converged && nis <= max_nis && std::isfinite(sum) && sum > 0.0;
  if (!usable) {
    result.of = prior;
    result.probability = 1.0 - *std::max_element(prior.begin(), prior.end());
    return result;
  }
  double named = 0.0;
  for (double& probability : result.of) named += (probability /= sum);
  const auto best = std::max_element(result.of.begin(), result.of.end());
  if (*best >= label_from) {
    result.label = static_cast<TissueClass>(best - result.of.begin());
    result.probability = *best;
  } else {
    result.probability = 1.0 - *best;
  }
  // The outlier class is removed in proportion, so that the three still sum to one.
  for (double& probability : result.of) probability = named > 0.0 ? probability / named : 1.0 / 3.0;
  return result;
}

}  // namespace tuina::tissue
