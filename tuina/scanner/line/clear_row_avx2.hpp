// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tuina/scanner/line/clear_row.hpp"

namespace tuina::scanner {

/// Reader for processors with AVX2; null on others, and if the compiler cannot build it.
[[nodiscard]] const RowReader* avx2_row_reader() noexcept;

}  // namespace tuina::scanner
