// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstddef>

namespace tuina {

/// Lock-free queue of fixed size between one writer and one reader.
template <typename T, std::size_t N>
class Ring {
  static_assert(N > 1 && (N & (N - 1)) == 0, "the size of a ring is a power of two");

 public:
  /// False when the ring is full; the value is then dropped.
  [[nodiscard]] bool push(const T& value) noexcept {
    const std::size_t head = head_.load(std::memory_order_relaxed);
    if (head - tail_.load(std::memory_order_acquire) == N) return false;
    slots_[head % N] = value;
    head_.store(head + 1, std::memory_order_release);
    return true;
  }

  /// False when the ring is empty.
  [[nodiscard]] bool pop(T& value) noexcept {
    const std::size_t tail = tail_.load(std::memory_order_relaxed);
    if (tail == head_.load(std::memory_order_acquire)) return false;
    value = slots_[tail % N];
    tail_.store(tail + 1, std::memory_order_release);
    return true;
  }

 private:
  std::array<T, N> slots_ = {};
  std::atomic<std::size_t> head_ = 0;
  std::atomic<std::size_t> tail_ = 0;
};

}  // namespace tuina
