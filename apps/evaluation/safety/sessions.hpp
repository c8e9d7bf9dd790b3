// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "apps/evaluation/safety/trial.hpp"
#include "tuina/core/progress.hpp"
#include "tuina/session/config.hpp"

namespace tuina::app {

/// One fault of a session that is more than one arm on one place: what became of it, in words, and
/// every promise that it broke.
struct SessionCell {
  int number = 0;  ///< in the list of faults of docs/safety_campaign.md
  std::string name, state, person;
  std::string found = {};
  std::vector<std::string> broken = {};
  [[nodiscard]] bool holds() const { return broken.empty(); }
};

/// Scans with each fault of camera, motor and view: refused, or no acupoint is farther off than 15
/// mm; the laser is dark in the end, and 250 ms after a camera or a motor has fallen silent.
[[nodiscard]] Result<std::vector<SessionCell>> run_scan_cells(std::uint64_t seed,
                                                              const session::Config& config,
                                                              const Progress& progress);

/// Sessions that are asked to stop in each phase of an arm (contact over in 600 ms, 2 N over what
/// was pressed), people who have moved by 15 mm since the scan, and the scan of somebody else:
/// found at the first touch, with no more than the zone's trip.
[[nodiscard]] Result<std::vector<SessionCell>> run_session_cells(std::uint64_t seed,
                                                                 const session::Config& config,
                                                                 const Progress& progress);

/// A whole session of twenty minutes without a fault, by the true force.
struct CleanSession {
  std::string person;
  double massage_s = 0.0, max_force_n = 0.0;
  std::vector<std::string> stops = {};
};
[[nodiscard]] Result<CleanSession> run_clean_session(std::uint64_t seed,
                                                     const session::Config& config);

/// A person who breathes up to 12 mm deep at 0.5 Hz under ten seconds of pressing and, besides,
/// coughs or shifts by up to 10 mm, or does not.
struct PersonRun {
  std::string does;  ///< breathes, coughs, shifts
  TrialPlan plan;
  TrialOutcome outcome;
};
/// Not yet run.
[[nodiscard]] PersonRun draw_person(const std::vector<Site>& sites, std::uint64_t seed);

}  // namespace tuina::app
