// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "tuina/core/acupoint.hpp"
#include "tuina/core/result.hpp"
#include "tuina/record/session_file.hpp"

namespace tuina::history {

/// What was felt at one place in one session: the half widths hold the truth in 95 % of cases.
struct VisitTissue {
  std::string name;
  double alpha_n = 0.0, alpha_ci95_n = 0.0;
  double beta_per_m = 0.0, beta_ci95_per_m = 0.0;
  double stiffness_n_per_mm = 0.0, stiffness_ci95_n_per_mm = 0.0;
  std::int64_t presses = 0;
  bool converged = false;
};

/// One session of a person, as the history keeps it. The folder of the session holds the whole of
/// it.
struct Visit {
  std::string id;
  std::string who;
  std::string began;  ///< "2026-11-22T14:03:05Z"
  std::string folder;
  bool ended = false;  ///< without it the session was cut short before its record was written
  std::string position, programme, robot, realism, version;
  double duration_s = 0.0;
  double force_rmse_n = 0.0, force_peak_n = 0.0;
  std::int64_t softer = 0, firmer = 0;  ///< wishes of the person during the session
  std::int64_t stops = 0;
  std::string stop_cause;  ///< of the first stop
  std::string consent_by;
  std::string said;  ///< by hand, `record::parse_said`; empty: nothing
  /// Factor on every force as the wishes have left it; NaN where it was not told.
  double intensity = std::numeric_limits<double>::quiet_NaN();
  std::vector<Acupoint> acupoints;  ///< without normals
  std::vector<VisitTissue> tissue;
};

/// What the record of a session tells of it. `file.visit` is there.
[[nodiscard]] Visit visit_of(const record::SessionFile& file, const std::filesystem::path& folder);

/// The session in a folder. Fails with file and reason.
[[nodiscard]] Result<record::SessionFile> read_session_of(const std::filesystem::path& folder);

/// Refused: a folder that holds the session of somebody, whose history counts on it.
[[nodiscard]] Result<void> is_free(const std::filesystem::path& folder);

/// Whether the folder of a visit still holds that very session. Fails with the reason: it is gone,
/// cannot be read, or holds another session by now.
[[nodiscard]] Result<void> still_in_its_folder(const Visit& visit);

/// Names of people: 1 to 40 letters, digits, `-` and `_`. Refused otherwise.
[[nodiscard]] Result<void> check_name(const std::string& who);

}  // namespace tuina::history
