// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "tuina/core/geometry.hpp"

namespace tuina::sim {

/// What skin, hair, lamps and shutter do to a laser line; all zero, nothing.
struct ScanFlaws {
  /// Way after which red light in skin has forgotten where it came from, 1 / mu_s'. 0.3 to 0.5 mm,
  /// [marchesini1992].
  double scatter_m = 0.0;
  double dark_share = 0.0;     ///< of the light the skin swallows, by its tone
  double moles_per_m2 = 0.0;   ///< dark spots of 1 to 3 mm
  double hair_share = 0.0;     ///< of the line lands on hair, up to 2 mm above the skin
  double sweat_share = 0.0;    ///< of the skin glints
  double flicker_share = 0.0;  ///< of the room light, 100 times a second
  double readout_s = 0.0;      ///< rolling shutter: from the first row to the last

  /// Whether any of them is the skin's, not the room's or the camera's.
  [[nodiscard]] bool of_skin() const {
    return scatter_m > 0.0 || dark_share > 0.0 || moles_per_m2 > 0.0 || hair_share > 0.0 ||
           sweat_share > 0.0;
  }
};

/// Light of a laser ray where it leaves the skin again.
struct LeftSkin {
  Vector3 by = Vector3::Zero();  ///< from where it met the skin
  double share = 1.0;            ///< of what bare matt skin sends back
  double spread_m = 0.0;         ///< standard deviation across the line
};

/// `at`: where on the resting person the ray lands, by which hair and moles are told; `direction`
/// and `normal` unit. Oblique light comes out sin(a) / (n mu_s') further along than it went in,
/// [wang1995]. The same everywhere for the same seed.
[[nodiscard]] LeftSkin leave_skin(const ScanFlaws& flaws, const Vector3& at,
                                  const Vector3& direction, const Vector3& normal,
                                  std::uint64_t seed) noexcept;

}  // namespace tuina::sim
