// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "tuina/tissue/press_record.hpp"

namespace tuina::baselines {

/// Laws that have been proposed for soft tissue, x the depth and v its rate: k x; k x^2; k x^1.5
/// (a sphere on an elastic half-space); a (e^(b x) - 1); the thesis' alpha tan(beta x); k x + d v;
/// k x^n (1 + mu v).
enum class TissueLaw : std::uint8_t {
  linear,
  quadratic,
  hertz,
  exponential,
  tangent,
  kelvin_voigt,
  hunt_crossley
};
inline constexpr std::array<TissueLaw, 7> tissue_laws = {
    TissueLaw::linear,  TissueLaw::quadratic,    TissueLaw::hertz,        TissueLaw::exponential,
    TissueLaw::tangent, TissueLaw::kelvin_voigt, TissueLaw::hunt_crossley};
[[nodiscard]] const char* name_of(TissueLaw law) noexcept;

struct LawFit {
  std::array<double, 3> parameters = {};  ///< in the order they stand above; m, N, s
  double contact_m = 0.0;                 ///< fitted too
  double rmse_n = 0.0;                    ///< over all samples
  double aic = 0.0;  ///< of Akaike: n ln(mean square) + 2 (parameters); the least is the best law
};

/// Least squares in force of one law to a record of presses, the place of the skin free, by
/// Levenberg and Marquardt. The position is taken as exact, as [thesis] 6.1 takes it. At least ten
/// samples.
[[nodiscard]] LawFit fit_law(std::span<const tissue::TimedPress> record, TissueLaw law);

}  // namespace tuina::baselines
