// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tuina/core/result.hpp"

namespace tuina::app {

/// What is done to one of the three processes of a session while a tool presses.
enum class Blow : std::uint8_t {
  kill,
  stop,
  crash,
  no_memory,  ///< it gets no more
  disk_full,  ///< it writes no more into files
  hogs,       ///< two busy processes for each processor run beside it
};
[[nodiscard]] const char* name_of(Blow blow);
enum class Victim : std::uint8_t { controller, guard, machine };
[[nodiscard]] const char* name_of(Victim victim);

struct ProcessBlow {
  Victim victim;
  Blow blow;
};
/// All that are tried.
[[nodiscard]] const std::vector<ProcessBlow>& process_blows();

struct ProcessTrial {
  Victim victim = Victim::controller;
  Blow blow = Blow::kill;
  std::uint64_t seed = 1;
  bool real_pace = false;
};

/// What became of the person, from the truth of the process that simulates the robot.
struct ProcessOutcome {
  ProcessTrial trial;
  double before_n = 0.0;        ///< true force when it happened
  double max_force_n = 0.0;     ///< largest true force afterwards
  double released_ms = -1.0;    ///< until both tools had let go, in the robot's time; -1: never
  double first_action_ms = -1;  ///< until the guard acted; -1: never, or dead
  double left_n = 0.0;          ///< true force 1.5 s later
  /// Never more than 90 N; a guard that lives lets go in 600 ms when its controller is gone; a
  /// session that cannot write ends and says so.
  bool held = false;
};

/// A whole session in three processes, one of which takes a blow while a tool presses a phantom
/// with more than 8 N. Fails when the session never gets there.
[[nodiscard]] Result<ProcessOutcome> run_process_trial(const ProcessTrial& trial);

}  // namespace tuina::app
