// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace tuina::link {

/// Who goes first where processors are short: the last word must come even when the proposals do
/// not.
enum class Priority : std::uint8_t { loop = 70, guard = 80 };

/// Locks the memory of this process and asks for real-time priority for the calling thread; says
/// what was granted. Threads and processes that it starts from then on have none.
[[nodiscard]] std::string be_real_time(Priority priority);

/// The calling thread is one among others again, and memory may be swapped.
void end_real_time() noexcept;

}  // namespace tuina::link
