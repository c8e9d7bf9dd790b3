// SPDX-License-Identifier: Apache-2.0
#include "tuina/tissue/press_estimator.hpp"

#include <algorithm>
#include <cmath>

#include "tuina/core/units.hpp"
#include "tuina/tissue/breath.hpp"
#include "tuina/tissue/tangent_model.hpp"

namespace tuina::tissue {
namespace {

// Window size in segments at which its older half is marginalised.
constexpr std::size_t marginalise_at = 96;
constexpr std::size_t max_window = 120;
// Early in the first press answers are wanted fast, so passes are short.
constexpr std::size_t short_pass = 48;
constexpr int passes_at_rest = 4;        // Gauss-Newton steps after the last new sample
constexpr double forgetting_sd = 0.005;  // added to that of the logarithms per marginalisation
// An interval that just fits would be wrong for one estimate in twenty, so 98 % is required.
constexpr double sureness = 2.33 / 1.96;
constexpr double max_step = 0.5, min_step = 0.02, settled_step = 0.05;  // of logarithms
constexpr double tare_sd_n = 0.02;       // drift of the offset since the tare
constexpr double unknown_inertia = 0.3;  // error share of the compensated tool inertia
constexpr double robust_limit = 4.0;     // Huber threshold, in standard deviations
constexpr double stretch_sd_m = 0.1e-3;  // spread of positions within one stretch before contact
constexpr double light_touch = 0.5;      // largest beta x at which a force counts as small
constexpr double corner_reach = 5.0;     // standard deviations beyond which the skin is a corner
constexpr std::size_t skin_known_after = 4;  // segments of contact

SegmentOptions segment_options(const PressEstimatorOptions& options) noexcept {
  return {.force_noise_n = options.force_noise_n,
          .contact_sd_m = options.contact_sd_m,
          .force_delay_s = options.force_delay_s,
          .tool_mass_kg = options.tool_mass_kg};
}

}  // namespace

PressEstimatorOptions pressed_by_robot(double torso_n_per_m, double tool_mass_kg) noexcept {
  return {.force_noise_n = 0.05,
          .position_noise_m = 0.01e-3,
          .contact_sd_m = 3e-3,
          .force_delay_s = 2.6e-3,  // one sample and the low-pass of the wrist sensor
          .timing_sd_s = 0.3e-3,
          .tool_mass_kg = tool_mass_kg,
          .torso_n_per_m = torso_n_per_m,
          .breathing_m = 3e-3,
          .breath_damping = 0.07,
          .skin_wander_m = 0.02e-3,
          .follows_skin = true,
          .onset_n = 3.0,  // kept on the skin between two presses
          .model_sd_m = 0.01e-3,
          .converged_alpha = 0.08,
          .converged_beta = 0.05};
}

PressEstimator::PressEstimator(const PressEstimatorOptions& options) noexcept
    : options_(options), segments_(segment_options(options)) {
  reset();
}

void PressEstimator::reset() noexcept {
  const auto square = [](double x) { return x * x; };
  segments_ = PressSegments(segment_options(options_));
  const bool rigid = !(options_.torso_n_per_m > 0.0) || !std::isfinite(options_.torso_n_per_m);
  const double torso_m_per_n = rigid ? 0.0 : 1.0 / options_.torso_n_per_m;
  // A sinusoid of peak-to-peak A has the variance A^2 / 8.
  const double breath_variance = square(options_.breathing_m) / 8.0;
  prior_.mean << std::log(options_.expected.alpha_n), std::log(options_.expected.beta_per_m), 0.0,
      torso_m_per_n, 0.0, 0.0, 0.0, 0.0;
  prior_.covariance.setZero();
  prior_.covariance.diagonal() << square(options_.expected_alpha_sd),
      square(options_.expected_beta_sd), square(options_.damping_sd_s_per_m),
      square(options_.torso_sd * torso_m_per_n), square(options_.untared_sd_n),
      square(options_.contact_sd_m), breath_variance,
      breath_variance * square(2.0 * pi * options_.breathing_hz);
  prior_.time_s = -1e9;
  pass_ = middle_ = prior_;
  state_ = prior_.mean;
  covariance_ = prior_.covariance;
  next_ = pass_size_ = 0;
  idle_passes_ = passes_at_rest;
  seen_blocks_ = 0;
  nis_ = 1.0;
  step_limit_ = max_step;
  last_step_.setZero();
  settled_ = false;
  estimate_ = TissueEstimate{};
  publish();
}

void PressEstimator::update(double time_s, const Press& sample) noexcept {
  segments_.add(time_s, sample);
  const int turns = segments_.size() < short_pass ? 2 : 1;
  for (int i = 0; i < turns; ++i) {
    if (next_ >= pass_size_) {
      if (pass_size_ > 0) finish_pass();
      if (seen_blocks_ != segments_.accepted_blocks()) idle_passes_ = 0;
      if (segments_.size() == 0 || idle_passes_ >= passes_at_rest) return;
      begin_pass();
    }
    update_from(segments_[next_]);
    record_skin(next_++);
    if (next_ == marginalise_at / 2) middle_ = pass_;
  }
}

void PressEstimator::begin_pass() noexcept {
  if (idle_passes_ == 0 && seen_blocks_ == 0 && segments_.tare_sd_n() < options_.untared_sd_n) {
    prior_.covariance(offset, offset) =
        segments_.tare_sd_n() * segments_.tare_sd_n() + tare_sd_n * tare_sd_n;
  }
  pass_ = prior_;
  next_ = 0;
  pass_size_ = segments_.size();
  seen_blocks_ = segments_.accepted_blocks();
  sum_nis_ = count_ = 0.0;
  alpha_ = std::exp(state_(log_alpha));
  beta_ = std::exp(state_(log_beta));
}

void PressEstimator::predict(double time_s) noexcept {
  const double dt_s = time_s - pass_.time_s;
  pass_.time_s = time_s;
  if (!(dt_s > 0.0)) return;
  Covariance& P = pass_.covariance;
  // Bounded, so that an hour of hovering does not inflate the skin variance.
  const double skin_limit_m2 = options_.contact_sd_m * options_.contact_sd_m;
  P(skin, skin) += std::min(options_.skin_wander_m * options_.skin_wander_m * dt_s, skin_limit_m2);

  move_breath(pass_.mean, P, {options_.breathing_m, options_.breathing_hz, options_.breath_damping},
              dt_s);
}

void PressEstimator::update_from(const PressSegment& segment) noexcept {
  predict(segment.time_s);
  if (!segment.contact) {
    update_from_air(segment);
    return;
  }
  const double alpha = alpha_, beta = beta_;
  const double v = segment.speed_m_per_s;
  const double m = std::max(0.3, 1.0 + state_(mu) * v);
  const double q = segment.force_n / (m * alpha);
  const double a = std::atan(q);
  const double slope = q / ((1.0 + q * q) * beta);  // -dx/dln(alpha)
  const double depth_per_n = pass_.mean(compliance) + slope / segment.force_n;

  State H;
  H << -slope, -a / beta, -slope * v / m, segment.force_n, -depth_per_n, 1.0, 1.0, 0.0;
  // Errors in both variables: force noise enters as equivalent depth noise.
  const double sx = options_.position_noise_m, sf = options_.force_noise_n * depth_per_n;
  const double late_m = options_.timing_sd_s * v;
  const double jolt_m = unknown_inertia * segment.inertia_n * depth_per_n;
  const double R = (sx * sx + sf * sf) / segment.samples +
                   options_.model_sd_m * options_.model_sd_m + late_m * late_m + jolt_m * jolt_m;

  State linearised = pass_.mean;
  linearised.head<3>() -= state_.head<3>();
  const double innovation = segment.position_m - a / beta - H.dot(linearised);
  fuse(H, innovation, R);
}

void PressEstimator::update_from_air(const PressSegment& air) noexcept {
  // Before contact the force is too small to be turned into a depth, so it is predicted from the
  // depth: zero above the skin, the law below. Linearised at the skin position of the last pass;
  // its uncertainty and the length of the stretch smooth the corner (statistical linearisation).
  if (std::isnan(air.skin_m)) return;
  const double sx = options_.position_noise_m, told_variance = air.skin_sd_m * air.skin_sd_m;
  const double sd_m = std::sqrt(told_variance + stretch_sd_m * stretch_sd_m +
                                sx * sx / air.samples + options_.model_sd_m * options_.model_sd_m);
  const double squeezed_m = pass_.mean(compliance) * std::max(0.0, air.force_n);
  const double depth_m = air.position_m - air.skin_m - squeezed_m;
  if (beta_ * depth_m > light_touch) return;
  const double z = depth_m / sd_m;
  const bool near_corner = std::abs(z) < corner_reach;
  const double within =
      near_corner ? 0.5 * std::erfc(-z * std::sqrt(0.5)) : static_cast<double>(z > 0.0);
  const double edge = near_corner ? std::exp(-0.5 * z * z) / std::sqrt(2.0 * pi) : 0.0;
  const double in_m = std::max(0.0, depth_m * within + sd_m * edge);
  const double in_variance =
      (depth_m * depth_m + sd_m * sd_m) * within + depth_m * sd_m * edge - in_m * in_m;

  const double v = air.speed_m_per_s, m = std::max(0.3, 1.0 + state_(mu) * v);
  const double still_n = alpha_ * std::tan(std::min(beta_ * in_m, 2.0 * light_touch));
  const double n_per_m = m * beta_ * (alpha_ + still_n * still_n / alpha_);
  const double felt = n_per_m * within;
  State H;
  H << m * still_n, n_per_m * in_m, v * still_n, -felt * std::max(0.0, air.force_n), 1.0, -felt,
      -felt, 0.0;
  const double jolt_n = unknown_inertia * air.inertia_n;
  const double R = options_.force_noise_n * options_.force_noise_n / air.samples + jolt_n * jolt_n +
                   std::max(0.0, n_per_m * n_per_m * in_variance - felt * felt * told_variance);
  State linearised = pass_.mean;
  linearised.head<3>() -= state_.head<3>();
  linearised(compliance) = 0.0;
  linearised(skin) -= air.skin_m;
  fuse(H, air.force_n - m * still_n - H.dot(linearised), R);
}

void PressEstimator::record_skin(std::size_t i) noexcept {
  if (i < skin_known_after || segments_[i - skin_known_after].contact) return;
  for (std::size_t k = i + 1 - skin_known_after; k <= i; ++k) {
    if (!segments_[k].contact) return;
  }
  const Covariance& P = pass_.covariance;
  const double variance = P(skin, skin) + 2.0 * P(skin, breath) + P(breath, breath);
  const double breath_speed_m_per_s =
      2.0 * pi * options_.breathing_hz * options_.breathing_m / std::sqrt(8.0);
  for (std::size_t k = i - skin_known_after + 1; k-- > 0 && !segments_[k].contact;) {
    const double moved_m = (segments_[i].time_s - segments_[k].time_s) * breath_speed_m_per_s;
    segments_.record_skin(k, pass_.mean(skin) + pass_.mean(breath),
                          std::sqrt(std::max(0.0, variance) + moved_m * moved_m));
  }
}

void PressEstimator::fuse(const State& H, double innovation, double R) noexcept {
  const State PH = pass_.covariance.lazyProduct(H);  // small: inlined, not a library call
  const double HPH = H.dot(PH);
  const double far = std::abs(innovation) / std::sqrt(HPH + R);
  if (far > robust_limit) R *= far / robust_limit;
  const double S = HPH + R;
  sum_nis_ += innovation * innovation / S;
  count_ += 1.0;
  pass_.mean += PH * (innovation / S);
  pass_.covariance.noalias() -= (PH / S) * PH.transpose();
}

void PressEstimator::finish_pass() noexcept {
  pass_size_ = next_ = 0;
  ++idle_passes_;
  if (!pass_.mean.allFinite() || !pass_.covariance.allFinite() ||
      !(pass_.covariance.diagonal().minCoeff() >= 0.0)) {
    reset();
    return;
  }
  State step = pass_.mean - state_;
  // A step opposite to the last one has overshot: while the tissue is only touched, Gauss-Newton
  // may oscillate about the answer for ever.
  if (step.head<2>().dot(last_step_) < 0.0)
    step_limit_ = std::max(min_step, 0.5 * step_limit_);
  else
    step_limit_ = std::min(max_step, 1.5 * step_limit_);
  const double longest = step.head<2>().cwiseAbs().maxCoeff();
  settled_ = longest < settled_step;
  if (longest > step_limit_) step *= step_limit_ / longest;
  last_step_ = step.head<2>();
  state_ += step;
  state_(log_alpha) = std::clamp(state_(log_alpha), std::log(0.1), std::log(200.0));
  state_(log_beta) = std::clamp(state_(log_beta), std::log(10.0), std::log(5000.0));
  covariance_ = pass_.covariance;
  nis_ = count_ > 8.0 ? std::max(1.0, sum_nis_ / count_) : 1.0;

  // Marginalised segments are never linearised again, so marginalisation waits for a settled answer
  // while the window has room.
  if (segments_.size() >= marginalise_at && (settled_ || segments_.size() >= max_window)) {
    prior_ = middle_;
    prior_.covariance *= nis_;
    prior_.covariance(log_alpha, log_alpha) += forgetting_sd * forgetting_sd;
    prior_.covariance(log_beta, log_beta) += forgetting_sd * forgetting_sd;
    segments_.drop_oldest(marginalise_at / 2);
  }
  publish();
}

void PressEstimator::publish() noexcept {
  const double alpha = std::exp(state_(log_alpha)), beta = std::exp(state_(log_beta));
  const double alpha_ci = 1.96 * std::sqrt(nis_ * covariance_(log_alpha, log_alpha));
  const double beta_ci = 1.96 * std::sqrt(nis_ * covariance_(log_beta, log_beta));
  estimate_.tissue = {alpha, beta};
  estimate_.alpha_ci95_n = alpha * alpha_ci;
  estimate_.beta_ci95_per_m = beta * beta_ci;
  estimate_.contact_m = state_(skin) + state_(breath);
  estimate_.presses = segments_.presses();
  // Below about one alpha only the product alpha beta is observable, whatever the covariance says.
  const bool fits = nis_ < max_nis && segments_.peak_force_n() > 1.2 * alpha * (1.0 + alpha_ci);
  const bool was = estimate_.converged;
  estimate_.converged = estimate_.presses >= 1 && sureness * alpha_ci < options_.converged_alpha &&
                        sureness * beta_ci < options_.converged_beta && fits;
  if (!estimate_.converged)
    estimate_.converged_after_s = -1.0;
  else if (!was)
    estimate_.converged_after_s = segments_.now_s() - segments_.first_contact_s();
}

double PressEstimator::stiffness_n_per_m(double force_n) const noexcept {
  return stiffness_at_force(estimate_.tissue, force_n);
}

double PressEstimator::stiffness_sd(double force_n) const noexcept {
  // ln k = ln beta + ln(alpha^2 + F^2) - ln alpha, so d ln k / d ln alpha = (1 - q^2) / (1 + q^2).
  const double q = std::max(0.0, force_n) / estimate_.tissue.alpha_n;
  const Eigen::Vector2d gradient((1.0 - q * q) / (1.0 + q * q), 1.0);
  return std::sqrt(nis_ * gradient.dot(covariance_.topLeftCorner<2, 2>() * gradient));
}

}  // namespace tuina::tissue
