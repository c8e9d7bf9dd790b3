// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>

#include "tuina/link/arming.hpp"
#include "tuina/link/link.hpp"

namespace tuina::link {

/// How the processes of a robot wait for each other.
enum class Pace : std::uint8_t {
  real,  ///< a millisecond takes a millisecond, and who is late is late
  max,   ///< simulation: each waits for the others, and for one that is gone only once
};

/// What a guard tells when it ends.
struct GuardReport {
  std::uint64_t ticks = 0;
  std::uint64_t silent_ticks = 0;  ///< without a proposal for them
  double max_check_us = 0.0;       ///< longest time that one judgement took
  PerArm<safety::Verdict> last;
};

/// The guard as a process: judges each reading of the drives until they end, are silent for twenty
/// seconds, the session rests its arms, `ends`, or the controller has died: then both arms leave,
/// and half a second after the last of them pressed it is over. First it tries itself on the first
/// reading: an arm that stands must pass, a torque that is no number and a stop must latch, and the
/// wrist sensors must feel less than 5 N in the air. Fails with Fault::device when that is not so.
[[nodiscard]] Result<GuardReport> keep_guard(Link& link, const Arming& arming, Pace pace,
                                             const std::atomic<bool>& ends);

}  // namespace tuina::link
