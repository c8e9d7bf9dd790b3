// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "tuina/robot/obstacle.hpp"
#include "tuina/safety/arm_separation.hpp"
#include "tuina/safety/arm_watch.hpp"
#include "tuina/safety/guard.hpp"
#include "tuina/safety/zone_field.hpp"

namespace tuina::safety {

/// What a controller would like a whole robot to do in the next millisecond.
struct RobotProposal {
  PerArm<Proposal> arms;
  double rail_m = 0.0;  ///< where the linear base should be
};

/// Who may stop the robot beside its controller, and must show all the time that they are there.
enum class Watcher : std::uint8_t { operating, hand_stop };
inline constexpr std::size_t watchers = 2;

/// Heartbeat of a watcher: a number that changes as long as they are well, and whether to stop.
struct Heartbeat {
  std::uint64_t beat = 0;
  bool stop = false;
};

/// What the robot does, and what was thought of the proposal.
struct RobotVerdict {
  robot::RobotCommand command;
  PerArm<Verdict> arms;
};

/// The last to decide what a two-armed robot does. It looks at the raw readings with models of its
/// own, guards each arm, keeps the arms apart from each other, from the couch and from the robot's
/// body, and the linear base where it stood. Real-time: no heap, no exceptions after construction.
class RobotGuard {
 public:
  /// The surroundings and limits of both arms.
  struct Options {
    std::vector<robot::Obstacle> obstacles = {};  ///< couch and the robot's own body
    double max_set_force_n = std::numeric_limits<double>::infinity();  ///< in every zone
    ZoneField field = {};  ///< the person's back, all beside it denied; empty where nobody scanned
    bool bench = false;    ///< tissue in a laboratory instead of a person
    bool leased = false;   ///< arms leave when a watcher is silent for half a second
  };

  /// Has copies of both models.
  RobotGuard(const PerArm<robot::ArmModel>& models, const Options& options);

  /// Judges one millisecond of both arms; must be called in each.
  [[nodiscard]] RobotVerdict check(const robot::RobotReading& reading,
                                   const RobotProposal& proposal) noexcept;

  /// What a watcher said last; the same once more is silence. A stop makes both arms leave, leased
  /// or not.
  void hear(Watcher watcher, const Heartbeat& word) noexcept;
  /// Both arms leave the body at once, whatever the controller wants.
  void stop(Cause cause) noexcept;
  /// Somebody has told the controller to stop; an arm that presses 0.3 s later, or ever after,
  /// leaves.
  void expect_stop() noexcept;

  /// True while a living sensor feels a body under one of the tools.
  [[nodiscard]] bool pressed() const noexcept;
  /// Distance between the surfaces of the arms at the last reading.
  [[nodiscard]] double arm_distance_m() const noexcept { return separation_.apart_m(); }

 private:
  struct Side {
    Side(const robot::ArmModel& model, const Options& options) noexcept;
    ArmWatch watch;
    Guard guard;
    /// Torques of the last commands, in a ring whose size is a power of two.
    std::array<JointVector, 16> sent_nm = {};
    std::size_t newest = 0;
    void note_sent(const JointVector& torque_nm) noexcept;
    /// The torques sent so many commands ago. Of a command older than are kept nobody knows: those
    /// of the oldest, so that an arm which obeys as late as that is not taken for a healthy one.
    [[nodiscard]] JointVector sent_ago(int commands) const noexcept;
  };

  void keep_apart(const PerArm<Observation>& seen, const RobotProposal& proposal) noexcept;

  ZoneField field_;
  ArmSeparation separation_;
  PerArm<Side> sides_;
  bool started_ = false, leased_ = false;
  std::array<std::uint64_t, watchers> beats_ = {};
  std::array<int, watchers> silent_ticks_ = {};
  double rail_m_ = 0.0;
  int patience_ticks_ = -1;  ///< that are left to the controller to let go; -1: nobody has asked
};

}  // namespace tuina::safety
