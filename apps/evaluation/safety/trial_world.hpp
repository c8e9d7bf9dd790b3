// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "apps/evaluation/safety/trial.hpp"
#include "tuina/sim/robot/plant.hpp"

namespace tuina::app {

/// What a trial begins with: only as much as its own stage needs, or all of a whole one.
[[nodiscard]] Stage first_stage(const TrialPlan& plan);

/// The true skin around the place, with all of a trial's faults that lie in the tissue.
[[nodiscard]] sim::BackContact skin_of(const TrialPlan& plan);

/// The true robot, where the first stage begins.
[[nodiscard]] Result<std::unique_ptr<sim::Plant>> plant_of(const TrialPlan& plan,
                                                           sim::BackContact& skin, Random& random);

}  // namespace tuina::app
