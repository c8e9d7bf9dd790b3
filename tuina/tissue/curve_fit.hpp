// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "tuina/core/result.hpp"
#include "tuina/tissue/press_record.hpp"

namespace tuina::tissue {

/// The tangent law laid through a whole record at once.
struct CurveFit {
  TangentTissue tissue;
  double contact_m = 0.0;     ///< where the skin is on the axis of the record
  double offset_n = 0.0;      ///< what the force sensor shows in free air
  double alpha_ci95_n = 0.0;  ///< half-widths of the 95 % intervals
  double beta_ci95_per_m = 0.0;
  double contact_ci95_m = 0.0;
  double rmse_n = 0.0;  ///< of the force, over samples above 1 N
  double chi = 0.0;     ///< squared misfit over what the noise explains
  double peak_force_n = 0.0;
  int samples = 0;
};

/// Fits alpha, beta, the contact point and the zero of the force sensor: the sum of the squared
/// shortest distances of all samples, in contact and before it, to the curve, each axis in units of
/// its noise. So errors of depth count like errors of force, and the steep end is as harmless as
/// the flat one. Intervals allow for errors that are alike from sample to sample (a breath, a slow
/// sensor). Fails with not_found if the record holds no contact, with bad_input if it is too short.
[[nodiscard]] Result<CurveFit> fit_curve(std::span<const TimedPress> record,
                                         const SensorNoise& noise);

}  // namespace tuina::tissue
