// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <limits>
#include <map>
#include <optional>
#include <string>

#include "apps/simulated/session_preparation.hpp"
#include "apps/simulated/session_tables.hpp"
#include "tuina/body/acupoints.hpp"
#include "tuina/massage/programme.hpp"
#include "tuina/massage/zones.hpp"
#include "tuina/motion/ready_plan.hpp"
#include "tuina/scanner/sweep.hpp"
#include "tuina/session/config.hpp"
#include "tuina/session/consent.hpp"
#include "tuina/session/force_errors.hpp"
#include "tuina/session/massage_step.hpp"
#include "tuina/sim/person/person.hpp"

namespace tuina::app {

/// What only the simulation knows of one contact.
struct Touched {
  TangentTissue tissue;                        ///< where the force was highest
  Vector3 at_in_couch = Vector3::Zero();       ///< the skin there
  massage::Zone zone = massage::Zone::muscle;  ///< that it truly lies in
  double peak_n = 0.0;
  /// Largest force beyond what the true zone bears: beyond what may be asked for there, and beyond
  /// where an arm has to give way. Negative when it stayed below.
  double over_cap_n = -std::numeric_limits<double>::infinity();
  double over_trip_n = -std::numeric_limits<double>::infinity();
  massage::Zone over_cap_zone = massage::Zone::muscle;  ///< where `over_cap_n` was
};

/// All that a simulated session was and did, for its JSON, its files and its report.
struct SessionResult : Preparation {
  session::Consent consent;
  std::string consent_toml;  ///< as it was answered
  sim::Person person;

  std::vector<session::Performed> performed;
  std::vector<session::Decision> decisions;
  std::vector<std::pair<double, session::LiveCommand>> commands;  ///< when what was asked for
  std::vector<session::Stop> stops;
  std::vector<double> rescans_s;  ///< when the person had moved and a new scan was taken
  std::vector<Touched> touched;   ///< per performed path
  session::ForceErrors force;
  std::map<Technique, session::ForceErrors> techniques;
  std::vector<telemetry::TraceRow> trace;
  std::vector<JointRow> joints;  ///< twenty times a second
  double massage_s = 0.0;
  double compute_s = 0.0;  ///< of the massage
  [[nodiscard]] double real_time_factor() const { return massage_s / compute_s; }
  std::vector<telemetry::ArmDistance> distances;
  double min_arm_distance_m = 0.0;  ///< that the arms truly had, surface to surface
  robot::Clearances clear;          ///< likewise, from the couch and the robot's own body
  std::string device_fault;
};

/// From the tool's place at its hardest to the true acupoint, for a press of an acupoint; else
/// nothing.
[[nodiscard]] std::optional<double> tool_to_acupoint_m(const SessionResult& result,
                                                       std::size_t performed);
/// From the beginning of the scan to the first touch, computing included.
[[nodiscard]] double scan_to_touch_s(const SessionResult& result);

/// Scan, map, plan, massage: the whole method in the simulated world, with the errors in what the
/// session knows of it drawn by the seed.
[[nodiscard]] Result<SessionResult> run_simulated_session(const SessionOrder& order,
                                                          const session::Config& config,
                                                          const CommonOptions& common);

}  // namespace tuina::app
