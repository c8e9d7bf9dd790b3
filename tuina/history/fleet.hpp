// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "tuina/core/arm.hpp"
#include "tuina/history/database.hpp"
#include "tuina/record/session_file.hpp"

/// Robots of a practice and what they did. It says nothing of the people, so that who mends robots
/// may read it.
namespace tuina::history {

/// A robot, as it last told of itself.
struct Machine {
  std::string name;        ///< of this one: "room-2"
  std::string model;       ///< "thesis"
  std::string version;     ///< of tuina
  std::string calibrated;  ///< "2026-11-22T14:03:05Z"; empty: no calibration was named
  std::string seen;        ///< likewise: when it told this
  std::string doing;       ///< "idle", "massage", ...
};

/// One session of a robot. What is not known is NaN.
struct MachineSession {
  static constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

  std::string id;
  std::string machine;
  std::string began;
  bool ended = false;  ///< without it the session was cut short before its record was written
  double duration_s = unknown;
  std::int64_t stops = 0;
  std::string stop_cause = {};    ///< of the first stop
  double force_rmse_n = unknown;  ///< target minus force
  double force_peak_n = unknown;
  double scan_rms_m = unknown;     ///< of the scan from the true surface, known in simulation only
  double uncertainty_m = unknown;  ///< of the acupoints, in the mean
  PerArm<double> zero_n = {unknown, unknown};  ///< what a wrist feels in the mean in the air
};

/// What the record of a session tells of its robot.
[[nodiscard]] MachineSession machine_session_of(const record::SessionFile& file,
                                                std::span<const telemetry::TraceRow> trace);

/// @{
/// Enters what a robot tells. It may come twice and late: what is newer stays. Fails as the
/// database does.
[[nodiscard]] Result<void> enter(Database& database, const Machine& machine);
[[nodiscard]] Result<void> enter(Database& database, const MachineSession& session);
/// @}

/// A robot and its sessions, in the order of time.
struct MachineHistory {
  Machine machine;
  std::vector<MachineSession> sessions;
};
/// All robots, in the order of their names. Fails as the database does.
[[nodiscard]] Result<std::vector<MachineHistory>> fleet_of(Database& database);

}  // namespace tuina::history
