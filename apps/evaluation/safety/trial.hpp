// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "apps/evaluation/safety/fault_table.hpp"
#include "apps/evaluation/safety/site.hpp"

namespace tuina::app {

/// One fault of a trial.
struct Onset {
  const FaultClass* fault = nullptr;
  double later_s = 0.0;   ///< after the first
  double severity = 1.0;  ///< share of the size in the table
};

/// One arm on one place, and what goes wrong. The arm comes from the air, presses and, where it is
/// told so, leaves again; the other arm holds its parking place. Masses, friction, tissue and skin
/// are believed wrong as in a session, drawn by the seed.
struct TrialPlan {
  const Site* site = nullptr;
  Stage stage = Stage::contact;  ///< in which the first fault comes
  double into_stage_s = 0.0;     ///< and when
  std::vector<Onset> onsets = {};
  bool whole = false;      ///< from the travel to the way out; else only what the stage needs
  double press_s = 1.5;    ///< of a whole one
  double watched_s = 2.0;  ///< after the onset
  double alpha_scale = 1.0, beta_scale = 1.0;  ///< of the true tissue
  double friction_scale = 1.0;                 ///< of the true arm
  /// What moves or pushes is turned by so much from the normal of the skin towards the head.
  double tilt_rad = 0.0;
  int joint = -1;  ///< to which a fault of joints comes; -1: one of the first four, by the seed
  /// -1 to 1: elbow turned from the planned posture, as far as a session tolerates.
  double elbow = 0.0;
  std::uint64_t seed = 1;
  bool traced = false;
};

/// When in a stage a fault of the table comes: at rest, at full speed, a few millimetres above the
/// skin, under the full force, and with the tool still on the skin.
[[nodiscard]] double usual_time_s(Stage stage);

struct TrialSample {
  double since_onset_s, set_n, true_force_n;
};

/// What became of it, by the truth. Times count from the onset.
struct TrialOutcome {
  bool tried = false;          ///< false: the arm was stopped before its fault came
  double set_force_n = 0.0;    ///< set when the fault came
  double worst_force_n = 0.0;  ///< true force from then on
  double over_seldom_s = 0.0;  ///< time above `seldom_n`
  /// Until the guard, the controller or the drives did something about it; NaN: never.
  double first_action_ms = std::numeric_limits<double>::quiet_NaN();
  double released_ms = 0.0;  ///< last contact
  double further_m = 0.0;    ///< inward, since the onset or since contact was lost
  /// Between the arms, and from couch and robot's body.
  double apart_m = std::numeric_limits<double>::infinity();
  double rmse_n = 0.0;
  bool stopped = false;   ///< for good, or by a controller that let go to scan again
  bool by_guard = false;  ///< for good
  std::string cause = "none";
  std::string end = "at work";
  double end_force_n = 0.0, end_m_per_s = 0.0;
  std::vector<TrialSample> trace;
};

[[nodiscard]] Result<TrialOutcome> run_trial(const TrialPlan& plan);

}  // namespace tuina::app
