// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "tuina/tissue/estimator.hpp"

namespace tuina::baselines {

struct KalmanEstimatorOptions {
  double force_noise_n = 0.2;
  double position_noise_m = 0.05e-3;
  double contact_sd_m = 0.5e-3;
  double contact_force_n = 1.0;
  TangentTissue expected = {5.6, 215.0};
  double expected_alpha_sd = 0.5;  ///< of the logarithm
  double expected_beta_sd = 0.3;
};

/// The usual answer to this problem, kept as a peer: an extended Kalman filter of ln alpha, ln beta
/// and the contact point that predicts the force, F = alpha tan(beta (x - c)). Each sample is
/// linearised once, where the estimate then is, and never again; near the pole of the tangent it
/// may run away. Stays finite.
class KalmanEstimator {
 public:
  using Options = KalmanEstimatorOptions;
  explicit KalmanEstimator(const Options& options = {}) noexcept;

  /// The time plays no part: nothing is believed to change.
  void update(double time_s, const Press& sample) noexcept;

  /// Alpha, beta, the contact point, and their 95 % intervals; never `converged`.
  [[nodiscard]] TissueEstimate estimate() const noexcept;

 private:
  KalmanEstimatorOptions options_;
  Eigen::Vector3d x_;  // ln alpha, ln beta, contact
  Eigen::Matrix3d P_;
};
static_assert(tissue::Estimator<KalmanEstimator>);

}  // namespace tuina::baselines
