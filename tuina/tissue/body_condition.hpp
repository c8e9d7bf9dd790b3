// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "tuina/tissue/classification.hpp"

namespace tuina::tissue {

/// [thesis] 6.3.2 wants to tell body condition from the estimates: slim people have larger alpha
/// and beta, hefty ones smaller. Probabilities only, and with caution: seven people stand behind
/// them, one of them a woman.
struct BodyCondition {
  double slim = 1.0 / 3.0, medium = 1.0 / 3.0, hefty = 1.0 / 3.0;  ///< sum to one
  double female = 0.5;
};

/// What may be known of a person without touching them.
struct BodyFacts {
  std::optional<double> mass_index;   ///< kg/m^2; slim about 19.5, medium 23, hefty 29
  std::optional<double> fat_percent;  ///< of a man slim about 11, medium 17, hefty 24
};

/// From presses at known tissues of one person; presses at `unknown` are passed over. Facts, if
/// given, count as the further evidence they are. Without presses and facts nothing is known, and
/// that is the answer.
[[nodiscard]] BodyCondition find_body_condition(std::span<const KnownPress> presses,
                                                const BodyFacts& facts = {},
                                                std::span<const Subject> table = table_6_2());

}  // namespace tuina::tissue
