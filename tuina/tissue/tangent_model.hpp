// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tuina/core/contact.hpp"

namespace tuina::tissue {

/// [thesis] (6.1): F = alpha tan(beta x). Beyond this share of the pole the curve continues as its
/// tangent, so that it is finite for every depth.
inline constexpr double tangent_limit = 0.97;

/// Force at a depth; zero without contact (depth <= 0).
[[nodiscard]] double force_at_depth(const TangentTissue& tissue, double depth_m) noexcept;

/// Inverse law x = atan(F / alpha) / beta, bounded; continued like the law itself.
[[nodiscard]] double depth_at_force(const TangentTissue& tissue, double force_n) noexcept;

/// dF/dx at a force: beta (alpha^2 + F^2) / alpha, the contact stiffness a controller needs.
[[nodiscard]] double stiffness_at_force(const TangentTissue& tissue, double force_n) noexcept;

/// Tangent law through a depth at a force and a depth at half of that force. Where none passes
/// through both, as when the second depth is half of the first, that of the nearest alpha between
/// force / 200 and force / 0.02.
[[nodiscard]] TangentTissue tangent_through(double force_n, double depth_m,
                                            double half_force_depth_m) noexcept;

/// dF/dx at a depth.
[[nodiscard]] double stiffness_at_depth(const TangentTissue& tissue, double depth_m) noexcept;

}  // namespace tuina::tissue
