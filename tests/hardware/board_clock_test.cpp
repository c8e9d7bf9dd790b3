// SPDX-License-Identifier: Apache-2.0
#include "tuina/hardware/board_clock.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "tests/reason.hpp"
#include "tuina/core/random.hpp"

using namespace tuina;
using hardware::BoardClock;

namespace {

/// Exchanges of 2 ms that now and then take much longer on one of their ways, each hundredth of a
/// second; the board's clock runs at `rate` and is 3 s from its end at the beginning.
struct Line {
  double rate = 1.0;
  Random random = make_random(3, "round trips");
  double now_s = 1000.0;

  [[nodiscard]] std::uint32_t board_us(double host_s) const {
    return static_cast<std::uint32_t>(static_cast<std::int64_t>(1e6 * rate * (host_s - 1000.0)) +
                                      0xFFFFFFFFLL - 3'000'000);
  }
  BoardClock::Exchange next() {
    now_s += 0.01;
    const double there_s = 0.001 + std::abs(gaussian(random, 0.3e-3));
    const double back_s =
        0.001 + (uniform(random, 0.0, 1.0) < 0.3 ? uniform(random, 0.0, 0.03) : 0.0);
    return {now_s, now_s + there_s + back_s, board_us(now_s + there_s)};
  }
};

}  // namespace

TEST_CASE(
    "a board's clock is mapped to a quarter of a millisecond after a second, whatever its "
    "resonator "
    "and the line do") {
  for (const double rate : {1.0, 0.995, 1.005}) {
    Line line{.rate = rate};
    BoardClock clock;
    double worst_s = 0.0;
    for (int i = 0; i < 1500; ++i) {
      const auto exchange = line.next();
      const auto board_s = clock.add(exchange);
      REQUIRE_MESSAGE(board_s.has_value(), test::reason(board_s));
      const double true_s = 1000.0 + (static_cast<double>(static_cast<std::uint32_t>(
                                         exchange.board_us - line.board_us(1000.0)))) /
                                         1e6 / rate;
      if (i > 100) worst_s = std::max(worst_s, std::abs(clock.host_s(*board_s) - true_s));
    }
    CHECK(worst_s < 0.25e-3);
    CHECK(clock.min_round_trip_s() < 2.1e-3);
  }
}

TEST_CASE("a clock that begins anew, jumps or runs off is named") {
  const auto broken = [](auto&& spoil) {
    Line line;
    BoardClock clock;
    for (int i = 0; i < 600; ++i) {
      auto exchange = line.next();
      if (i >= 300) spoil(exchange, i);
      const auto board_s = clock.add(exchange);
      if (!board_s) return board_s.error().message;
    }
    return std::string("nothing");
  };
  using Exchange = BoardClock::Exchange;
  CHECK(broken([](Exchange& e, int) { e.board_us -= 5'000'000; }).find("it has started anew") !=
        std::string::npos);
  CHECK(broken([](Exchange& e, int) { e.board_us += 50'000; }).find("its clock jumped by 0.05") !=
        std::string::npos);
  CHECK(broken([](Exchange& e, int i) {
          e.board_us += static_cast<std::uint32_t>(500 * (i - 300));
        }).find("jumped") != std::string::npos);
  CHECK(broken([](Exchange&, int) {}) == "nothing");
}
