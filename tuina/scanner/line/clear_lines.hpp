// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "tuina/core/image.hpp"
#include "tuina/scanner/line/line_candidates.hpp"
#include "tuina/scanner/line/line_kernel.hpp"

namespace tuina::scanner {

/// Measures the rows with a single unclipped line away from the borders, by far the most. Rows with
/// anything else go to `in_doubt`; dark rows are dropped.
void find_clear_lines(ImageView image, const LineScene& scene, const LineKernel& kernel,
                      LineMethod method, std::vector<LinePoint>& points,
                      std::vector<int>& in_doubt);

}  // namespace tuina::scanner
