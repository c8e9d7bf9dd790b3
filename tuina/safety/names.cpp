// SPDX-License-Identifier: Apache-2.0
#include "tuina/safety/guard.hpp"

namespace tuina::safety {

const char* name_of(Action action) noexcept {
  constexpr std::array names = {"pass", "warn", "freeze", "comply", "retract", "brake"};
  return names[static_cast<std::size_t>(action)];
}

const char* name_of(Cause cause) noexcept {
  constexpr std::array names = {"none",
                                "torque clamped",
                                "torque rate clamped",
                                "late tick",
                                "force spike",
                                "force sensor stale",
                                "encoder jump",
                                "joint too fast",
                                "tool too fast",
                                "torque saturated",
                                "tool pushed out",
                                "proposal not usable",
                                "torque not finite",
                                "leash too long",
                                "force sensor spikes",
                                "force rising too fast",
                                "force over the zone's ceiling",
                                "force over the trip",
                                "set force over the zone's ceiling",
                                "joint state not finite",
                                "arms too close",
                                "too close to the couch or its own body",
                                "asked to stop",
                                "person moved, a new scan is needed",
                                "does not stand as planned",
                                "clock does not go with the ticks",
                                "force sensor stuck",
                                "force sensor off its zero, or another tool",
                                "felt force against the way out",
                                "pressing harder than the zone bears",
                                "arm does not obey",
                                "torques and motion disagree",
                                "a drive does not give what it is told",
                                "linear base moved",
                                "operator or hand stop silent",
                                "controller is silent",
                                "guard is silent"};
  return names[static_cast<std::size_t>(cause)];
}

}  // namespace tuina::safety
