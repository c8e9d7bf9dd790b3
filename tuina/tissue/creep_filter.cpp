// SPDX-License-Identifier: Apache-2.0
#include "tuina/tissue/creep_filter.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "tuina/core/units.hpp"
#include "tuina/tissue/breath.hpp"

namespace tuina::tissue {
namespace {

constexpr double tare_sd_n = 0.02;       // drift of the offset since the tare
constexpr double drift_n = 0.02;         // random walk of the offset in a second
constexpr double max_drift_n = 0.3;      // between two segments
constexpr double sensor_floor_n = 0.06;  // hysteresis and crosstalk stay when noise is averaged
constexpr double kept_evidence = 0.6;    // from press to press: people change
constexpr double thinner_share = 0.5;    // of the differences in alpha between places, for beta
constexpr double change_s = 1.5;         // a tensed muscle lets go within seconds
constexpr double max_step = 0.5, min_step = 0.05;  // of logarithms
constexpr double robust_limit = 4.0;               // Huber threshold, in standard deviations
// A segment's part of `model_sd_m`: the wider law leaves less out than the tangent does.
constexpr double model_share = 0.3;
// Tissue that was never pressed: wider than Table 6-2, which fits the tangent law alone.
constexpr double log_alpha_sd = 0.8, log_beta_sd = 0.5;
constexpr double log_creep_sd = 1.2, log_compliance_sd = 1.0;
// A tenth of the depth is taken by what is four times softer, or by much more or less of it.
constexpr double usual_layer_share = 0.1, log_share_sd = 1.5;
constexpr double usual_softness = 4.0, log_softness_sd = 0.5;
constexpr double usual_n_per_m = 60e3;      // beneath: ribs and torso of a person who lies
constexpr double clear_of_skin_m = 0.5_mm;  // there the sensor shows its zero
// A third of the standard deviation is no reason to pass the whole window again.
constexpr double settled_share = 0.3, settled_step = 0.01;

constexpr double never_s = -std::numeric_limits<double>::infinity();
// Of logarithms, from place to place of one person; and how much of the evidence counts there.
constexpr double place_sd = 0.3, kept_between_places = 0.2;
constexpr double alpha_place_sd = 0.45;  // of bone, hard and soft muscle of one person, Table 6-2
constexpr double unknown_inertia = 0.3;  // error share of the compensated tool inertia

constexpr double square(double x) {
  return x * x;
}

}  // namespace

CreepFilter::CreepFilter(const PressEstimatorOptions& options,
                         const CreepHypothesis& hypothesis) noexcept
    : options_(options),
      hypothesis_(hypothesis),
      wander_m_(options.skin_wander_m * hypothesis.breathing_m /
                std::max(1e-6, options.breathing_m)),
      step_limit_(max_step) {
  const bool told = options.torso_n_per_m > 0.0 && std::isfinite(options.torso_n_per_m);
  const bool elastic = !(hypothesis.creep > 0.0);
  // What does not exist keeps a logarithm that stands for nothing and is sure of it.
  constexpr double nothing = -20.0, sure = 1e-6;
  State sd;
  State& mean = prior_.mean;
  mean(log_alpha) = std::log(options.expected.alpha_n);
  sd(log_alpha) = log_alpha_sd;
  mean(log_beta) = std::log(options.expected.beta_per_m);
  sd(log_beta) = log_beta_sd;
  for (int i = log_creep; i < log_share; ++i) {
    mean(i) = elastic ? nothing : std::log(hypothesis.creep);
    sd(i) = elastic ? sure : log_creep_sd;
  }
  mean(log_share) = elastic ? nothing : std::log(usual_layer_share);
  sd(log_share) = elastic ? sure : log_share_sd;
  mean(log_softness) = std::log(usual_softness);
  sd(log_softness) = elastic ? sure : log_softness_sd;
  mean(log_compliance) = told      ? -std::log(options.torso_n_per_m)
                         : elastic ? nothing
                                   : -std::log(usual_n_per_m);
  sd(log_compliance) = told ? options.torso_sd : elastic ? sure : log_compliance_sd;
  sd(first_press) = hypothesis.first_press_sd;
  sd(damping) = options.damping_sd_s_per_m;
  sd(change) = hypothesis.changing_sd;
  sd(offset) = options.untared_sd_n;
  sd(skin) = options.contact_sd_m;
  sd(breath) = hypothesis.breathing_m / std::sqrt(8.0);
  sd(breath_speed) = sd(breath) * 2.0 * pi * options.breathing_hz;
  prior_.covariance.diagonal() = sd.array().square();
  prior_.time_s = never_s;
  pass_ = middle_ = now_ = prior_;
  at_ = prior_.mean;
}

void CreepFilter::expect_person(const Belief& elsewhere) noexcept {
  // alpha and beta, relaxation, layers and what lies beneath. From place to place they are an
  // autoregressive process around people in general, so that what one place has pulled aside comes
  // back, and nobody is known less well than somebody unknown.
  constexpr int first = log_alpha, count = log_softness + 1 - first;
  using Kept = Eigen::Array<double, count, 1>;
  const Kept unknown = prior_.covariance.diagonal().segment<count>(first).array();
  Kept sd = Kept::Constant(place_sd);
  sd(log_alpha - first) = alpha_place_sd;
  sd(log_beta - first) = thinner_share * alpha_place_sd;
  const Kept differs = unknown.min(sd.square());
  const Kept kept = (unknown > differs).select((1.0 - differs / unknown).sqrt(), 0.0);
  auto mean = prior_.mean.segment<count>(first);
  mean.array() += kept * (elsewhere.mean.segment<count>(first) - mean).array();
  auto known = prior_.covariance.block<count, count>(first, first);
  known = kept.matrix().asDiagonal() * elsewhere.covariance.block<count, count>(first, first) *
          kept.matrix().asDiagonal();
  known.diagonal().array() += differs;
  prior_.log_evidence = kept_between_places * elsewhere.log_evidence;
  pass_ = middle_ = now_ = prior_;
  at_ = prior_.mean;
}

CreepLaw CreepFilter::law_at(const State& state) noexcept {
  CreepLaw law{.tissue = {std::exp(state(log_alpha)), std::exp(state(log_beta))},
               .compliance_m_per_n = std::exp(state(log_compliance)),
               .damping_s_per_m = state(damping)};
  law.layer_share = std::exp(state(log_share));
  law.layer_softness = std::exp(state(log_softness));
  for (std::size_t i = 0; i < memory_s.size(); ++i)
    law.creep[i] = std::exp(state(log_creep + static_cast<int>(i)));
  return law;
}

void CreepFilter::predict(Belief& belief, double time_s) const noexcept {
  const double dt_s = time_s - std::exchange(belief.time_s, time_s);
  if (!(dt_s > 0.0) || !std::isfinite(dt_s)) return;
  Covariance& P = belief.covariance;
  // Bounded, so that an hour of hovering does not inflate what is known.
  P(skin, skin) += std::min(square(wander_m_) * dt_s, square(options_.contact_sd_m));
  P(offset, offset) += std::min(square(drift_n) * dt_s, square(max_drift_n));
  const double kept = std::exp(-dt_s / change_s);
  belief.mean(change) *= kept;
  P.row(change) *= kept;
  P.col(change) *= kept;
  P(change, change) += square(hypothesis_.changing_sd) * (1.0 - kept * kept);
  move_breath(belief.mean, P,
              {hypothesis_.breathing_m, options_.breathing_hz,
               options_.breath_damping / hypothesis_.steadiness},
              dt_s);
}

CreepFilter::Expected CreepFilter::expect(const Belief& belief, const State& at, bool first,
                                          const Loading& loading) noexcept {
  CreepLaw law = law_at(at);
  law.tissue.alpha_n *= std::exp(belief.mean(change) + (first ? at(first_press) : 0.0));
  const CreepDepth depth = depth_of(law, loading);
  Expected out;
  State& H = out.H;
  H(log_alpha) = H(change) = depth.by_log_alpha;
  H(first_press) = first ? depth.by_log_alpha : 0.0;
  H(log_beta) = depth.by_log_beta;
  for (std::size_t i = 0; i < memory_s.size(); ++i)
    H(log_creep + static_cast<int>(i)) = depth.by_log_creep[i];
  H(log_share) = depth.by_log_share;
  H(log_softness) = depth.by_log_softness;
  H(log_compliance) = depth.by_log_compliance;
  H(damping) = depth.by_damping;
  H(offset) = -depth.m_per_n;
  H(skin) = H(breath) = 1.0;
  State linearised = belief.mean;
  linearised.head<nonlinear>() -= at.head<nonlinear>();
  linearised(change) = 0.0;
  out.position_m = depth.depth_m + H.dot(linearised);
  out.variance_m2 = H.dot(belief.covariance.lazyProduct(H));
  out.m_per_n = depth.m_per_n;
  return out;
}

void CreepFilter::fuse(Belief& belief, const PressSegment& segment) const noexcept {
  predict(belief, segment.time_s);
  if (segment.press != belief.press) {
    belief.covariance(skin, skin) += square(hypothesis_.landing_sd_m);
    belief.covariance(log_alpha, log_alpha) += square(hypothesis_.landing_sd);
    belief.covariance(log_beta, log_beta) += square(thinner_share * hypothesis_.landing_sd);
    belief.log_evidence *= kept_evidence;
  }
  belief.press = segment.press;
  const double force_variance = square(options_.force_noise_n) / segment.samples;
  if (!segment.contact) {
    // Clearly above the skin the sensor shows its zero.
    const double sd_m =
        std::sqrt(belief.covariance(skin, skin) + belief.covariance(breath, breath));
    const double height_m = belief.mean(skin) + belief.mean(breath) - segment.position_m;
    if (height_m >= clear_of_skin_m + 3.0 * sd_m) {
      State H = State::Zero();
      H(offset) = 1.0;
      fuse(belief, H, segment.force_n - belief.mean(offset), force_variance + square(tare_sd_n));
      return;
    }
    // Whoever presses for the first time, with more than noise and sensor show in the air, touches
    // the skin already: a soft layer gives way there by a large part of its depth. Later presses
    // begin where the one before has left a dent.
    const double felt_n = segment.force_n - belief.mean(offset);
    const double shown_n = 4.0 * std::sqrt(force_variance + square(sensor_floor_n) +
                                           square(unknown_inertia * segment.inertia_n));
    const bool first_loading = segment.press == 0 && segment.speed_m_per_s > 0.0;
    if (!first_loading || !(felt_n > shown_n)) return;
  }
  const double v = segment.speed_m_per_s;
  const Expected at =
      expect(belief, at_, segment.press == 0, {segment.force_n, segment.memory_n, v});
  // Errors in both variables: force noise enters as equivalent depth noise.
  const double jolt_m = unknown_inertia * segment.inertia_n * at.m_per_n;
  const double R = square(options_.position_noise_m) / segment.samples +
                   square(at.m_per_n) * (force_variance + square(sensor_floor_n)) +
                   square(model_share * options_.model_sd_m) + square(options_.timing_sd_s * v) +
                   square(jolt_m);
  fuse(belief, at.H, segment.position_m - at.position_m, R);
}

void CreepFilter::fuse(Belief& belief, const State& H, double innovation, double R) const noexcept {
  const State PH = belief.covariance.lazyProduct(H);
  const double HPH = H.dot(PH);
  const double far = std::abs(innovation) / std::sqrt(HPH + R);
  if (far > robust_limit) R *= far / robust_limit;
  const double S = HPH + R;
  belief.nis_sum += innovation * innovation / S;
  belief.nis_count += 1.0;
  belief.log_evidence -= 0.5 * (innovation * innovation / S + std::log(S));
  belief.mean += PH * (innovation / S);
  belief.covariance.noalias() -= (PH / S) * PH.transpose();
}

void CreepFilter::begin_pass(double sd_n) noexcept {
  // Only the first contact's prior knows the tare; later ones have it from the segments.
  if (prior_.time_s == never_s && sd_n < options_.untared_sd_n)
    prior_.covariance(offset, offset) = square(sd_n) + square(tare_sd_n);
  pass_ = prior_;
}

void CreepFilter::finish_pass() noexcept {
  State step = pass_.mean - at_;
  auto parameters = step.head<nonlinear>();
  // A step opposite to the last one has overshot: Gauss-Newton may oscillate for ever.
  const bool back = parameters.dot(last_step_.head<nonlinear>()) < 0.0;
  step_limit_ =
      back ? std::max(min_step, 0.5 * step_limit_) : std::min(max_step, 1.5 * step_limit_);
  // The damping is no logarithm: 10 s/m of it change the force as much as 0.5 of a logarithm.
  State scaled = step;
  scaled(damping) *= 0.05;
  const double longest = scaled.head<nonlinear>().cwiseAbs().maxCoeff();
  if (longest > step_limit_) step *= step_limit_ / longest;
  last_step_ = step;
  at_ += step;
  at_(log_alpha) = std::clamp(at_(log_alpha), std::log(0.05), std::log(500.0));
  at_(log_beta) = std::clamp(at_(log_beta), std::log(5.0), std::log(5000.0));
  for (int i = log_creep; i <= log_compliance; ++i) at_(i) = std::clamp(at_(i), -25.0, 2.0);
  now_ = pass_;
}

bool CreepFilter::moved() const noexcept {
  for (int i = 0; i < nonlinear; ++i) {
    const double sd = std::sqrt(now_.covariance(i, i));
    const double scale = i == damping ? 20.0 : 1.0;
    if (std::abs(now_.mean(i) - at_(i)) > settled_share * sd + settled_step * scale) return true;
  }
  return false;
}

}  // namespace tuina::tissue
