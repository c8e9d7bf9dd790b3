// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <string>

#include "tuina/history/visit.hpp"

namespace tuina::test {

/// A session of anna with one point and one place.
inline history::Visit visit_at(const std::string& id, const std::string& began,
                               double stiffness_n_per_mm) {
  history::Visit visit{.id = id,
                       .who = "anna",
                       .began = began,
                       .folder = "/nowhere/" + id,
                       .ended = true,
                       .position = "prone",
                       .programme = "relax",
                       .robot = "thesis",
                       .realism = "usual",
                       .version = "0.1",
                       .duration_s = 301.25,
                       .force_rmse_n = 0.25,
                       .force_peak_n = 22.4,
                       .softer = 2,
                       .firmer = 0,
                       .stops = 1,
                       .stop_cause = "it's \"over\"; -- DROP TABLE session",
                       .consent_by = "herself",
                       .acupoints = {},
                       .tissue = {}};
  visit.acupoints = {{"GV4", Vector3(0.01, -0.02, 0.3), Vector3::Zero(), 8e-3}};
  visit.tissue = {{.name = "GV4",
                   .alpha_n = 500.0,
                   .alpha_ci95_n = std::numeric_limits<double>::infinity(),
                   .beta_per_m = 20.0,
                   .beta_ci95_per_m = 1.5,
                   .stiffness_n_per_mm = stiffness_n_per_mm,
                   .stiffness_ci95_n_per_mm = 0.02,
                   .presses = 3,
                   .converged = true}};
  return visit;
}

}  // namespace tuina::test
