// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "tuina/core/acupoint.hpp"
#include "tuina/core/arm.hpp"
#include "tuina/core/contact.hpp"
#include "tuina/core/language.hpp"
#include "tuina/core/sentence.hpp"
#include "tuina/core/surface.hpp"
#include "tuina/telemetry/page.hpp"

namespace tuina::telemetry {

/// A point that was found on the person; `error_m` is its distance to the truth, known only in
/// simulation.
struct FoundAcupoint {
  Acupoint acupoint = {};
  std::optional<double> error_m = {};
};

/// A path of the plan, and which arm carried it out when, in session time.
struct PerformedPath {
  Arm arm = Arm::left;
  double begin_s = 0.0;
  ContactPath path = {};
  std::optional<double> end_s = {};  ///< time at which the arm had left it; none: not known
  std::string contact_fault = {};  ///< reason why it was not carried out as planned; empty: it was
  double programme_n = 0.0;        ///< largest force that the programme asks for
  Sentence lowered_by = {};        ///< what bears less than that; empty: nothing
  double ordered_n = 0.0;          ///< largest force of the plan
  double given_n = 0.0;            ///< largest of a press or a tap, mean of what slides
  Sentence why = {};               ///< reason why that is not what was ordered; empty: it is

  [[nodiscard]] double ended_s() const { return end_s.value_or(begin_s + path.duration_s()); }
};

/// One row of trace.csv. Rows of the two arms may be interleaved; each arm's times rise.
struct TraceRow {
  /// Of what is known only in simulation.
  static constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  double time_s = 0.0;
  Arm arm = Arm::left;
  std::optional<Technique> technique = {};  ///< none while the arm travels or rests
  double target_n = 0.0;
  double true_force_n = unknown;
  double measured_force_n = 0.0;  ///< the wrist sensor's
  double depth_m = unknown;
  Vector3 tool_in_couch = Vector3::Zero();
};

/// What was felt at one place; `truth` is known only in simulation. Of several for one name the
/// last is drawn.
struct FeltTissue {
  std::string name = {};  ///< name of the acupoint
  Vector3 at_in_couch = Vector3::Zero();
  TissueEstimate estimate = {};
  std::optional<TangentTissue> truth = {};
  std::string tissue_class =
      {};  ///< "bone", "hard muscle", "soft muscle"; empty when not classified
  double class_probability = 0.0;
  double stiffness_n_per_mm = 0.0;  ///< tangent stiffness at `ReportData::stiffness_force_n`
  double stiffness_ci95_n_per_mm = 0.0;
  bool mapped = false;  ///< the press follows the law, so it counts for the map
};

/// Between the places that were pressed: the stiffness and the standard deviation of its logarithm.
struct MappedStiffness {
  double n_per_mm = 0.0;
  double log_sd = 0.0;
};

/// One place pressed at the beginning of a session and again at its end.
struct StiffnessChange {
  std::string name = {};  ///< name of the acupoint
  double before_n_per_mm = 0.0;
  double after_n_per_mm = 0.0;
  double detectable = 0.0;  ///< the smallest relative change that can be told at 95 %
  bool detected = false;
  double change = 0.0;  ///< the relative change
};

/// Probabilities that the presses leave, by the people of [thesis] Table 6-2.
struct BodyCondition {
  double slim = 0.0, medium = 0.0, hefty = 0.0;
  double female = 0.0;
};

/// One thing that the tissue decided; the rules are described in docs/tissue.md.
struct SteeringDecision {
  double time_s = 0.0;
  Arm arm = Arm::left;
  std::string path = {};  ///< its name
  std::string rule = {};  ///< "A2"
  std::string reason = {};
  std::string key = {};  ///< of the reason, for who says it in another language
  double from_n = 0.0;
  double to_n = 0.0;
};

/// Between surfaces: of the two arms, and of the nearer arm and the person, its last link with the
/// tool left out because that is meant to touch; and of the nearer arm and the couch or the robot's
/// own body. Infinite where it is not known.
struct ArmDistance {
  double time_s = 0.0;
  double apart_m = 0.0;
  double to_person_m = std::numeric_limits<double>::infinity();  ///< known only in simulation
  double to_couch_m = std::numeric_limits<double>::infinity();
  double to_body_m = std::numeric_limits<double>::infinity();
};

/// One link of an arm as the solid that is kept clear of everything: a rod with round ends.
struct ArmLink {
  Vector3 from_in_couch = Vector3::Zero();
  Vector3 to_in_couch = Vector3::Zero();
  double radius_m = 0.0;
};

/// Both arms at one moment.
struct ArmsPose {
  double time_s = 0.0;
  PerArm<std::vector<ArmLink>> links = {};
};

/// Errors of the TRUE contact force (target minus true), over all contact of one technique.
struct TechniqueForce {
  Technique technique = Technique::press;
  double rmse_n = 0.0;
  double peak_n = 0.0;
};

/// The guard has stopped an arm, as the report tells it.
struct Stop {
  double time_s = 0.0;
  Sentence cause = {};
};

/// Everything that the report of one session shows. Places are in `couch`, times in session time.
/// Text may hold anything; the page escapes it.
struct ReportData {
  std::string person = {};  ///< "phantom:medium", "ds01"
  BodyPosture position = BodyPosture::sitting;
  std::string programme = {};
  std::uint64_t seed = 0;
  bool simulated = true;
  double duration_s = 0.0;
  PointCloud scan_in_couch = {};
  std::vector<FoundAcupoint> acupoints = {};
  std::vector<PerformedPath> paths = {};
  std::vector<TraceRow> trace = {};
  double force_rmse_n = 0.0;                ///< of the force error over all contacts; 0 without any
  std::vector<TechniqueForce> forces = {};  ///< one for each technique that was used
  std::vector<FeltTissue> tissue = {};
  double stiffness_force_n = 10.0;
  /// Nothing where no press was near enough. Empty: there is no map.
  std::function<std::optional<MappedStiffness>(const Vector3&)> stiffness_at = {};
  std::vector<StiffnessChange> changes = {};
  std::optional<BodyCondition> condition = {};
  std::vector<SteeringDecision> decisions = {};
  std::vector<ArmDistance> distances = {};
  double stopping_distance_m = 0.0;  ///< arms nearer than this stop
  std::vector<ArmsPose> poses = {};  ///< ordered by time; a picture takes the nearest
  std::vector<Stop> stops = {};
  std::vector<double> rescans_s =
      {};  ///< times at which the person had moved and was scanned again
  std::vector<Sentence> left_out = {};    ///< paths of the programme that the plan has not, and why
  std::vector<Sentence> plan_notes = {};  ///< what was lowered, bent or cut, and why
  std::vector<KeyNumber> numbers = {};    ///< besides those that the page counts itself
  std::string config_toml = {};           ///< the whole effective configuration
  std::string version = {};
  Language language = {};  ///< in which the report is said
};

}  // namespace tuina::telemetry
