// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tuina/body/acupoints.hpp"
#include "tuina/core/result.hpp"
#include "tuina/record/late_ticks.hpp"
#include "tuina/robot/obstacle.hpp"
#include "tuina/session/earlier/by_hand.hpp"
#include "tuina/session/earlier/known_tissue.hpp"
#include "tuina/session/force_errors.hpp"
#include "tuina/session/live_command.hpp"
#include "tuina/telemetry/report/report_data.hpp"
#include "tuina/tissue/body_condition.hpp"

namespace tuina::record {

/// What `tuina massage` leaves in the folder of a session: all of it, session.json last.
inline constexpr std::array files_of_session = {
    "config.toml", "consent.toml",  "scan.ply", "acupoints.json", "plan.json",    "trace.csv",
    "joints.csv",  "distances.csv", "back.svg", "report.html",    "session.mcap", "session.json"};

/// What somebody at a terminal orders of a session: names and files.
struct SessionOrder {
  std::string person = "phantom:medium";
  std::optional<BodyPosture> position;
  std::string programme = "relax";
  std::string robot = "thesis";  ///< a shipped robot or the file of its table
  body::Method method = body::Method::surface;
  std::string atlas;             ///< a file or a labelled body; empty: the shipped one
  std::string no_go;             ///< a file with what the therapist rules out; empty: nothing
  std::string consent;           ///< a file with answers; empty: the simulated person answers
  std::string robot_pose;        ///< a file of `calibrate --robot`; empty: as good a one
  std::string calibration = {};  ///< of a real scanner; a record has its content
  bool adaptive = true;
  double intensity = 1.0;  ///< on every force, as the session begins
  tissue::BodyFacts facts;
  /// By hand, in this session or remembered of one before: places ruled out, points put right.
  std::optional<session::Said> said = {};
  std::vector<body::PalpatedPoint> fixed = {};  ///< on this scan; in a record they stand in `said`
  /// What an earlier session of this person has felt.
  std::optional<session::KnownTissue> known = {};
  bool keys = false;  ///< live commands from standard input
  /// Commands as they were given in a session before, and when; instead of keys.
  std::vector<std::pair<double, session::LiveCommand>> commands;
  /// Seconds of the simulation in one of the clock; nothing: as fast as it can be computed.
  std::optional<double> pace = {};
  bool processes = false;   ///< guard and robot are processes of their own
  std::string link = {};    ///< name of the memory that they share; empty: one of this process
  std::string device = {};  ///< a device file; empty: all devices are simulated in this program
};

/// Whose session it was, when there is a history of people.
struct VisitLabel {
  std::string who;    ///< a pseudonym
  std::string id;     ///< of the session, unlike any other
  std::string began;  ///< "2026-11-22T14:03:05Z"
};

/// A path as it was performed; what is true is known only in simulation.
struct PerformedEntry {
  std::string name;
  std::size_t path = 0;  ///< its place in the plan
  Arm arm = Arm::left;
  double begin_s = 0.0;
  double end_s = 0.0;
  std::string contact_fault;  ///< "none": it was carried out as planned
  double programme_n = 0.0;   ///< largest force that the programme asks for
  Sentence lowered_by;        ///< what bears less than that; empty: nothing
  double ordered_n = 0.0;     ///< largest force of the plan, which regards what is borne
  double given_n = 0.0;       ///< largest force
  /// Mean of what slides, while all of its force was asked for; NaN of a press or a tap.
  double mean_n = std::numeric_limits<double>::quiet_NaN();
  double true_peak_n = 0.0;
  Sentence why;  ///< where the given force is more than 5 % off the ordered one
  double true_over_trip_n = -std::numeric_limits<double>::infinity();
  std::optional<double> tool_to_acupoint_m;  ///< known of a press of an acupoint

