// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tuina/core/contact.hpp"
#include "tuina/core/units.hpp"
#include "tuina/massage/zones.hpp"
#include "tuina/motion/rollout.hpp"

namespace tuina::motion {

/// Largest force that a person who starts up may meet (fault 16 of docs/safety_campaign.md).
inline constexpr double max_startle_n = 75.0;
/// Postures in which a push along the normal of the skin feels a larger mass are avoided: a person
/// who starts up with 2 g has to accelerate it before anybody has let go.
inline constexpr double light_kg = max_startle_n / (2.0 * gravity_m_per_s2);

/// Force between tool and person when the person starts up by 60 mm at 0.4 m/s and 2 g while the
/// arm presses with `force_n`: a mass on the tangent law of the tissue and a torso of 35 N/mm. The
/// arm presses on for 3 ms and then pulls out, as controller and guard do; 8 N of friction hold it.
[[nodiscard]] double startle_force_n(double apparent_mass_kg, double force_n,
                                     const TangentTissue& tissue) noexcept;

/// Largest force, up to `wanted_n`, with which a person who starts up meets `max_startle_n` at
/// most. Tissue that nobody has felt yet is taken as the hardest that the zone has.
[[nodiscard]] double max_pressing_n(double apparent_mass_kg, massage::Zone zone,
                                    double wanted_n) noexcept;

/// Largest apparent mass along the tool's axis over the configurations of a motion.
[[nodiscard]] double max_apparent_mass_kg(const robot::ArmModel& model, double rail_m,
                                          const JointPath& joint_path) noexcept;

/// Penalty for an arm that is felt as heavier than `light_kg`, as an equivalent distance past the
/// midline (m).
[[nodiscard]] double mass_cost_m(double apparent_mass_kg) noexcept;

}  // namespace tuina::motion
