// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "tuina/core/acupoint.hpp"
#include "tuina/history/visit.hpp"
#include "tuina/session/earlier/known_tissue.hpp"

/// What earlier sessions of a person, in the order of time, say for the next one.
namespace tuina::history {

/// The newest session in which something was said by hand, in whatever position: what must not be
/// touched must not be touched in another one either. Null where there is none.
[[nodiscard]] const Visit* last_said(std::span<const Visit> visits);

/// The newest session that has ended and tells its intensity; null where there is none.
[[nodiscard]] const Visit* last_wish(std::span<const Visit> visits);

/// The newest session in a position that has felt tissue; null where there is none. Without a
/// position that of any.
[[nodiscard]] const Visit* last_felt(std::span<const Visit> visits,
                                     std::optional<BodyPosture> position);

/// Where the newest session in a position found the acupoints, to notice somebody else by; nothing
/// where there is none. Without a position that of any.
[[nodiscard]] std::optional<session::KnownTissue> last_lay(std::span<const Visit> visits,
                                                           std::optional<BodyPosture> position);

/// Tissue that the session `felt` has learned well enough to converge, widened by twice the scatter
/// between the sessions of `visits`, once for each day.
[[nodiscard]] session::KnownTissue known_tissue(const Visit& felt, std::span<const Visit> visits);

}  // namespace tuina::history
