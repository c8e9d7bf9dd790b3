// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "tuina/core/units.hpp"

namespace tuina::tissue {

/// How the skin moves as the person breathes: a damped oscillator driven by noise.
struct Breath {
  double peak_to_peak_m = 0.0;
  double rate_hz = 0.25;
  double damping = 0.15;  ///< damping ratio; 0 is a pure sinusoid
};

/// Exact transition of (b, b') over dt for b'' + 2 zeta omega b' + omega^2 b = noise.
[[nodiscard]] Eigen::Matrix2d breath_transition(double omega, double zeta, double dt_s) noexcept;

/// A Kalman filter's belief some time later; b and b' are its last two states. Stationary: the
/// noise restores what damping takes from the variance.
template <int states>
void move_breath(Eigen::Matrix<double, states, 1>& mean, Eigen::Matrix<double, states, states>& P,
                 const Breath& breath, double dt_s) noexcept {
  const double omega = 2.0 * pi * breath.rate_hz;
  // A sinusoid of peak-to-peak A has the variance A^2 / 8.
  const double variance = breath.peak_to_peak_m * breath.peak_to_peak_m / 8.0;
  const Eigen::Matrix2d phi = breath_transition(omega, breath.damping, dt_s);
  mean.template tail<2>() = (phi * mean.template tail<2>()).eval();
  Eigen::Matrix2d rest = Eigen::Matrix2d::Zero();
  rest.diagonal() << variance, variance * omega * omega;
  const Eigen::Matrix<double, states - 2, 2> cross =
      P.template topRightCorner<states - 2, 2>() * phi.transpose();
  const Eigen::Matrix2d own =
      phi * (P.template bottomRightCorner<2, 2>() - rest) * phi.transpose() + rest;
  P.template topRightCorner<states - 2, 2>() = cross;
  P.template bottomLeftCorner<2, states - 2>() = cross.transpose();
  P.template bottomRightCorner<2, 2>() = own;
}

}  // namespace tuina::tissue
