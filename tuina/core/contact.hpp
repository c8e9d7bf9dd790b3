// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "tuina/core/arm.hpp"
#include "tuina/core/geometry.hpp"
#include "tuina/core/technique.hpp"

namespace tuina {

/// Where on the skin the tool should be at a time, and how hard it should press there.
struct ContactPoint {
  double time_s = 0.0;                         ///< since the start of its path
  Vector3 at_in_couch = Vector3::Zero();       ///< on the undeformed skin
  Vector3 normal_in_couch = Vector3::UnitZ();  ///< unit, out of the body
  double force_n = 0.0;                        ///< along minus the normal, onto the person
};

/// One technique at one place: what one arm does between touching the skin and leaving it.
/// The time runs evenly from zero; position, normal and force are interpolated between the samples.
struct ContactPath {
  std::string name;  ///< "press BL47_L", for people
  Technique technique = Technique::press;
  std::vector<std::string> acupoints;  ///< the points it serves, in order
  std::vector<ContactPoint> points;

  [[nodiscard]] double duration_s() const { return points.empty() ? 0.0 : points.back().time_s; }
};

/// F = alpha tan(beta x), [thesis] (6.1): alpha is the hardness, beta grows as the layer gets
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

struct TissueEstimate {
  TangentTissue tissue;
  double alpha_ci95_n = 0.0;  ///< half-width of the 95 % interval
  double beta_ci95_per_m = 0.0;
  double contact_m = 0.0;  ///< where the skin is on the axis of the samples
  int presses = 0;
  bool converged = false;
  double converged_after_s = -1.0;  ///< since the first contact; negative while not converged
};

}  // namespace tuina
