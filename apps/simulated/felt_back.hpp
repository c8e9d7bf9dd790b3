// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "apps/simulated/simulated_session.hpp"
#include "tuina/tissue/body_condition.hpp"
#include "tuina/tissue/classification.hpp"
#include "tuina/tissue/stiffness_map.hpp"

namespace tuina::app {

/// One pressed acupoint: what was felt there, what is there, and what kind of tissue that makes it.
struct FeltPoint {
  const massage::PlannedPath* planned = nullptr;  ///< path in the session's plan
  TissueEstimate estimate;
  TangentTissue truth;
  tissue::Classification classified;
  tissue::FeltPlace place;  ///< its stiffness under session::reference_force_n
  bool mapped = false;      ///< the press follows the law, so it counts for the map
};

/// All that the presses of a session tell about a person.
struct FeltBack {
  std::vector<FeltPoint> points;              ///< in the order in which they were pressed
  tissue::StiffnessMap map{{}};               ///< stiffness map of the last press at each place
  std::vector<tissue::ComparedVisits> twice;  ///< places that were pressed twice: before and after
  tissue::BodyCondition condition;
  int condition_presses = 0;  ///< presses that the condition rests on
};

/// Points into `result`, which has to outlive it.
[[nodiscard]] FeltBack felt_back(const SessionResult& result, const tissue::BodyFacts& facts);

}  // namespace tuina::app
