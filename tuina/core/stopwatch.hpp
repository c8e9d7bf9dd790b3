// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>

namespace tuina {

/// Time since it was made, by the steady clock.
class Stopwatch {
 public:
  /// Seconds since it was made.
  [[nodiscard]] double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }
  [[nodiscard]] double ms() const { return 1e3 * seconds(); }  ///< ms since it was made

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace tuina
