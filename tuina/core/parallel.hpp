// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "tuina/core/progress.hpp"
#include "tuina/core/result.hpp"

namespace tuina {

/// Calls `work(i)` for every i below `count` on `threads` threads (0: one per core), in any order.
/// `work` must not throw and may write only to data of its own i. `progress` is called by one
/// thread at a time.
template <class Work>
void for_each_in_parallel(std::size_t count, const Work& work, const Progress& progress = {},
                          unsigned threads = 0) {
  std::atomic<std::size_t> next = 0;
  std::size_t done = 0;
  std::mutex telling;
  const auto run = [&] {
    for (std::size_t i = next++; i < count; i = next++) {
      work(i);
      const std::lock_guard lock(telling);
      ++done;
      if (progress) progress(static_cast<double>(done) / static_cast<double>(count));
    }
  };
  if (threads == 0) threads = std::thread::hardware_concurrency();
  std::vector<std::thread> team;
  for (unsigned i = 1; i < threads && i < count; ++i) team.emplace_back(run);
  run();
  for (std::thread& thread : team) thread.join();
}

/// Calls `make(i)` for every i below `count` side by side, and `use(i, what was made)` one after
/// another in the order of i, so that sums are the same to the last bit. Few are made ahead, so
/// that many need no more memory. Ends with the first Result of `use` that is an error.
template <class Make, class Use>
[[nodiscard]] Result<void> for_each_in_order(std::size_t count, const Make& make, const Use& use) {
  const std::size_t ahead = 2 * std::max(1U, std::thread::hardware_concurrency());
  for (std::size_t first = 0; first < count; first += ahead) {
    std::vector<std::optional<decltype(make(count))>> made(std::min(ahead, count - first));
    for_each_in_parallel(made.size(), [&](std::size_t k) { made[k].emplace(make(first + k)); });
    for (std::size_t k = 0; k < made.size(); ++k) {
      if (auto used = use(first + k, *std::move(made[k])); !used) return used;
      made[k].reset();
    }
  }
  return {};
}

}  // namespace tuina
