// SPDX-License-Identifier: Apache-2.0
#pragma once

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
  struct Options {
    std::vector<robot::Obstacle> obstacles = {};  ///< couch and the robot's own body
    double max_set_force_n = std::numeric_limits<double>::infinity();  ///< in every zone
    ZoneField field = {};  ///< the person's back, all beside it denied; empty where nobody scanned
    bool bench = false;    ///< tissue in a laboratory instead of a person
  };

  RobotGuard(const PerArm<robot::ArmModel>& models, const Options& options);

  [[nodiscard]] RobotVerdict check(const robot::RobotReading& reading,
                                   const RobotProposal& proposal) noexcept;

  /// Both arms leave the body at once, whatever the controller wants.
  void stop(Cause cause) noexcept;
  /// Somebody has told the controller to stop; an arm that still presses 0.3 s later leaves.
  void expect_stop() noexcept;

  /// Distance between the surfaces of the arms at the last reading.
  [[nodiscard]] double arm_distance_m() const noexcept { return separation_.apart_m(); }

 private:
  struct Side {
    Side(const robot::ArmModel& model, const Options& options) noexcept;
    ArmWatch watch;
    Guard guard;
    JointVector applied_nm = {};
  };

  void keep_apart(const PerArm<Observation>& seen, const RobotProposal& proposal) noexcept;

  ZoneField field_;
  ArmSeparation separation_;
  PerArm<Side> sides_;
  bool started_ = false;
  double rail_m_ = 0.0;
  int asked_ticks_ = 0;
};

}  // namespace tuina::safety
