// SPDX-License-Identifier: Apache-2.0
// Your controller presses, tuina feels: nothing but room tissue is needed. Once a millisecond the
// estimator is told where the tool is along the inward normal and what the force sensor says; it
// takes no heap and waits for nothing. Here the controller is a motor at 12 mm/s that turns round
// at 20 N, and the tissue is somebody's calf.
#include <fmt/core.h>

#include <cmath>

#include "tuina/tissue.hpp"

namespace {

/// Stands for your robot: where its tool is, and the force that it meets there.
class YourController {
 public:
  tuina::Press step() {
    const double depth_m = std::max(0.0, position_m_);
    const double force_n = alpha_n * std::tan(beta_per_m * depth_m);
    if (force_n > 20.0) inward_ = false;
    if (position_m_ < -2e-3) inward_ = true;
    position_m_ += (inward_ ? 12e-3 : -12e-3) * 1e-3;
    return {.depth_m = position_m_, .force_n = force_n};
  }

 private:
  static constexpr double alpha_n = 12.0, beta_per_m = 150.0;
  double position_m_ = -2e-3;  // the skin is at zero, which the estimator need not know exactly
  bool inward_ = true;
};

}  // namespace

int main() {
  YourController controller;
  tuina::tissue::PressEstimator estimator({.force_noise_n = 0.05, .position_noise_m = 2e-5});
  for (int tick = 0; tick < 6000; ++tick) {
    const double time_s = 1e-3 * tick;
    estimator.update(time_s, controller.step());
    const tuina::TissueEstimate& felt = estimator.estimate();
    if (!felt.converged) continue;
    fmt::print("after {:.2f} s: alpha {:.1f} +- {:.1f} N, beta {:.3f} +- {:.3f} /mm\n", time_s,
               felt.tissue.alpha_n, felt.alpha_ci95_n, 1e-3 * felt.tissue.beta_per_m,
               1e-3 * felt.beta_ci95_per_m);
    return 0;
  }
  return 1;
}
