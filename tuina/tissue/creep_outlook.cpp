// SPDX-License-Identifier: Apache-2.0
// What a creep estimator says of forces to come, and how it judges itself by those that came.
#include <algorithm>
#include <cmath>

#include "tuina/tissue/creep_estimator.hpp"

namespace tuina::tissue {
namespace {

constexpr double z95 = 1.96;
constexpr double floor_m = 0.004e-3;  // of a position whose noise is smoothed away
// A sum over presses is trusted as if this many had come as expected before.
constexpr double expected_presses = 1.0;
// Squared standard deviations of one press that count in that sum: a sigh in a press is no reason
// to know the tissue less well in the next ones.
constexpr double max_surprise = 3.0;
constexpr double kept_per_press = 0.95;  // a person is the same for about twenty presses
constexpr double converged_surprise = 2.0;
// Of the force of a press, what the law leaves out. It was found on phantoms of the usual world:
// the filters alone hold 85 of 100 presses in their bands of 95 %.
constexpr double unexplained_share = 0.035;
// Laws that agree on what was felt part beyond its strongest press: an exponential lies below a
// tangent by half of the squared logarithm of how much stronger a press is, as the logarithm of
// its force.
constexpr double parting = 0.65;
// The softest of layers give way by less before a contact shows.
constexpr double touched_after_m = 5e-3;
constexpr double max_force_n = 300.0;  // beyond any press; near its pole the law says anything

constexpr double square(double x) {
  return x * x;
}

using Bands = std::array<CreepEstimator::ForceBand, CreepEstimator::filters>;

/// The force below which a share of what the filters expect lies, each with a normal distribution
/// of two halves: a band is wider towards the pole of the law.
double quantile(const Bands& told, const std::array<double, CreepEstimator::filters>& weights,
                double share) noexcept {
  double low_n = told[0].low_n, high_n = told[0].high_n;
  for (const auto& band : told) {
    low_n = std::min(low_n, 2.0 * band.low_n - band.force_n);
    high_n = std::max(high_n, 2.0 * band.high_n - band.force_n);
  }
  constexpr int halvings = 30;
  for (int k = 0; k < halvings; ++k) {
    const double force_n = 0.5 * (low_n + high_n);
    double below = 0.0;
    for (std::size_t i = 0; i < told.size(); ++i) {
      const auto& band = told[i];
      const double apart_n = force_n - band.force_n;
      const double half_n = apart_n > 0.0 ? band.high_n - band.force_n : band.force_n - band.low_n;
      below +=
          weights[i] * 0.5 * std::erfc(-z95 * std::sqrt(0.5) * apart_n / std::max(half_n, 1e-6));
    }
    (below < share ? low_n : high_n) = force_n;
  }
  return 0.5 * (low_n + high_n);
}

}  // namespace

CreepEstimator::Outlook CreepEstimator::outlook() const noexcept {
  Outlook outlook{.beliefs = {}, .weights = weights_, .memory_n = {}, .time_s = segments_.now_s()};
  for (std::size_t i = 0; i < filters; ++i) outlook.beliefs[i] = filters_[i].now();
  outlook.memory_n.fill(segments_.memory_n());
  return outlook;
}

double CreepEstimator::widening() const noexcept {
  // Student's distribution: so few presses do not know their own spread.
  const double freedom = expected_presses + judged_;
  return (1.0 + 1.2 / freedom) * std::sqrt((expected_presses + surprise_) / freedom);
}

CreepEstimator::ForceBand CreepEstimator::foretell(Outlook& outlook, double time_s,
                                                   double position_m,
                                                   double speed_m_per_s) const noexcept {
  const double dt_s = std::max(0.0, time_s - outlook.time_s);
  outlook.time_s = time_s;
  Bands told;
  for (std::size_t i = 0; i < filters; ++i) {
    CreepFilter::Belief& belief = outlook.beliefs[i];
    filters_[i].predict(belief, time_s);
    CreepLaw law = CreepFilter::law_at(belief.mean);
    law.tissue.alpha_n *= std::exp(belief.mean(CreepFilter::change));
    Memory& memory_n = outlook.memory_n[i];
    const double depth_m =
        position_m - belief.mean(CreepFilter::skin) - belief.mean(CreepFilter::breath);
    const auto force_at = [&](double deeper_m) {
      return force_of(law, depth_m + deeper_m, memory_n, speed_m_per_s, max_force_n);
    };
    ForceBand& band = told[i];
    band.force_n = force_at(0.0);
    const CreepFilter::Expected expected =
        CreepFilter::expect(belief, belief.mean, false, {band.force_n, memory_n, speed_m_per_s});
    const double reach_m = z95 * widening() * std::sqrt(expected.variance_m2 + square(floor_m));
    band.low_n = force_at(-reach_m);
    band.high_n = force_at(reach_m);
    for (std::size_t k = 0; k < memory_s.size(); ++k)
      memory_n[k] = band.force_n + std::exp(-dt_s / memory_s[k]) * (memory_n[k] - band.force_n);
    const double zero_n = segments_.tare_n() + belief.mean(CreepFilter::offset);
    band.force_n += zero_n;
    band.low_n += zero_n;
    band.high_n += zero_n;
  }
  ForceBand band{.force_n = quantile(told, outlook.weights, 0.5),
                 .low_n = quantile(told, outlook.weights, 0.025),
                 .high_n = quantile(told, outlook.weights, 0.975)};
  const double noise_n = z95 * options_.force_noise_n;
  const double felt_n = std::max(strongest_.force_n, peak_.force_n);
  const double beyond = felt_n > 0.0 ? std::log(std::max(1.0, band.force_n / felt_n)) : 0.0;
  const double part = parting * square(beyond);
  band.low_n = band.force_n - std::hypot(band.force_n - band.low_n, noise_n,
                                         band.force_n * (1.0 - std::exp(-part)));
  band.high_n = band.force_n + std::hypot(band.high_n - band.force_n, noise_n,
                                          band.force_n * (std::exp(part) - 1.0));
  return band;
}

void CreepEstimator::watch_press(const PressSegment& segment) noexcept {
  if (!segment.contact || segment.force_n < options_.onset_n) return;
  if (segment.press != press_) {
    press_ = segment.press;
    onset_ = outlook();
    rests_ = peak_ = segment;
    pressing_ = true;
  }
  // A tool may rest on the skin before it presses.
  constexpr double rests_below = 1.5;
  if (peak_.force_n < rests_below * options_.onset_n) rests_ = segment;
  // What is held is no longer met: the peak is where the press first has all of its force.
  constexpr double stronger = 1.03;
  if (segment.force_n > stronger * peak_.force_n) peak_ = segment;
}

void CreepEstimator::judge_press() noexcept {
  estimate_.presses = seen_presses_ = segments_.presses();
  if (!pressing_) return;
  pressing_ = false;
  press_over_s_ = segments_.now_s();
  if (peak_.force_n > strongest_.force_n) {
    strongest_ = peak_;
    rests_before_ = rests_;
  }
  if (seen_presses_ < 2) return;  // before the first one nothing was known
  const Loading peak{peak_.force_n, peak_.memory_n, peak_.speed_m_per_s};
  double error_m = 0.0, square_m2 = square(floor_m);
  for (std::size_t i = 0; i < filters; ++i) {
    CreepFilter::Belief& belief = onset_.beliefs[i];
    filters_[i].predict(belief, peak_.time_s);
    const CreepFilter::Expected told = CreepFilter::expect(belief, belief.mean, false, peak);
    const double apart_m = peak_.position_m - told.position_m;
    error_m += onset_.weights[i] * apart_m;
    square_m2 += onset_.weights[i] * (square(apart_m) + told.variance_m2);
  }
  const double surprise = square(error_m) / (square_m2 - square(error_m));
  as_told_ = surprise <= square(converged_surprise * std::max(1.0, widening()));
  surprise_ = kept_per_press * surprise_ + std::min(surprise, max_surprise);
  judged_ = kept_per_press * judged_ + 1.0;
  decide_convergence();
}

bool CreepEstimator::zero_known() const noexcept {
  // Free air between two presses shows it as well.
  constexpr double max_sd_n = 0.3, max_found_sd_n = 0.1;
  if (std::min(segments_.tare_sd_n(), options_.untared_sd_n) <= max_sd_n) return true;
  const double variance =
      filters_[leader_].now().covariance(CreepFilter::offset, CreepFilter::offset);
  return variance <= square(max_found_sd_n);
}

bool CreepEstimator::skin_as_told() const noexcept {
  constexpr double max_sd = 5.0;
  return std::abs(segments_.first_contact_m()) <= max_sd * options_.contact_sd_m + touched_after_m;
}

void CreepEstimator::decide_convergence() noexcept {
  const bool was = estimate_.converged;
  const bool as_assumed = !too_slow() && zero_known() && skin_as_told();
  estimate_.converged = as_told_ && as_assumed && nis_ <= max_nis &&
                        force_half_width(strongest_.force_n) <= well_foretold_share;
  if (!estimate_.converged)
    estimate_.converged_after_s = -1.0;
  else if (!was)
    estimate_.converged_after_s = segments_.now_s() - segments_.first_contact_s();
}

CreepEstimator::NextPress CreepEstimator::next_press(double force_n) const noexcept {
  if (!(strongest_.force_n > 0.0) || !(force_n > options_.onset_n)) return {};
  // A second after the last press, or now if it is later, as fast as the strongest one: to what the
  // tissue remembers then comes what that press has added.
  constexpr double pause_s = 1.0;
  const double rests_s = std::max(0.0, pause_s - (segments_.now_s() - press_over_s_));
  const double share = force_n / strongest_.force_n;
  const double rise_s = strongest_.time_s - rests_before_.time_s;
  Loading light{.force_n = options_.onset_n, .memory_n = segments_.memory_n()};
  Loading next{.force_n = force_n, .speed_m_per_s = strongest_.speed_m_per_s};
  for (std::size_t k = 0; k < memory_s.size(); ++k) {
    const double kept = std::exp(-rise_s / memory_s[k]);
    const double added_n = strongest_.memory_n[k] - kept * rests_before_.memory_n[k];
    double& before_n = light.memory_n[k];
    before_n = light.force_n + std::exp(-rests_s / memory_s[k]) * (before_n - light.force_n);
    next.memory_n[k] = kept * before_n + share * added_n;
  }
  PressSegment onset{.time_s = segments_.now_s() + rests_s,
                     .force_n = light.force_n,
                     .samples = 20.0,
                     .memory_n = light.memory_n,
                     .press = seen_presses_};
  double mean_m = 0.0, square_m2 = square(floor_m), m_per_n = 0.0;
  for (std::size_t i = 0; i < filters; ++i) {
    CreepFilter::Belief belief = filters_[i].now();
    filters_[i].predict(belief, onset.time_s);
    const CreepFilter::Expected from = CreepFilter::expect(belief, filters_[i].at(), false, light);
    if (!options_.follows_skin) {
      onset.position_m = from.position_m;
      filters_[i].fuse(belief, onset);
      filters_[i].predict(belief, onset.time_s + rise_s);
    }
    const CreepFilter::Expected told = CreepFilter::expect(belief, filters_[i].at(), false, next);
    const CreepFilter::State deeper = told.H - from.H;
    const double deep_m = told.position_m - from.position_m;
    const double variance_m2 = options_.follows_skin
                                   ? deeper.dot(belief.covariance.lazyProduct(deeper))
                                   : told.variance_m2;
    mean_m += weights_[i] * deep_m;
    square_m2 += weights_[i] * (square(deep_m) + variance_m2);
    m_per_n += weights_[i] * told.m_per_n;
  }
  const double sd = std::sqrt(square_m2 - square(mean_m)) / (m_per_n * force_n);
  // Nine tenths of what a press that follows the skin comes otherwise than foretold is breath,
  // which is no error of its force: there, how well presses came says nothing.
  return {.deeper_m = mean_m,
          .half_width =
              z95 * (options_.follows_skin ? std::hypot(sd, unexplained_share) : widening() * sd)};
}

}  // namespace tuina::tissue
