// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "tuina/core/contact.hpp"
#include "tuina/sim/person/person.hpp"

namespace tuina::sim {

/// What lies under one place of the skin; the three shares sum to one.
struct TissueShares {
  double bone = 0.0;  ///< skin over bone: spine, scapula, ribs, sacrum
  double hard = 0.0;  ///< hard muscle
  double soft = 0.0;  ///< soft muscle
};

/// The three laws of one person, before they are mixed.
struct TissueLaws {
  TangentTissue bone, hard, soft;
};

/// One true law F = alpha tan(beta x) per vertex of the skin, for loaded bodies and phantoms alike:
/// it is laid out from the landmarks. Neighbouring kinds pass into each other over 15 mm and more.
/// Same seed, same tissue.
[[nodiscard]] std::vector<TangentTissue> lay_tissue(const Person& person, std::uint64_t seed);

/// The kinds under each vertex, for reports. Needs the landmarks of docs/bodies.md; without the
/// spine, all is hard.
[[nodiscard]] std::vector<TissueShares> find_tissue_shares(const Person& person);

/// [thesis] Table 6-2 by body type and sex, without spread.
[[nodiscard]] TissueLaws tissue_laws_of(BodyType type, bool woman);

}  // namespace tuina::sim
