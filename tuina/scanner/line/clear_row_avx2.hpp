// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tuina/scanner/line/clear_row.hpp"

namespace tuina::scanner {

/// The reader for processors with AVX2; null on any other, and where the compiler knows none.
[[nodiscard]] const RowReader* avx2_row_reader() noexcept;

}  // namespace tuina::scanner
