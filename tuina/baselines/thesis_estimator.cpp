// SPDX-License-Identifier: Apache-2.0
#include "tuina/baselines/thesis_estimator.hpp"

#include <cmath>

namespace tuina::baselines {

ThesisEstimator::ThesisEstimator(const ThesisEstimatorOptions& options) noexcept
    : options_(options), P_(Eigen::Matrix3d::Identity() * options.initial_covariance) {}

void ThesisEstimator::update(double time_s, const Press& sample) noexcept {
  const double dt_s = options_.period_s > 0.0 ? options_.period_s : time_s - last_s_;
  last_s_ = time_s;
  if (!std::isfinite(sample.depth_m) || !std::isfinite(sample.force_n) || !(dt_s > 0.0) ||
      dt_s > 1.0)
    return;
  if (options_.only_in_contact && sample.force_n < options_.contact_force_n) return;
  const double x = sample.depth_m / options_.unit_m, x3 = x * x * x;
  const Eigen::Vector3d phi(x, x3 / 3.0, 2.0 * x3 * x * x / 15.0);  // (6.10)
  const double ms2 = options_.normalised ? 1.0 + phi.squaredNorm() : 1.0;
  const double gamma = options_.gain_per_s;

  Eigen::Vector3d theta;
  Eigen::Matrix3d P = P_;
  if (options_.law == ThesisEstimatorOptions::UpdateRule::gradient) {
    // (6.9), implicit over the step, so it is stable for any gain.
    const double gain = gamma * dt_s / ms2;
    theta =
        theta_ + gain / (1.0 + gain * phi.squaredNorm()) * (sample.force_n - theta_.dot(phi)) * phi;
  } else {
    // (6.16) and (6.17) integrated exactly over a step in which phi stands still: the inverse of P
    // decays by e^(-gamma dt) and gains phi phi' / m_s^2.
    const double growth = std::exp(gamma * dt_s);
    const double g = (gamma > 0.0 ? (1.0 - 1.0 / growth) / gamma : dt_s) / ms2;
    P *= growth;
    const Eigen::Vector3d P_phi = P * phi;
    P -= (P_phi * (g / (1.0 + g * phi.dot(P_phi)))) * P_phi.transpose();
    P = (0.5 * (P + P.transpose())).eval();
    theta = theta_ + g * (sample.force_n - theta_.dot(phi)) * (P * phi);
  }
  if (!theta.allFinite() || !P.allFinite() || P.diagonal().maxCoeff() > 1e200) return;
  theta_ = theta;
  P_ = P;

  // 6.3.1: beta^2 = (alpha beta^3) / (alpha beta); the third coefficient is not used.
  const double squared = theta_(1) / theta_(0);
  valid_ = theta_(0) > 0.0 && squared > 0.0 && std::isfinite(squared);
  if (!valid_) return;
  const double beta = std::sqrt(squared);
  tissue_ = {theta_(0) / beta, beta / options_.unit_m};
}

}  // namespace tuina::baselines
