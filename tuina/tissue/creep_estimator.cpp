// SPDX-License-Identifier: Apache-2.0
#include "tuina/tissue/creep_estimator.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tuina/tissue/creep_law.hpp"

namespace tuina::tissue {
namespace {

// Window size in segments at which its older half is marginalised: some seven presses.
constexpr std::size_t marginalise_at = 384;
// The tangent of the first loading costs as much as ten segments.
constexpr double publish_every_s = 0.03;
// Segments that a tick passes: a pass over three presses then needs a tenth of a second.
constexpr std::size_t turns_per_tick = 2;
// Below some 200 samples a second nearly each one is a segment, and a pass has to hurry, or the
// window is full before it ends.
constexpr std::size_t crowded_at = 448, turns_in_a_hurry = 16;
constexpr double z95 = 1.96;
// Neighbouring segments share what the law leaves out, so evidence counts less than its sum.
constexpr double evidence_share = 0.6;
// Of how far alpha and beta differ between the upper and the lower half of a press: no tangent is
// the whole of such tissue. Chosen on phantoms of the usual world.
constexpr double bend_share = 0.2;
// How well the presses of one place were foretold says half as much of those of another one.
constexpr double kept_judgement = 0.5;

/// Tissue that only springs back, and tissue that remembers, each with breath and passing changes
/// of several sizes, around what the caller expects of the breath. Tuned in the worlds of
/// docs/tissue.md with other seeds than those that judge.
std::array<CreepHypothesis, CreepEstimator::filters> hypotheses(double breathing_m) noexcept {
  constexpr double usual_creep = 0.08;     // of each decade: relaxes by a fifth in all
  constexpr double first_press_sd = 0.15;  // [palevski2006]: a third less after it
  const double still_m = 0.02 * breathing_m, little_m = 0.2 * breathing_m, much_m = breathing_m;
  const auto with = [](double creep, double breath_m, double changing_sd) {
    return CreepHypothesis{.creep = creep,
                           .breathing_m = breath_m,
                           .first_press_sd = first_press_sd,
                           .changing_sd = changing_sd};
  };
  CreepHypothesis slips = with(usual_creep, still_m, 0.004);
  slips.landing_sd_m = 0.5e-3;  // a tool of 17 mm on a bent back
  slips.landing_sd = 0.1;
  CreepHypothesis springs = with(0.0, much_m, 0.02), steady = with(usual_creep, much_m, 0.02);
  springs.steadiness = steady.steadiness = 5.0;
  return {with(0.0, still_m, 0.004),
          springs,
          steady,
          with(usual_creep, still_m, 0.004),
          slips,
          with(usual_creep, still_m, 0.3),
          with(usual_creep, little_m, 0.02),
          with(usual_creep, little_m, 0.3),
          with(usual_creep, much_m, 0.02),
          with(usual_creep, much_m, 0.15)};
}

/// Neither 0 nor infinity, which mean that all softness is the tissue's.
bool knows_torso(const PressEstimatorOptions& options) noexcept {
  return options.torso_n_per_m > 0.0 && std::isfinite(options.torso_n_per_m);
}

/// By how much less a filter is believed that takes layers for a torso softer than any person's.
double too_soft(double log_compliance, const PressEstimatorOptions& options) noexcept {
  constexpr double edge = 0.1;  // of a logarithm: beyond 95 of 100 people
  if (!knows_torso(options) || !(options.torso_sd > 0.0)) return 0.0;
  const double softest = -std::log(options.torso_n_per_m) + z95 * options.torso_sd;
  const double beyond = std::max(0.0, log_compliance - softest) / edge;
  return std::isfinite(softest) ? 0.5 * beyond * beyond : 0.0;
}

}  // namespace

CreepEstimator::CreepEstimator(const Options& options) noexcept
    : options_(options), segments_(SegmentOptions{}) {
  reset();
}

void CreepEstimator::reset() noexcept {
  const auto assumed = hypotheses(options_.breathing_m);
  for (std::size_t i = 0; i < filters; ++i) unpressed_[i] = CreepFilter(options_, assumed[i]);
  kept_surprise_ = kept_judged_ = 0.0;
  next_place();
}

void CreepEstimator::keep_person() noexcept {
  if (seen_presses_ == 0) return;
  const auto assumed = hypotheses(options_.breathing_m);
  for (std::size_t i = 0; i < filters; ++i) {
    unpressed_[i] = CreepFilter(options_, assumed[i]);
    unpressed_[i].expect_person(filters_[i].now());
  }
  kept_surprise_ = kept_judgement * surprise_;
  kept_judged_ = kept_judgement * judged_;
}

void CreepEstimator::next_place() noexcept {
  filters_ = unpressed_;
  segments_ = PressSegments({.force_noise_n = options_.force_noise_n,
                             .contact_sd_m = options_.contact_sd_m,
                             .force_delay_s = options_.force_delay_s,
                             .tool_mass_kg = options_.tool_mass_kg,
                             .max_segments = PressSegments::capacity});
  weigh();
  followed_ = next_ = 0;
  passing_ = middle_kept_ = pressing_ = as_told_ = false;
  seen_presses_ = 0;
  press_ = -1;
  surprise_ = kept_surprise_;
  judged_ = kept_judged_;
  strongest_ = rests_before_ = PressSegment{};
  nis_ = 1.0;
  estimate_ = TissueEstimate{};
  publish();
  published_s_ = -std::numeric_limits<double>::infinity();
}

void CreepEstimator::update(double time_s, const Press& sample) noexcept {
  segments_.add(time_s, sample);
  if (followed_ < segments_.closed()) follow();
  if (segments_.presses() > seen_presses_) judge_press();
  if (passing_) pass(segments_.size() < crowded_at ? turns_per_tick : turns_in_a_hurry);
}

void CreepEstimator::settle() noexcept {
  segments_.close();
  follow();
  constexpr int max_passes = 40;
  for (int i = 0; i < max_passes && passing_; ++i) pass(segments_.size());
}

void CreepEstimator::follow() noexcept {
  if (followed_ == 0) {
    for (CreepFilter& filter : filters_) {
      filter.begin_pass(segments_.tare_sd_n());
      filter.finish_pass();
    }
  }
  for (; followed_ < segments_.closed(); ++followed_) {
    for (CreepFilter& filter : filters_) filter.follow(segments_[followed_]);
    watch_press(segments_[followed_]);
  }
  weigh();
  if (segments_.now_s() - published_s_ >= publish_every_s) publish();
  if (!passing_) begin_pass();
}

void CreepEstimator::begin_pass() noexcept {
  bool moved = segments_.size() >= marginalise_at;
  for (std::size_t i = 0; i < filters; ++i)
    moved = moved || (weights_[i] > 0.01 && filters_[i].moved());
  if (!moved) return;
  for (CreepFilter& filter : filters_) filter.begin_pass(segments_.tare_sd_n());
  next_ = 0;
  passing_ = true;
  middle_kept_ = false;
}

void CreepEstimator::pass(std::size_t turns) noexcept {
  for (; turns > 0 && next_ < followed_; --turns) {
    for (CreepFilter& filter : filters_) filter.pass(segments_[next_]);
    if (++next_ == marginalise_at / 2) {
      for (CreepFilter& filter : filters_) filter.keep_middle();
      middle_kept_ = true;
    }
  }
  if (next_ == followed_) finish_pass();
}

void CreepEstimator::finish_pass() noexcept {
  passing_ = false;
  for (CreepFilter& filter : filters_) filter.finish_pass();
  for (const CreepFilter& filter : filters_) {
    const CreepFilter::Belief& now = filter.now();
    if (!now.mean.allFinite() || !(now.covariance.diagonal().minCoeff() >= 0.0)) return reset();
  }
  if (segments_.size() >= marginalise_at && middle_kept_) {
    for (CreepFilter& filter : filters_) filter.forget_before_middle();
    segments_.drop_oldest(marginalise_at / 2);
    followed_ -= marginalise_at / 2;
  }
  weigh();
  publish();
  decide_convergence();
  begin_pass();
}

void CreepEstimator::weigh() noexcept {
  std::array<double, filters> believed;
  for (std::size_t i = 0; i < filters; ++i) {
    const CreepFilter::Belief& now = filters_[i].now();
    believed[i] = evidence_share * now.log_evidence -
                  too_soft(now.mean(CreepFilter::log_compliance), options_);
  }
  leader_ = static_cast<std::size_t>(std::max_element(believed.begin(), believed.end()) -
                                     believed.begin());
  double sum = 0.0;
  for (std::size_t i = 0; i < filters; ++i)
    sum += weights_[i] = std::exp(believed[i] - believed[leader_]);
  for (double& weight : weights_) weight /= sum;
}

TangentTissue CreepEstimator::loading_of(const CreepFilter::State& state,
                                         double force_share) const noexcept {
  CreepLaw law = CreepFilter::law_at(state);
  // What the caller says of the torso is no tissue; a softness that only shows is.
  if (knows_torso(options_)) law.compliance_m_per_n = 0.0;
  return first_loading(law, force_share * std::max(2.0, segments_.peak_force_n()));
}

void CreepEstimator::publish() noexcept {
  published_s_ = segments_.now_s();
  const CreepFilter::Belief& now = filters_[leader_].now();
  nis_ = now.nis_count > 8.0 ? std::max(1.0, now.nis_sum / now.nis_count) : 1.0;
  estimate_.tissue = loading_of(now.mean);
  Eigen::Matrix<double, 2, CreepFilter::nonlinear> J;
  for (int i = 0; i < CreepFilter::nonlinear; ++i) {
    const double step = i == CreepFilter::damping ? 0.1 : 0.01;
    CreepFilter::State aside = now.mean;
    aside(i) += step;
    const TangentTissue other = loading_of(aside);
    J(0, i) = std::log(other.alpha_n / estimate_.tissue.alpha_n) / step;
    J(1, i) = std::log(other.beta_per_m / estimate_.tissue.beta_per_m) / step;
  }
  loading_covariance_ =
      nis_ * J * now.covariance.topLeftCorner<CreepFilter::nonlinear, CreepFilter::nonlinear>() *
      J.transpose();
  // What the other filters say instead is as possible as they are.
  for (std::size_t i = 0; i < filters; ++i) {
    if (i == leader_ || weights_[i] < 0.01) continue;
    const TangentTissue other = loading_of(filters_[i].now().mean);
    const Eigen::Vector2d apart(std::log(other.alpha_n / estimate_.tissue.alpha_n),
                                std::log(other.beta_per_m / estimate_.tissue.beta_per_m));
    loading_covariance_ += weights_[i] * apart * apart.transpose();
  }
  // Where presses come otherwise than foretold the law is not the tissue's, and its parameters are
  // no better known than the force.
  loading_covariance_ *= widening() * widening();
  // Depths that fit no tangent end at a limit where alpha no longer moves. That is no knowledge.
  constexpr double no_press_tells = 1e-4, unknown = 1.0;
  if (!(loading_covariance_(0, 0) > no_press_tells * no_press_tells))
    loading_covariance_ = unknown * unknown * Eigen::Matrix2d::Identity();
  comparable_covariance_ = loading_covariance_;
  const TangentTissue lower = loading_of(now.mean, 0.5);
  const Eigen::Vector2d bend(std::log(lower.alpha_n / estimate_.tissue.alpha_n),
                             std::log(lower.beta_per_m / estimate_.tissue.beta_per_m));
  loading_covariance_ += bend_share * bend_share * bend * bend.transpose();
  estimate_.alpha_ci95_n = estimate_.tissue.alpha_n * z95 * std::sqrt(loading_covariance_(0, 0));
  estimate_.beta_ci95_per_m =
      estimate_.tissue.beta_per_m * z95 * std::sqrt(loading_covariance_(1, 1));
  estimate_.contact_m = now.mean(CreepFilter::skin) + now.mean(CreepFilter::breath);
  estimate_.presses = segments_.presses();
  // What is no longer known is withdrawn with the law that is no longer the same.
  if (estimate_.converged) decide_convergence();
}

double CreepEstimator::stiffness_sd(double force_n) const noexcept {
  // ln k = ln beta + ln(alpha^2 + F^2) - ln alpha, so d ln k / d ln alpha = (1 - q^2) / (1 + q^2).
  const double q = std::max(0.0, force_n) / estimate_.tissue.alpha_n;
  const Eigen::Vector2d gradient((1.0 - q * q) / (1.0 + q * q), 1.0);
  return std::sqrt(gradient.dot(loading_covariance_ * gradient));
}

}  // namespace tuina::tissue
