// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "tuina/core/geometry.hpp"

namespace tuina {

/// Posture of the person on the couch. It decides the axes of the `couch` frame
/// (docs/frames_and_units.md): x to the person's left (nominally), z up, z = 0 the seat or bed
/// plane; sitting: y out of the back; prone: y towards the feet.
enum class BodyPosture : std::uint8_t { sitting, prone };

/// "sitting" or "prone", as files and options say it.
[[nodiscard]] constexpr const char* name_of(BodyPosture position) {
  return position == BodyPosture::sitting ? "sitting" : "prone";
}

/// A named point on the skin: `BL47_L` (acupoint) or `scapula_root_R` (landmark). _L and _R are the
/// person's left and right.
struct Acupoint {
  std::string name;
  Vector3 at_in_couch = Vector3::Zero();
  Vector3 normal_in_couch = Vector3::UnitY();  ///< unit, out of the body
  double uncertainty_m = 0.0;  ///< radius that holds the true point in 95 % of cases
};

/// A place of the body that a scan shows, such as "C7".
struct Landmark {
  std::string name;
  Vector3 at_in_couch = Vector3::Zero();
};

/// The seven points of the thesis (Table 5-1), in the order of every report.
inline constexpr std::array<const char*, 7> seven_acupoints = {
    "SI11_L", "SI11_R", "BL47_L", "BL47_R", "BL50_L", "BL50_R", "GV4"};
}  // namespace tuina
