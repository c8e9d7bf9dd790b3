// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>

#include "tuina/core/contact.hpp"
#include "tuina/massage/technique/rub.hpp"
#include "tuina/massage/technique/surface_curve.hpp"

namespace tuina::massage {

/// Time from the start of one hand's stroke to the end of the other's. Either force rises or falls
/// within half a second in most strokes; for the half second between, both press with all of it,
/// so that the two hands need not touch the skin at the same time.
inline constexpr double hands_overlap_s = 1.5;
/// How two hands stroke in turn, each along the line of its own side.
struct HandOverHand {
  double pass_s = 0.0;  ///< Time of one stroke, the same for both hands.
  bool second = false;  ///< The hand waits for its turn on the skin, with the kept force.
};
/// The time of one stroke that leaves the other hand enough to slide back meanwhile.
[[nodiscard]] double hand_over_hand_pass_s(double length_m, double speed_m_per_s);

/// How a line is stroked.
struct StrokeOptions {
  double force_n = 12.0;
  double speed_m_per_s = 0.060;
  int repeats = 2;  ///< Strokes forward; between two the tool slides back with the kept force.
  std::optional<HandOverHand> turn = {};  ///< Turn that sets the speed.
};

/// The line over the skin through places in their order, bent where a guide point must move.
[[nodiscard]] Result<SurfaceCurve> line_through(const body::BackSurface& back,
                                                std::span<const Vector3> places_in_couch,
                                                const Bend& bend = {});

/// Stroking, [thesis] 3.5.3 and 5.5: from the upper to the lower points along the skin at one
/// speed. The thesis plays back what a masseur taught; here the path is laid on this person's
/// surface.
[[nodiscard]] ContactPath plan_stroke(const SurfaceCurve& line, const StrokeOptions& options,
                                      std::string name);

}  // namespace tuina::massage
