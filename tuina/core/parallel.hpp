// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstddef>
#include <mutex>
#include <thread>
#include <vector>

#include "tuina/core/progress.hpp"

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

}  // namespace tuina
