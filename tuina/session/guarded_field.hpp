// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "tuina/body/back_surface.hpp"
#include "tuina/core/result.hpp"
#include "tuina/massage/no_go.hpp"
#include "tuina/safety/zone_field.hpp"

namespace tuina::session {

/// What the guard is told of a person before a massage: for each place of the scanned back its zone
/// and the way out of the body. Gaps and edges are filled by 18 mm from the skin that the scan
/// shows, with the strictest zone beside them; beyond, places are denied. Fails when the points are
/// not those of a back.
[[nodiscard]] Result<safety::ZoneField> zone_field(const body::BackSurface& back,
                                                   std::span<const Acupoint> acupoints,
                                                   std::span<const Landmark> landmarks,
                                                   std::span<const massage::NoGo> no_go,
                                                   const Transform& base_from_couch);

}  // namespace tuina::session
