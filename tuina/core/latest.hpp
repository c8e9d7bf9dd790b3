// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

namespace tuina {

/// Newest value wins: one writer, one reader, neither ever waits. Three slots, so that the writer
/// always has one that the reader does not look at.
template <typename T>
class Latest {
 public:
  void write(const T& value) noexcept {
    slots_[write_] = value;
    write_ =
        shared_.exchange(static_cast<std::uint8_t>(write_ | fresh), std::memory_order_acq_rel) &
        index;
  }

  /// The newest value; the default-constructed one before the first write.
  [[nodiscard]] const T& read() noexcept {
    if ((shared_.load(std::memory_order_relaxed) & fresh) != 0) {
      read_ = shared_.exchange(read_, std::memory_order_acq_rel) & index;
    }
    return slots_[read_];
  }

 private:
  static constexpr std::uint8_t fresh = 4;
  static constexpr std::uint8_t index = 3;
  std::array<T, 3> slots_ = {};
  std::uint8_t write_ = 0;
  std::uint8_t read_ = 1;
  std::atomic<std::uint8_t> shared_ = 2;
};

}  // namespace tuina
