// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "tuina/body/back_surface.hpp"
#include "tuina/core/acupoint.hpp"
#include "tuina/core/result.hpp"
#include "tuina/core/sentence.hpp"
#include "tuina/massage/programme.hpp"
#include "tuina/massage/schedule.hpp"

namespace tuina::massage {

/// What two arms do, in the order of the steps.
struct Plan {
  std::string programme;
  std::vector<PlannedPath> paths;
  double duration_s = 0.0;           ///< Time until both arms have left the skin for good.
  double min_tool_distance_m = 0.0;  ///< Least distance of paths of one step; 0 if none has two.
  std::vector<std::string> zones_touched;  ///< Names, from the least to the most restricted.
  /// Sentences for people: which force was lowered, which path bent, cut or left out, and why.
  std::vector<Sentence> notes;
};

/// Whether a note of a plan tells that a path of the programme is not in it.
[[nodiscard]] bool tells_left_out(const Sentence& note);

/// What bounds a plan besides the zones.
struct PlanOptions {
  double force_scale = 1.0;       ///< Factor on every force, besides the programme's intensity.
  double muscle_cap_n = 30.0;     ///< Cap in muscle; the zone's own cap holds too.
  double force_ceiling_n = 45.0;  ///< Cap in every zone.
  Transfers transfers = {};
  std::vector<NoGo> no_go = {};  ///< Places that the therapist has ruled out.
};

/// Lays a programme onto one person's back. Forces are lowered to the cap of the strictest zone
/// that a path touches, sliding paths are bent around places that are denied, or cut, or left out;
/// the notes say so. Fails when the programme wants a point that the map does not have, when the
/// points are not those of a back, and when nothing remains to be done.
[[nodiscard]] Result<Plan> plan(const body::BackSurface& back, std::span<const Acupoint> acupoints,
                                std::span<const Landmark> landmarks, const Programme& programme,
                                const PlanOptions& options = {});

}  // namespace tuina::massage
