// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tuina/core/acupoint.hpp"
#include "tuina/core/arm.hpp"
#include "tuina/core/contact.hpp"
#include "tuina/core/surface.hpp"

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
  std::optional<double> end_s = {};  ///< when the arm had left it, if that is known
  std::string trouble = {};          ///< why it was not carried out as planned; empty when it was

  [[nodiscard]] double ended_s() const { return end_s.value_or(begin_s + path.duration_s()); }
};

/// One row of trace.csv. Rows of the two arms may be interleaved; each arm's times rise.
struct TraceRow {
  double time_s = 0.0;
  Arm arm = Arm::left;
  std::optional<Technique> technique = {};  ///< none while the arm travels or rests
  double target_n = 0.0;
  double true_force_n = 0.0;      ///< the simulation's
  double measured_force_n = 0.0;  ///< the wrist sensor's
  double depth_m = 0.0;
  Vector3 tool_in_couch = Vector3::Zero();
};

/// What was felt at one place; `truth` is known only in simulation. Of several for one name the
/// last is drawn.
struct FeltTissue {
  std::string name = {};  ///< of the acupoint
  Vector3 at_in_couch = Vector3::Zero();
  TissueEstimate estimate = {};
  std::optional<TangentTissue> truth = {};
  std::string tissue_class =
      {};  ///< "bone", "hard muscle", "soft muscle"; empty when not classified
  double class_probability = 0.0;
};

/// Errors of the TRUE contact force (target minus true), over all contact of one technique.
struct TechniqueForce {
  Technique technique = Technique::press;
  double rmse_n = 0.0;
  double peak_n = 0.0;
};

struct Stop {
  double time_s = 0.0;
  std::string cause = {};  ///< a sentence for people
};

/// A figure worth a tile on the page: {"scan error", "0.42", "mm", "RMS to the true surface"}.
struct KeyNumber {
  std::string label = {};
  std::string value = {};
  std::string unit = {};
  std::string remark = {};
};

/// Everything that the report of one session shows. Places are in `couch`, times in session time.
/// Text may hold anything; the page escapes it.
struct ReportData {
  std::string person = {};  ///< "phantom:medium", "ds01"
  Position position = Position::sitting;
  std::string programme = {};
  std::uint64_t seed = 0;
  bool simulated = true;
  double duration_s = 0.0;
  PointCloud scan_in_couch = {};
  std::vector<FoundAcupoint> acupoints = {};
  std::vector<PerformedPath> paths = {};
  std::vector<TraceRow> trace = {};
  std::vector<TechniqueForce> forces = {};  ///< only of techniques that were used
  std::vector<FeltTissue> tissue = {};
  std::vector<Stop> stops = {};
  std::vector<KeyNumber> numbers = {};  ///< besides those that the page counts itself
  std::string config_toml = {};         ///< the whole effective configuration
  std::string version = {};
};

}  // namespace tuina::telemetry
