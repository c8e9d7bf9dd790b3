// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "tuina/robot/robot.hpp"
#include "tuina/safety/robot_guard.hpp"

// What goes between the processes of one robot in each millisecond: the drives tell what they
// sense, the controller what it proposes, the guard what is done. All are plain bytes of one fixed
// layout; `layout` changes with it.
namespace tuina::link::wire {

inline constexpr std::uint64_t layout = 0x7475'696e'6100'0004;  // "tuina", version 4

inline constexpr std::uint64_t no_tick = ~std::uint64_t{0};

/// One number per joint.
struct Joints {
  std::array<double, max_joints> of = {};
  std::int32_t count = 0;
};

/// What one arm senses: rad, rad/s, N and Nm.
struct SensorArm {
  Joints q_rad, dq_rad_per_s;
  std::array<double, 6> wrench_in_tool = {};  ///< force, then torque
  double wrench_time_s = 0.0;
  std::int32_t command_age = 0;
  Joints measured_torque_nm;  ///< none where the drives tell none
};
/// What the drives sense in a millisecond.
struct SensorFrame {
  std::uint64_t tick = 0;
  std::uint64_t process = 0;  ///< number of the process that drives
  std::uint64_t stands = 0;   ///< number of the wish to stand that was fulfilled last
  std::uint64_t over = 0;     ///< 1: the drives have ended, and nothing comes after this
  double time_s = 0.0;
  double rail_m = 0.0;
  std::array<SensorArm, 2> arms = {};
};

/// What the controller wants of one arm, as safety::Proposal.
struct ProposedArm {
  Joints torque_nm;
  std::array<double, 3> normal_in_base = {}, virtual_target_in_base = {};
  double set_force_n = 0.0;
  double stiffness_n_per_m = 0.0;
  std::uint8_t phase = 0, zone = 0;
};
/// What the controller wants of both arms.
struct ProposalFrame {
  std::uint64_t answers_tick = 0;
  double rail_m = 0.0;
  std::uint8_t stop_asked = 0;
  std::array<ProposedArm, 2> arms = {};
};

/// What a session asks of the drives before its first millisecond and after its last.
struct StandFrame {
  std::uint64_t number = 0;  ///< a new one for each wish
  /// Which guard of this session is to judge: 0 is the first, and each rest of the arms asks for a
  /// new one. Until it has come, the drives hold the arms and wait.
  std::uint64_t guard = 0;
  double rail_m = 0.0;
  std::array<Joints, 2> q_rad = {};
  std::uint8_t ends = 0;  ///< the session is over
};

/// What the operator's desk, or a stop in a hand, says.
struct WatchFrame {
  std::uint64_t beat = 0;
  std::uint8_t stop = 0;
};

/// What the guard lets one arm do, as safety::Verdict.
struct DrivenArm {
  Joints torque_nm;
  std::uint8_t brake = 0, action = 0, cause = 0, latched = 0;
};
/// What the guard lets both arms do.
struct DriveFrame {
  std::uint64_t answers_tick = 0;
  std::uint64_t armed = 0;  ///< number of the process that wrote this; 0: there was none yet
  std::uint64_t guard = 0;  ///< which guard of the session it is
  double rail_m = 0.0;
  std::array<DrivenArm, 2> arms = {};
};

template <typename... Frame>
inline constexpr bool are_copyable = (std::is_trivially_copyable_v<Frame> && ...);
static_assert(are_copyable<SensorFrame, StandFrame, ProposalFrame, DriveFrame, WatchFrame>);

[[nodiscard]] SensorFrame to_frame(const robot::RobotReading& reading) noexcept;
[[nodiscard]] StandFrame to_frame(const robot::ReadyPose& pose, std::uint64_t number) noexcept;
[[nodiscard]] ProposalFrame to_frame(const safety::RobotProposal& proposal,
                                     std::uint64_t answers_tick, bool stop_asked) noexcept;
[[nodiscard]] DriveFrame to_frame(const safety::RobotVerdict& verdict,
                                  std::uint64_t answers_tick) noexcept;

/// Whatever the bytes are, no index leaves its array: a count of joints that cannot be is taken as
/// none, an enumerator that does not exist stays one that the guard refuses.
[[nodiscard]] robot::RobotReading from_frame(const SensorFrame& frame) noexcept;
[[nodiscard]] robot::ReadyPose from_frame(const StandFrame& frame) noexcept;
[[nodiscard]] safety::RobotProposal from_frame(const ProposalFrame& frame) noexcept;
[[nodiscard]] safety::RobotVerdict from_frame(const DriveFrame& frame) noexcept;

/// Cyclic redundancy check of some bytes, CRC-32 of IEEE 802.3.
[[nodiscard]] std::uint32_t crc_of(const std::byte* bytes, std::size_t size) noexcept;

}  // namespace tuina::link::wire
