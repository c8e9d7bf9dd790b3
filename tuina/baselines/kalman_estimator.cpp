// SPDX-License-Identifier: Apache-2.0
#include "tuina/baselines/kalman_estimator.hpp"

#include <algorithm>
#include <cmath>

#include "tuina/tissue/tangent_model.hpp"

namespace tuina::baselines {

using namespace tissue;

KalmanEstimator::KalmanEstimator(const KalmanEstimatorOptions& options) noexcept
    : options_(options),
      x_(std::log(options.expected.alpha_n), std::log(options.expected.beta_per_m), 0.0),
      P_(Eigen::Vector3d(options.expected_alpha_sd, options.expected_beta_sd, options.contact_sd_m)
             .cwiseAbs2()
             .asDiagonal()) {}

void KalmanEstimator::update(double /*time_s*/, const Press& sample) noexcept {
  if (!std::isfinite(sample.depth_m) || !std::isfinite(sample.force_n)) return;
  if (sample.force_n < options_.contact_force_n) return;
  const TangentTissue tissue{std::exp(x_(0)), std::exp(x_(1))};
  const double depth_m = std::max(0.0, sample.depth_m - x_(2));
  const double predicted_n = force_at_depth(tissue, depth_m);
  const double slope = stiffness_at_depth(tissue, depth_m);
  const Eigen::Vector3d H(predicted_n, slope * depth_m, -slope);
  const double noise_n = std::hypot(options_.force_noise_n, slope * options_.position_noise_m);
  const Eigen::Vector3d PH = P_ * H;
  const double S = H.dot(PH) + noise_n * noise_n;
  const Eigen::Vector3d x = x_ + PH * ((sample.force_n - predicted_n) / S);
  const Eigen::Matrix3d P = P_ - PH * PH.transpose() / S;
  if (!x.allFinite() || !P.allFinite()) return;
  x_(0) = std::clamp(x(0), std::log(0.1), std::log(200.0));
  x_(1) = std::clamp(x(1), std::log(10.0), std::log(5000.0));
  x_(2) = std::clamp(x(2), -0.05, 0.05);
  P_ = 0.5 * (P + P.transpose());
}

TissueEstimate KalmanEstimator::estimate() const noexcept {
  TissueEstimate estimate;
  estimate.tissue = {std::exp(x_(0)), std::exp(x_(1))};
  estimate.alpha_ci95_n = 1.96 * estimate.tissue.alpha_n * std::sqrt(std::max(0.0, P_(0, 0)));
  estimate.beta_ci95_per_m = 1.96 * estimate.tissue.beta_per_m * std::sqrt(std::max(0.0, P_(1, 1)));
  estimate.contact_m = x_(2);
  return estimate;
}

}  // namespace tuina::baselines
