// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "apps/evaluation/safety/campaign.hpp"

namespace tuina::app {

/// The pairs of faults that may come together, not yet run.
[[nodiscard]] std::vector<FaultPair> fault_pairs();

/// Every order and distance of a pair at every place.
[[nodiscard]] std::vector<TrialPlan> plans_of(const FaultPair& pair, const std::vector<Site>& sites,
                                              const CampaignOrder& order);

/// A random fault at a random moment of a random contact.
[[nodiscard]] TrialPlan random_plan(const std::vector<Site>& sites, std::uint64_t seed);

}  // namespace tuina::app
