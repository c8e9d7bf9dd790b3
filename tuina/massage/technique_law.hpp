// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tuina/core/contact.hpp"
#include "tuina/core/technique.hpp"
#include "tuina/massage/programme.hpp"
#include "tuina/massage/technique/stroke.hpp"
#include "tuina/massage/technique/surface_curve.hpp"

namespace tuina::massage {

/// A number that a programme may give.
struct Range {
  double usual, min, max;
};

/// A part of a programme on one curve of the skin, its force as zone and caps leave it.
struct SlidingOrder {
  const Part& part;
  double force_n = 0.0;
  int repeats = 1;                        ///< Turns or strokes.
  std::optional<HandOverHand> turn = {};  ///< Turn of this hand where two stroke hand over hand.
};

/// What of a technique a programme may say, and how it is laid on the skin. The words, colours and
/// margins of a technique, which other rooms need too, are those of `TechniqueRow`.
struct TechniqueLaw {
  Technique technique;
  std::vector<std::string> keys;  ///< Keys of a part that it knows.
  Range rate_hz = {.usual = 0.35, .min = 0.1, .max = 1.0};
  Range radius_mm = {.usual = 30.0, .min = 10.0, .max = 50.0};
  double max_beat_n_per_s = 0.0;  ///< Fastest change of a force that beats; 0: it does not beat.
  bool circles = false;           ///< It slides around a place; others slide along a line.
  bool begins_at_spine = false;   ///< Its circle begins on the side of the spine, not outside.
  /// Time of one turn or stroke, s; null where the tool stands.
  double (*once_s)(const SurfaceCurve& curve, const SlidingOrder& order) = nullptr;
  /// The path along a curve; null where the tool stands.
  ContactPath (*along)(const SurfaceCurve& curve, const SlidingOrder& order,
                       std::string name) = nullptr;
};

/// Row of the table of laws.
[[nodiscard]] const TechniqueLaw& law_of(Technique technique);

}  // namespace tuina::massage
