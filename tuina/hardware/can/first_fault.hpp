// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <array>
#include <utility>

namespace tuina::hardware {

/// The first thing that goes wrong with a device, in words. It stays. No heap, no exceptions: it is
/// noted within a control cycle.
class FirstFault {
 public:
  /// Keeps the words, cut to 199 characters, unless there are some.
  template <typename... Args>
  void note(fmt::format_string<Args...> format, Args&&... args) noexcept {
    if (noted_) return;
    noted_ = true;
    try {
      const auto written =
          fmt::format_to_n(words_.data(), words_.size() - 1, format, std::forward<Args>(args)...);
      *written.out = '\0';
    } catch (...) {  // formats are checked when they are compiled, so that none is left to fail
      words_ = {"is at fault"};
    }
  }
  /// Null while all is well.
  [[nodiscard]] const char* words() const noexcept { return noted_ ? words_.data() : nullptr; }
  explicit operator bool() const noexcept { return noted_; }

 private:
  bool noted_ = false;
  std::array<char, 200> words_ = {};
};

}  // namespace tuina::hardware
