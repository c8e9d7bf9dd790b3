// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tuina/massage/zones.hpp"
#include "tuina/safety/limits.hpp"

namespace tuina::session {

/// The guard's zone for a zone of the plan, which has more of them: the one with the same cap and
/// the same trip. Whoever moves an arm on a person's skin tells the guard this zone.
[[nodiscard]] constexpr safety::Zone guarded_zone(massage::Zone zone) noexcept {
  switch (zone) {
    case massage::Zone::muscle:
      return safety::Zone::muscle;
    case massage::Zone::kidney:
      return safety::Zone::kidney;
    case massage::Zone::ribs:
    case massage::Zone::scapula_edge:
    case massage::Zone::iliac_crest:
    case massage::Zone::spine_margin:
      return safety::Zone::bony;
    case massage::Zone::gv4:
      return safety::Zone::mingmen;
    case massage::Zone::spine:
      return safety::Zone::spine;
    case massage::Zone::neck:
    case massage::Zone::outside:
    case massage::Zone::no_go:
      return safety::Zone::denied;
  }
  return safety::Zone::denied;
}

/// The most that a controller's spring may pull into a zone: a little below the trip of the guard,
/// whose way out of the body is not the controller's to the last degree.
[[nodiscard]] constexpr double max_spring_n(safety::Zone zone) noexcept {
  constexpr double kept_below = 0.97;
  return kept_below * safety::ceiling_of(zone).trip_n;
}

}  // namespace tuina::session
