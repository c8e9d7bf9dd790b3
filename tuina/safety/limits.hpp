// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace tuina::safety {

/// Parts of the back by how hard they may be pressed. `bench` is a patch of tissue in a laboratory,
/// no person.
enum class Zone : std::uint8_t { muscle, bony, kidney, mingmen, spine, denied, bench };
inline constexpr std::size_t zones = 7;

/// As plans and records name it.
[[nodiscard]] constexpr const char* name_of(Zone zone) {
  constexpr std::array<const char*, zones> names = {"muscle", "bony",   "kidney", "mingmen",
                                                    "spine",  "denied", "bench"};
  return names[static_cast<std::size_t>(zone)];
}

/// Force that may be asked for in a zone, and force that stops the arm.
struct ForceLimits {
  double set_n;   ///< the most that may be asked for
  double trip_n;  ///< a median of three samples above this ends the contact
};

/// The ceilings, compiled in. Every one lies below the lowest figure published for the back (100 N)
/// by a factor of 1.5 or more, the bench apart; they are engineering values that a therapist and a
/// laboratory must confirm.
inline constexpr std::array<ForceLimits, zones> force_ceilings = {{
    {45.0, 60.0},  // muscle beside the spine and of the shoulders
    {15.0, 25.0},  // edge of the scapula, ribs, iliac crest
    {20.0, 30.0},  // over the kidneys, T12 to L3: no tapping
    {10.0, 15.0},  // GV4, between two spinous processes: pressed still, nothing else
    {0.0, 10.0},   // within 15 mm of the midline
    {0.0, 10.0},   // neck, head, and all that the scan does not show
    {60.0, 90.0},  // bench
}};

/// Those of a zone.
[[nodiscard]] constexpr ForceLimits ceiling_of(Zone zone) {
  return force_ceilings[static_cast<std::size_t>(zone)];
}

/// Which part of a contact an arm is in: each has its own speed.
enum class Phase : std::uint8_t { free, approach, contact, retract };

/// Limits that no config can raise.
struct Ceilings {
  /// Tool speed that stops the arm, by phase. Orders stay below: 200, 50, 80 and 100 mm/s; escapes
  /// are judged apart.
  std::array<double, 4> tool_speed_m_per_s = {0.30, 0.15, 0.25, 0.30};
  double inward_m_per_s = 0.15;      ///< in contact, into the body: no faster than an approach
  double pushed_out_m_per_s = 0.12;  ///< in contact, along the normal: the person gets up
  double force_rate_n_per_s = 2000.0;
  double over_cap_n = 10.0;  ///< more than this above the zone's `set_n` is borne for 100 ms only
  double torque_rate_nm_per_s = 1000.0;
  double encoder_jump_rad = 5e-3;  ///< in one millisecond
  /// Of the first four joints, which carry the forearm: an elbow that swings while the tool stays.
  double joint_speed_rad_per_s = 3.0;
  double stale_freeze_s = 3e-3;  ///< age of the wrist sensor's sample
  double stale_retract_s = 5e-3;
  /// Cap of the force inward that the proposed torques hold (what overcomes friction or speeds the
  /// tool up looks like such a force, too): so much above the set force, less two newtons for each
  /// newton felt beyond that. On the way out: so much, or 3 N above the least felt since it leaves.
  double pressing_n = 20.0;
  double over_trip_n = 10.0;    ///< likewise, above the trip of the zone, whatever the set force
  double free_inward_n = 60.0;  ///< likewise, in free motion; on the way out never more than this
};
inline constexpr Ceilings ceilings;

/// Samples of a wrist sensor in a row that may each be equal to the one before, to the last bit;
/// with one more it counts as stuck.
inline constexpr int max_wrist_repeats = 9;

}  // namespace tuina::safety
