// SPDX-License-Identifier: Apache-2.0
#include "tuina/core/parallel.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <chrono>

using namespace tuina;

TEST_CASE("what is made side by side is used one after another, in order, few made ahead") {
  constexpr std::size_t count = 1000;
  std::atomic<std::size_t> made = 0, max_ahead = 0;
  std::vector<std::size_t> used;
  const auto make = [&](std::size_t i) {
    ++made;
    // The later ones are done before the earlier ones.
    if (i % 8 == 0) std::this_thread::sleep_for(std::chrono::microseconds(200));
    return 2 * i;
  };
  const auto use = [&](std::size_t i, std::size_t twice) -> Result<void> {
    CHECK(twice == 2 * i);
    max_ahead = std::max(max_ahead.load(), made - used.size());
    used.push_back(i);
    return {};
  };
  REQUIRE(for_each_in_order(count, make, use).has_value());
  CHECK(made == count);
  CHECK(used.size() == count);
  CHECK(std::is_sorted(used.begin(), used.end()));
  CHECK(max_ahead <= 2 * std::max(1U, std::thread::hardware_concurrency()));
}

TEST_CASE("the first that cannot be used ends it, and little is made after it") {
  std::atomic<std::size_t> made = 0;
  std::size_t used = 0;
  const auto done = for_each_in_order(
      100'000, [&](std::size_t i) { return ++made, i; },
      [&](std::size_t, std::size_t number) -> Result<void> {
        if (number == 5) return fail(Fault::bad_input, "number {} is bad", number);
        ++used;
        return {};
      });
  REQUIRE_FALSE(done.has_value());
  CHECK(done.error().message == "number 5 is bad");
  CHECK(used == 5);
  CHECK(made <= 6 + 2 * std::max(1U, std::thread::hardware_concurrency()));
}
