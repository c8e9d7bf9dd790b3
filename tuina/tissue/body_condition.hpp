// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "tuina/tissue/classification.hpp"

namespace tuina::tissue {

/// Body condition from tissue estimates ([thesis] 6.3.2): slim people have larger alpha and beta,
/// hefty ones smaller. Only probabilities, since they rest on seven people, one of them a woman.
struct BodyCondition {
  double slim = 1.0 / 3.0, medium = 1.0 / 3.0, hefty = 1.0 / 3.0;  ///< sum to one
  double female = 0.5;
};

/// Facts known without touching the person.
struct BodyFacts {
  std::optional<double> mass_index;   ///< kg/m^2; slim about 19.5, medium 23, hefty 29
  std::optional<double> fat_percent;  ///< men: slim about 11, medium 17, hefty 24
};

/// Estimates from presses at known tissues of one person (`unknown` is skipped) and optional facts
/// as further evidence. Without either the prior is returned.
[[nodiscard]] BodyCondition find_body_condition(std::span<const KnownPress> presses,
                                                const BodyFacts& facts = {},
                                                std::span<const Subject> table = table_6_2());

}  // namespace tuina::tissue
