// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>

namespace tuina::hardware {

/// Seconds of the steady clock, which is also that of V4L2's time stamps.
[[nodiscard]] inline double steady_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace tuina::hardware
