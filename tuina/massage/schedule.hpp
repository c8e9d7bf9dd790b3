// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tuina/core/arm.hpp"
#include "tuina/core/contact.hpp"
#include "tuina/core/sentence.hpp"
#include "tuina/massage/zones.hpp"

namespace tuina::massage {

/// A path that waits for an arm and a time.
struct WaitingPath {
  ContactPath path;
  Zone zone = Zone::muscle;  ///< Strictest zone that the path touches.
  double cap_n = 0.0;
  double programme_n = 0.0;  ///< Largest force that the programme asks for.
  Sentence lowered_by;       ///< What bears less than that; empty: nothing.
  std::optional<Arm> arm;    ///< Empty where either arm may do it, as on the spine.
  bool together = true;
  int part = 0;  ///< Part of the programme; only paths of one part run at the same time.
};

/// A path with its arm and its time. Paths of one step run at the same time, one per arm, and stay
/// apart even if one of the arms is late. A step begins when all paths of the step before have left
/// the skin: paths of different steps must not overlap.
struct PlannedPath {
  ContactPath path;
  Arm arm = Arm::left;
  int step = 0;          ///< 0, 1, 2, ...
  double start_s = 0.0;  ///< Time of the first touch, if all goes to plan.
  Zone zone = Zone::muscle;
  double cap_n = 0.0;        ///< Largest force that may be asked for here.
  double programme_n = 0.0;  ///< Largest force that the programme asks for.
  Sentence lowered_by;       ///< What bears less than that; empty: nothing.

  [[nodiscard]] double end_s() const { return start_s + path.duration_s(); }
  [[nodiscard]] double ordered_n() const;  ///< Largest force of the path, all limits regarded.
};

/// How an arm goes from one place to the next: off the skin, above it, down to it.
struct Transfers {
  double standoff_m = 0.040;
  double retract_m_per_s = 0.100;
  double travel_m_per_s = 0.200;
  double approach_m_per_s = 0.050;
  double last_m = 0.010;  ///< Last bit of the way down, searched for contact.
  double search_m_per_s = 0.020;
  double start_and_stop_s = 0.4;  ///< Time that each move needs to gain and lose speed.

  [[nodiscard]] double retract_s() const;
  /// Time of a way above the skin.
  [[nodiscard]] double travel_s(double distance_m) const;
  [[nodiscard]] double approach_s() const;
};

/// Arms of 50 mm radius that press side by side, 25 mm kept between them, rounded up.
inline constexpr double closest_tools_m = 0.130;

/// Shares the paths among the arms, in their order, two at a time where the tools stay
/// `closest_tools_m` apart. Bilateral points follow each other in the order and so come together.
[[nodiscard]] std::vector<PlannedPath> schedule(std::vector<WaitingPath> paths,
                                                const Transfers& transfers);

/// The smallest distance between the skin places of two paths, at whatever times.
[[nodiscard]] double distance_between_m(const ContactPath& one, const ContactPath& other);

}  // namespace tuina::massage
