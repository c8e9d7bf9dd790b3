// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tuina/core/contact.hpp"

namespace tuina::tissue {

/// [thesis] (6.1): F = alpha tan(beta x). Near the pole tan has no meaning for flesh, so from this
/// share of it on the curve goes on as its own tangent: finite for every depth.
inline constexpr double tangent_limit = 0.97;

/// Force at a depth; zero without contact (depth <= 0).
[[nodiscard]] double force_at_depth(const TangentTissue& tissue, double depth_m) noexcept;

/// The inverse, x = atan(F / alpha) / beta: bounded, without a pole; continued like the law itself.
[[nodiscard]] double depth_at_force(const TangentTissue& tissue, double force_n) noexcept;

/// dF/dx at a force: beta (alpha^2 + F^2) / alpha, the number a controller needs.
[[nodiscard]] double stiffness_at_force(const TangentTissue& tissue, double force_n) noexcept;

/// dF/dx at a depth.
[[nodiscard]] double stiffness_at_depth(const TangentTissue& tissue, double depth_m) noexcept;

}  // namespace tuina::tissue
