// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "tuina/core/image.hpp"
#include "tuina/scanner/line/line_candidates.hpp"
#include "tuina/scanner/line/line_kernel.hpp"

namespace tuina::scanner {

/// The lines of the rows in which one unclipped line stands away from the borders with nothing
/// beside it: nearly all rows, and the ones that must be fast. The numbers of the rows that show
/// something else go to `in_doubt`; rows that show nothing go nowhere.
void find_clear_lines(ImageView image, const LineScene& scene, const LineKernel& kernel,
                      LineMethod method, std::vector<LinePoint>& points,
                      std::vector<int>& in_doubt);

}  // namespace tuina::scanner
