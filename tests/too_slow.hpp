// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace tuina::test {

// Instrumented code is ten times slower: tests of whole massages, whose code is that of others, are
// left out there.
#ifdef __SANITIZE_ADDRESS__
inline constexpr bool too_slow = true;
#else
inline constexpr bool too_slow = false;
#endif

}  // namespace tuina::test
