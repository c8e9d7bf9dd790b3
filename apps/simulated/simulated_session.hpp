// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/simulated/given_presses.hpp"
#include "apps/simulated/session_order.hpp"
#include "tuina/massage/zones.hpp"
#include "tuina/record/late_ticks.hpp"
#include "tuina/record/session_recorder.hpp"
#include "tuina/record/session_tables.hpp"
#include "tuina/session/force_errors.hpp"
#include "tuina/session/run.hpp"
#include "tuina/sim/person/person.hpp"

namespace tuina::app {

/// What only the simulation knows of one contact.
struct Touched {
  TangentTissue tissue;                        ///< first loading where the force was highest
  Vector3 at_in_couch = Vector3::Zero();       ///< the skin there
  massage::Zone zone = massage::Zone::muscle;  ///< the true zone there
  double peak_n = 0.0;
  HeldForce held = {};  ///< force while all of it was asked for
  /// Largest force beyond what the true zone bears: beyond what may be asked for there, and beyond
  /// where an arm has to give way. Negative when it stayed below.
  double over_cap_n = -std::numeric_limits<double>::infinity();
  double over_trip_n = -std::numeric_limits<double>::infinity();
  massage::Zone over_cap_zone = massage::Zone::muscle;  ///< zone of `over_cap_n`
};

/// What only the simulation knows of a session; of one with a real scanner, what its sensors said:
/// errors are not a number then, and forces and distances as they were measured.
struct SessionTruth {
  double scan_error_m = 0.0;              ///< RMS distance of the scan from the true surface
  std::vector<double> acupoint_errors_m;  ///< per point that was located
  std::vector<Touched> touched;           ///< per performed path
  /// Outside them: landing, on the way out, after a stop, and contacts whose path was given up.
  Touched unplanned;
  std::vector<GivenPress> presses;  ///< presses and taps, in the order of their ends
  session::ForceErrors force;
  std::map<Technique, session::ForceErrors> techniques;
  std::vector<telemetry::TraceRow> trace;
  std::vector<telemetry::ArmDistance> distances;
  double min_arm_distance_m = 0.0;  ///< surface to surface
  robot::Clearances clear;  ///< distances of the arms from the couch and the robot's own body
};

/// A session: what it says of itself, beside the truth or what was measured.
struct SessionResult {
  bool simulated = true;
  session::Session session;
  SessionTruth truth;
  sim::Person person;
  session::Consent consent;
  std::string consent_toml;              ///< answers as they were given
  std::string realism = "ideal";         ///< of the simulated world it happened in, or "real"
  std::vector<record::JointRow> joints;  ///< joints, twenty times a second
  std::uint64_t last_tick = 0;           ///< the last millisecond of the session
  /// Record that was asked for, not finished yet; else null.
  std::unique_ptr<record::SessionRecorder> recorder;
  std::optional<record::DeviceRecord> devices;
  std::optional<record::Lateness> late;  ///< where the clock of this machine sets the pace
  std::uint64_t untold_ms = 0;  ///< milliseconds that an attendant's channels were too slow for

  [[nodiscard]] double real_time_factor() const { return session.massage_s / session.compute_s; }
};

/// From the tool's place at its hardest to the true acupoint, for a press of an acupoint; else
/// nothing.
[[nodiscard]] std::optional<double> tool_to_acupoint_m(const SessionResult& result,
                                                       std::size_t performed);
/// From the beginning of the scan to the first touch, computing included.
[[nodiscard]] double scan_to_touch_s(const SessionResult& result);

/// Somebody who is there while a session runs, beside the terminal. What is empty is not asked.
struct Attendant {
  session::Observer* watches = nullptr;  ///< told through a relay, so it may be slow
  /// Told within the millisecond, which waits for it; for who answers by `commands` at once. Not
  /// for a session at real pace.
  session::Observer* waits = nullptr;
  /// Takes the messages of the record while they come, through a relay, so it may be slow.
  record::ChannelSink* channels = nullptr;
  std::function<std::optional<session::LiveCommand>(double time_s)> commands = {};
  std::function<session::Review(const motion::ReadyPlan&, const std::string& refused)> reviews = {};
  std::function<bool()> ends_scan = {};  ///< asked with every frame; true ends a scan
};

/// The session that an order asks for: in a simulated world, or with the scanner and the arms of
/// its device file where that names a scanner.
[[nodiscard]] Result<SessionResult> run_session(const SessionOrder& order,
                                                const session::Config& config,
                                                const CommonOptions& common,
                                                const std::filesystem::path& record_file,
                                                const Attendant& attendant);

/// `session::run` in a simulated world, with the truth written down beside it. With `record_file`
/// the session is recorded into it; one that fails after the massage has begun leaves its record.
[[nodiscard]] Result<SessionResult> run_simulated_session(
    const SessionOrder& order, const session::Config& config, const CommonOptions& common,
    const std::filesystem::path& record_file = {}, const Attendant& attendant = {});

}  // namespace tuina::app