  static constexpr double max_off_share = 0.05;  ///< of a force that is as ordered
  /// Force to be held against the order: of what slides the mean, since it swings about that.
  [[nodiscard]] double compared_n() const noexcept { return std::isnan(mean_n) ? given_n : mean_n; }
  [[nodiscard]] bool as_ordered() const noexcept {
    return std::abs(compared_n() - ordered_n) <= max_off_share * ordered_n;
  }
  /// What a reader is told of it; of a force that is as ordered nothing.
  [[nodiscard]] Sentence told_why() const { return as_ordered() ? Sentence{} : why; }
};

/// Arms at the other ends of a network, and what came over it.
struct DeviceRecord {
  /// Cycles of one arm, and datagrams that did not come as they should.
  struct Traffic {
    std::uint64_t cycles = 0, lost = 0, late = 0, unheard = 0, rejected = 0;
    std::string wrist = {};  ///< what came from a wrist sensor of its own, and how it has failed
  };
  std::string arms;  ///< kind and addresses
  std::string pace;
  static constexpr const char* simulated_scanner = "simulated";
  std::string scanner = simulated_scanner;
  PerArm<Traffic> traffic;
  std::uint64_t truth_missed = 0;  ///< milliseconds whose truth was told too late to be known
};

/// The numbers of a session as session.json holds them: all that the report shows of it but for
/// scan, plan and the tables. A distance that is not known is infinite.
struct SessionFile {
  /// The scan in numbers.
  struct Scan {
    int profiles = 0;
    std::size_t points = 0;
    double sweep_s = 0.0;
    double rms_error_m = 0.0;
    double compute_ms = 0.0;
  };
  /// The acupoints found, with errors where the truth is known.
  struct Acupoints {
    body::Method method = body::Method::surface;
    double compute_ms = 0.0;
    double mean_error_m = std::numeric_limits<double>::quiet_NaN();  ///< of the thesis' seven
    double max_error_m = std::numeric_limits<double>::quiet_NaN();
    std::vector<telemetry::FoundAcupoint> points;
  };
  /// The plan in numbers.
  struct Plan {
    double compute_ms = 0.0;
    std::size_t paths = 0;
    double duration_s = 0.0;
    bool reachable = false;
    double min_arm_distance_m = 0.0;
    robot::Clearances clear;
    std::vector<std::string> zones_touched;
    std::vector<Sentence> notes;
  };
  /// The massage in numbers: forces, distances and contacts.
  struct Massage {
    double duration_s = 0.0;
    double real_time_factor = 0.0;
    std::optional<Lateness> late;  ///< where the clock sets the pace
    double min_arm_distance_m = 0.0;
    robot::Clearances clear;
    /// Factor on every force as the wishes have left it; a version that did not tell wrote none.
    double intensity = std::numeric_limits<double>::quiet_NaN();
    double min_distance_to_person_m = std::numeric_limits<double>::infinity();
    session::ForceErrors force;
    std::vector<telemetry::TechniqueForce> techniques;  ///< of the techniques that were used
    std::vector<PerformedEntry> performed;
  };

  std::uint64_t seed = 1;
  std::string version;
  std::optional<VisitLabel> visit;
  std::string person;
  std::string realism = "ideal";  ///< of the simulated world
  BodyPosture position = BodyPosture::sitting;
  SessionOrder order;  ///< with the commands that were given
  Transform base_from_couch = Transform::Identity();
  Scan scan;
  Acupoints acupoints;
  Plan plan;
  Massage massage;
  std::string answered_by;        ///< who answered the health questions
  std::vector<double> rescans_s;  ///< times at which the person had moved and was scanned again
  std::vector<telemetry::SteeringDecision> decisions;
  std::vector<telemetry::FeltTissue> tissue;
  double stiffness_force_n = 0.0;  ///< force at which stiffness is compared
  std::vector<telemetry::StiffnessChange> changes;
  telemetry::BodyCondition condition;
  int condition_presses = 0;  ///< presses that the condition rests on
  std::vector<telemetry::Stop> stops;
  std::optional<DeviceRecord> devices;  ///< where the order names a device file

  /// Whether the person was, so that the truth is known.
  [[nodiscard]] bool simulated() const {
    return !devices || devices->scanner == DeviceRecord::simulated_scanner;
  }
};

/// The JSON object of session.json.
[[nodiscard]] std::string to_json(const SessionFile& file);

/// Refused, with the key and what stands there: what is missing or of another kind.
[[nodiscard]] Result<SessionFile> parse_session(std::string_view text, std::string_view name);

/// What was said by hand, as one line of JSON, and back.
[[nodiscard]] std::string to_json(const session::Said& said);
/// Fails with path of the field and value; `name` stands for the file.
[[nodiscard]] Result<session::Said> parse_said(std::string_view text, std::string_view name);

}  // namespace tuina::record
