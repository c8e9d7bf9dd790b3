// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "tuina/scanner/line/line_candidates.hpp"

namespace tuina::scanner {

/// Moves the candidate that best continues the line to the front of each unclear row.
void choose_by_continuity(const std::vector<LinePoint>& clear, std::vector<CandidateRow>& unclear);

/// Drops rows of a lit scene that few neighbouring rows continue: what texture shows. The first
/// candidate of an unclear row counts.
void keep_what_continues(std::vector<LinePoint>& clear, std::vector<CandidateRow>& unclear,
                         int height);

/// Drops rows that no neighbouring row continues from a picture with hardly any: noise reaches as
/// far as a faint line in one of some ten thousand rows.
void drop_lone_rows(std::vector<LinePoint>& points, int height);

}  // namespace tuina::scanner
