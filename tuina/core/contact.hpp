// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "tuina/core/arm.hpp"
#include "tuina/core/geometry.hpp"
#include "tuina/core/technique.hpp"

namespace tuina {

/// Set point of the tool on the skin at one time.
struct ContactPoint {
  double time_s = 0.0;                         ///< time since the start of the path
  Vector3 at_in_couch = Vector3::Zero();       ///< point on the undeformed skin
  Vector3 normal_in_couch = Vector3::UnitZ();  ///< unit, out of the body
  double force_n = 0.0;                        ///< force onto the person, along minus the normal
};

/// One technique at one place, from touching the skin to leaving it. Times are evenly spaced and
/// begin at zero; position, normal and force are interpolated between samples.
struct ContactPath {
  std::string name;  ///< name for people, "press BL47_L"
  Technique technique = Technique::press;
  std::vector<std::string> acupoints;  ///< acupoints it treats, in order
  std::vector<ContactPoint> points;

  [[nodiscard]] double duration_s() const { return points.empty() ? 0.0 : points.back().time_s; }
};

/// F = alpha tan(beta x), [thesis] (6.1). alpha is the hardness; beta grows as the layer gets
/// thinner.
struct TangentTissue {
  double alpha_n = 0.0;
  double beta_per_m = 0.0;
};

/// One sample of a press, along the inward normal of the back.
struct Press {
  double depth_m = 0.0;
  double force_n = 0.0;
};

/// What presses have shown of a tissue.
struct TissueEstimate {
  TangentTissue tissue;
  double alpha_ci95_n = 0.0;  ///< half-width of the 95 % interval
  double beta_ci95_per_m = 0.0;
  double contact_m = 0.0;  ///< position of the skin on the axis of the samples
  int presses = 0;
  bool converged = false;
  double converged_after_s = -1.0;  ///< time since the first contact; negative: not converged
};

}  // namespace tuina
