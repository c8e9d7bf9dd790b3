// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "tuina/core/random.hpp"
#include "tuina/sim/person/living_tissue.hpp"
#include "tuina/tissue/press_record.hpp"

namespace tuina::sim {

/// A person whose tissue is a `LivingTissue` that does not keep to the tangent law; all zero, they
/// do. docs/tissue.md has the source of each size.
struct TissueWorld {
  std::string name, about;
  ElasticForm::Law elastic = {};
  double relaxing_share = 0.0;       ///< of the elastic force, from 0.1 s to 10 s
  double damping_s_per_m = 0.0;      ///< mu, within a third
  bool on_torso = false;             ///< which has a mass, a spring and a damper
  double first_press_stiffer = 0.0;  ///< share
  double tensing_share = 0.0;        ///< stiffer by it within 0.3 s, and back
  double tensing_presses = 0.0;      ///< share of the presses at which they tense
  double breath_m = 0.0;             ///< peak to peak; rate and depth vary, some are sighs
  bool poor_sensor = false;          ///< drift, crosstalk and hysteresis of the force
  double slipping = 0.0;             ///< 1: another place is 10 % harder, 4 % thinner, 0.5 mm off
};
/// All worlds in which estimators are judged.
[[nodiscard]] const std::vector<TissueWorld>& tissue_worlds();

/// How a place is pressed: swells of a second with pauses in the air, the presses of a session with
/// their holds, or one swell after the other.
enum class Pressing : std::uint8_t { swells, holds, sinusoid };
inline constexpr std::array<Pressing, 3> ways_of_pressing = {Pressing::swells, Pressing::holds,
                                                             Pressing::sinusoid};

/// What the sensors said at 1 kHz (0.2 N and 0.05 mm of noise), and what was true.
struct WorldPresses {
  std::vector<tissue::TimedPress> record, truth;
  std::size_t last_press = 0;  ///< sample at which the last press begins, in the air
};
/// Of tissue about as given, of a person of its own.
[[nodiscard]] WorldPresses press_in_world(const TissueWorld& world, Pressing pressing,
                                          const TangentTissue& tissue, Random& random);

/// What a press is drawn by: what stays with a place of a person, the force sensor, and the day.
struct WorldDraws {
  Random &place, &sensor, &day;
};
/// Of this very tissue, so that a place can be pressed again on another day.
[[nodiscard]] WorldPresses press_in_world(const TissueWorld& world, Pressing pressing,
                                          TangentTissue here, const WorldDraws& draws);

}  // namespace tuina::sim
