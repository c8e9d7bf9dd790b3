// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace tuina::test {

/// How often this thread has taken memory from the heap since the program began: malloc, calloc,
/// realloc, aligned_alloc and all that stands on them, so Eigen's own allocations count too.
[[nodiscard]] std::size_t allocations() noexcept;

}  // namespace tuina::test
