// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "tuina/core/contact.hpp"

namespace tuina::tissue {

/// What the thesis tells apart by alpha and beta; `unknown` where none is likely enough.
enum class TissueClass : std::uint8_t { bone, hard, soft, unknown };
/// As reports and JSON name it.
[[nodiscard]] const char* name_of(TissueClass tissue_class) noexcept;

/// One row of [thesis] Table 6-2: estimates over bone, hard and soft muscle.
struct Subject {
  const char* build;  ///< slim, medium, hefty
  bool female;
  std::array<TangentTissue, 3> tissue;  ///< in the order of TissueClass
};
/// The seven people of [thesis] Table 6-2.
[[nodiscard]] std::span<const Subject, 7> table_6_2() noexcept;
/// Table 6-2 and the person of Table 6-1, pressed at other places: the soft muscle is a third
/// thicker.
[[nodiscard]] std::span<const Subject, 8> tables_6_1_and_6_2() noexcept;

/// Probabilities of bone, hard and soft; they sum to one.
using ClassProbabilities = std::array<double, 3>;
inline constexpr ClassProbabilities nothing_known = {1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0};

/// A class of tissue with its probability.
struct Classification {
  TissueClass label = TissueClass::unknown;
  double probability = 0.0;  ///< of the label; for `unknown`: that no class can be named
  ClassProbabilities of = nothing_known;
};

/// The tissue that a press has found, where the place is known.
struct KnownPress {
  TangentTissue tissue;
  TissueClass at = TissueClass::bone;
};
/// Classifies an estimate by the spread of the thesis' tables and the estimate's confidence
/// interval. People differ more than tissues: the table itself is separated in 71 % only, so every
/// label has a probability. `prior`: class probabilities of the place on the body. Not converged,
/// nis above 4 or no class above 60 %: unknown.
[[nodiscard]] Classification classify(
    const TissueEstimate& estimate, double nis = 1.0,
    const ClassProbabilities& prior = nothing_known,
    std::span<const Subject> table = tables_6_1_and_6_2()) noexcept;

}  // namespace tuina::tissue
