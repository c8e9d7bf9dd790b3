// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tuina/body/back_surface.hpp"
#include "tuina/core/acupoint.hpp"
#include "tuina/core/result.hpp"
#include "tuina/massage/technique/contact_path.hpp"

namespace tuina::massage {

/// Where a tool meets the skin at an acupoint, with the normal of the disc that it presses on.
/// Fails with Fault::not_found where the scan shows no skin within 20 mm.
[[nodiscard]] Result<body::SurfacePoint> on_skin(const body::BackSurface& back,
                                                 const Acupoint& point);

/// Whether the scan has a point beside each place of a path, within 12 mm or twice the distance of
/// its points: a surface that is continued through a hole or past the rim is no skin that anybody
/// has seen.
[[nodiscard]] bool is_shown(const body::BackSurface& back, const ContactPath& path);

}  // namespace tuina::massage
