// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "tuina/core/contact.hpp"
#include "tuina/sim/person/person.hpp"

namespace tuina::sim {

/// Tissue under a point of the skin; the shares sum to one.
struct TissueShares {
  double bone = 0.0;  ///< skin over bone: spine, scapula, ribs, sacrum
  double hard = 0.0;
  double soft = 0.0;
};

/// Pure tissue laws of one person, before mixing.
struct TissueLaws {
  TangentTissue bone, hard, soft;
};

/// True tissue law F = alpha tan(beta x) of each skin vertex, derived from the landmarks, for
/// labelled bodies and phantoms. Kinds blend over at least 15 mm. Deterministic in the seed.
[[nodiscard]] std::vector<TangentTissue> lay_tissue(const Person& person, std::uint64_t seed);

/// Makes tissue uneven within 2 to 6 cm: alpha by this share, beta by two fifths of it, so that a
/// tool which slips feels another place.
void roughen(std::vector<TangentTissue>& per_vertex, const Mesh& skin, double share,
             std::uint64_t seed);

/// Tissue shares of each vertex, for reports. Needs the landmarks of docs/bodies.md; without the
/// spine, all is hard.
[[nodiscard]] std::vector<TissueShares> find_tissue_shares(const Person& person);

/// [thesis] Table 6-2 by body type and sex, without spread.
[[nodiscard]] TissueLaws tissue_laws_of(BodyType type, bool woman);

}  // namespace tuina::sim
