// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <limits>

#include "tuina/tissue/estimator.hpp"

namespace tuina::baselines {

/// What the thesis leaves open or gets wrong is an option here; the defaults are those of its
/// experiments on people (gain 0.1, lengths in millimetres).
struct ThesisEstimatorOptions {
  enum class UpdateRule : std::uint8_t { least_squares, gradient } law = UpdateRule::least_squares;
  double gain_per_s = 0.1;          ///< gamma of (6.17), the forgetting; or of (6.9), the step
  double initial_covariance = 1.0;  ///< P(0) as a multiple of the unit matrix; not printed
  bool normalised = true;           ///< m_s^2 = 1 + phi' phi instead of 1; not printed
  double unit_m = 1e-3;             ///< unit of length inside the regressor; not printed
  /// The correction: with forgetting, P grows as e^(gamma t) while the tool is in the air (6.17),
  /// so hold still without contact. The thesis prints no such rule.
  bool only_in_contact = false;
  double contact_force_n = 1.0;
  double period_s = 1e-3;  ///< between samples; 0: from their times
};

/// [thesis] 6.2: tan as a series of three terms (6.3), its coefficients alpha beta, alpha beta^3
/// and alpha beta^5 by recursive least squares with forgetting (6.16), (6.17), or by the gradient
/// law (6.9). Kept as the baseline it is: the depth counts from an assumed contact point, and the
/// series is short by a third where bone is pressed 5 mm. Stays finite for finite input; `valid`
/// says if beta has a real root.
class ThesisEstimator {
 public:
  using Options = ThesisEstimatorOptions;
  explicit ThesisEstimator(const Options& options = {}) noexcept;

  /// Depth from the assumed contact point.
  void update(double time_s, const Press& sample) noexcept;

  /// The last valid tissue; the thesis knows neither intervals nor convergence.
  [[nodiscard]] TissueEstimate estimate() const noexcept { return {.tissue = tissue_}; }
  [[nodiscard]] bool valid() const noexcept { return valid_; }

 private:
  ThesisEstimatorOptions options_;
  Eigen::Vector3d theta_ = Eigen::Vector3d::Zero();
  Eigen::Matrix3d P_;
  TangentTissue tissue_;
  double last_s_ = std::numeric_limits<double>::infinity();
  bool valid_ = false;
};
static_assert(tissue::Estimator<ThesisEstimator>);

}  // namespace tuina::baselines
