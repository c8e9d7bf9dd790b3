// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "tuina/core/result.hpp"
#include "tuina/tissue/press_record.hpp"

namespace tuina::tissue {

/// @{
/// Between these beta is sought; a fit that ends at one of them has found none.
inline constexpr double min_beta_per_m = 5.0, max_beta_per_m = 5000.0;
/// @}

/// Reduced chi square beyond which a record does not keep to the law within its noise: the person
/// breathes, or the tissue relaxes. The intervals then say too little.
inline constexpr double max_chi_square = 4.0;

/// Tangent law fitted to a whole record.
struct CurveFit {
  TangentTissue tissue;
  double contact_m = 0.0;     ///< position of the skin on the axis of the record
  double offset_n = 0.0;      ///< force sensor offset in free air
  double alpha_ci95_n = 0.0;  ///< half-widths of the 95 % intervals
  double beta_ci95_per_m = 0.0;
  double contact_ci95_m = 0.0;
  double rmse_n = 0.0;              ///< of the force, over samples above 1 N
  double reduced_chi_square = 0.0;  ///< mean squared residual over that expected from the noise
  double peak_force_n = 0.0;
  int samples = 0;
  bool settled = false;  ///< no: the search was cut off on the way, and the intervals mean nothing
};

/// Total least squares fit of alpha, beta, contact point and sensor offset to all samples (of
/// a record beyond 30000 to every k-th), each axis in units of its noise, so that depth errors
/// count like force errors. Intervals allow for errors that are correlated between samples (a slow
/// sensor), but for no breath. Fails with not_found if the record holds no contact, with bad_input
/// if it is too short.
[[nodiscard]] Result<CurveFit> fit_curve(std::span<const TimedPress> record,
                                         const SensorNoise& noise);

}  // namespace tuina::tissue
