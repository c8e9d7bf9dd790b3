// SPDX-License-Identifier: Apache-2.0
#include "tuina/tissue/breath.hpp"

#include <cmath>

namespace tuina::tissue {

Eigen::Matrix2d breath_transition(double omega, double zeta, double dt_s) noexcept {
  Eigen::Matrix2d phi;
  const double x = omega * dt_s;
  double c, s;  // e^(-zeta x) cos(r x) and e^(-zeta x) sin(r x) / r with r^2 = 1 - zeta^2
  if (x < 0.2) {
    // The power series saves three library calls per segment; its next term is below 3e-6 for
    // damping ratios up to a half.
    s = x * (1.0 + x * (-zeta + x * ((4.0 * zeta * zeta - 1.0) / 6.0 +
                                     x * (zeta - 2.0 * zeta * zeta * zeta) / 6.0)));
    c = zeta * s + 1.0 +
        x * (-2.0 * zeta +
             x * ((4.0 * zeta * zeta - 1.0) / 2.0 +
                  x * ((4.0 * zeta - 8.0 * zeta * zeta * zeta) / 6.0 +
                       x * (16.0 * zeta * zeta * zeta * zeta - 12.0 * zeta * zeta + 1.0) / 24.0)));
  } else {
    const double r = std::sqrt(1.0 - zeta * zeta), decay = std::exp(-zeta * x);
    c = decay * std::cos(r * x);
    s = decay * std::sin(r * x) / r;
  }
  phi << c + zeta * s, s / omega, -omega * s, c - zeta * s;
  return phi;
}

}  // namespace tuina::tissue
