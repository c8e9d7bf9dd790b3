// SPDX-License-Identifier: Apache-2.0
#include "tuina/hardware/ax12_turntable.hpp"

#include <doctest/doctest.h>
#include <sys/ioctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <cmath>
#include <cstdarg>

#include "tests/hardware/scripted_board.hpp"
#include "tests/reason.hpp"
#include "tuina/core/units.hpp"

using namespace tuina;
using namespace std::chrono_literals;
using hardware::Ax12Turntable;
using tests::adapters_have_dtr;
using tests::dtr_is_high;
using tests::ScriptedBoard;
using Script = ScriptedBoard::Script;

namespace {

constexpr double speed_rad_per_s = 30.0 * 0.666_deg;

}  // namespace

namespace tuina::tests {

std::atomic<bool> adapters_have_dtr = false, dtr_is_high = false;

}  // namespace tuina::tests

/// A pty has no line DTR, so the switch of an adapter's laser is put in before the C library.
extern "C" int ioctl(int number, unsigned long request, ...) {
  va_list rest;
  va_start(rest, request);
  void* what = va_arg(rest, void*);
  va_end(rest);
  const bool is_dtr = request == TIOCMBIS || request == TIOCMBIC;
  if (!is_dtr || !adapters_have_dtr)
    return static_cast<int>(::syscall(SYS_ioctl, number, request, what));
  dtr_is_high = request == TIOCMBIS;
  return 0;
}

TEST_CASE("a sweep is read evenly, at the ordered speed, from before its beginning to its end" *
          doctest::skip(!tests::PseudoTerminal::exist())) {
  for (const Script& script :
       {Script{}, Script{.echo = true}, Script{.board_rate = 1.004}, Script{.board_rate = 0.996}}) {
    ScriptedBoard device(script);
    auto unit = Ax12Turntable::open(device.device());
    REQUIRE_MESSAGE(unit.has_value(), test::reason(unit));
    CHECK((*unit)->who().find("AX-12A (model 12)") != std::string::npos);
    for (const double sign : {1.0, -1.0}) {
      REQUIRE((*unit)->sweep(-sign * 6.0_deg, sign * 6.0_deg, speed_rad_per_s).has_value());
      REQUIRE((*unit)->switch_laser(true).has_value());
      CHECK(device.lit());
      while (!(*unit)->arrived().value()) std::this_thread::sleep_for(5ms);
      REQUIRE((*unit)->switch_laser(false).has_value());
      CHECK_FALSE(device.lit());
      const auto readings = (*unit)->readings();
      REQUIRE_MESSAGE(readings.has_value(), test::reason(readings));
      CHECK(sign * readings->front().yaw_rad < -8.0_deg);
      CHECK(sign * readings->back().yaw_rad > 5.8_deg);
      double worst_rad = 0.0;
      for (const auto& reading : *readings) {
        const double true_rad =
            (device.servo().at(reading.time_s) - 512.0) * scanner::yaw_count_rad;
        worst_rad = std::max(worst_rad, std::abs(reading.yaw_rad - true_rad));
      }
      // Rounding to a count, and what the clock's map may be off at 20 degrees per second.
      CHECK(worst_rad < 0.8 * scanner::yaw_count_rad);
    }
  }
}

TEST_CASE("a motor behind an adapter is swept as well, with the laser at the line DTR" *
          doctest::skip(!tests::PseudoTerminal::exist())) {
  ScriptedBoard device({.alone = true, .echo = true});
  const auto without = Ax12Turntable::open(device.device());
  REQUIRE_FALSE(without.has_value());
  CHECK_MESSAGE(without.error().message.find("has no line DTR") != std::string::npos,
                without.error().message);
  adapters_have_dtr = true;
  {
    auto unit = Ax12Turntable::open(device.device());
    REQUIRE_MESSAGE(unit.has_value(), test::reason(unit));
    CHECK((*unit)->who() == "AX-12A (model 12), stands at count 512");
    REQUIRE((*unit)->sweep(-6.0_deg, 6.0_deg, speed_rad_per_s).has_value());
    CHECK_FALSE(dtr_is_high);
    REQUIRE((*unit)->switch_laser(true).has_value());
    CHECK(dtr_is_high);
    while (!(*unit)->arrived().value()) std::this_thread::sleep_for(5ms);
    CHECK((*unit)->readings()->back().yaw_rad > 5.8_deg);
  }
  CHECK_FALSE(dtr_is_high);
  adapters_have_dtr = false;
}

TEST_CASE("steps stand between their counts" * doctest::skip(!tests::PseudoTerminal::exist())) {
  ScriptedBoard device({});
  auto unit = Ax12Turntable::open(device.device());
  REQUIRE_MESSAGE(unit.has_value(), test::reason(unit));
  REQUIRE(tests::end_of_turn(**unit, speed_rad_per_s, true) == "arrived");
  const auto readings = (*unit)->readings().value();
  std::size_t standing = 0;
  for (std::size_t i = 1; i < readings.size(); ++i)
    standing += readings[i].yaw_rad == readings[i - 1].yaw_rad ? 1U : 0U;
  CHECK(standing > readings.size() / 2);
  CHECK(std::abs(readings.back().yaw_rad - 3.0_deg) < 0.6_deg);
}

TEST_CASE("what the motor cannot reach is refused" *
          doctest::skip(!tests::PseudoTerminal::exist())) {
  ScriptedBoard device({});
  auto unit = Ax12Turntable::open(device.device());
  REQUIRE(unit.has_value());
  const auto far = (*unit)->sweep(-6.0_deg, 149.0_deg, speed_rad_per_s);
  REQUIRE_FALSE(far.has_value());
  CHECK_MESSAGE(far.error().message.find("not to 149.0") != std::string::npos, far.error().message);
  const auto slow = (*unit)->sweep(-18.0_deg, 18.0_deg, 1.8_deg);
  REQUIRE_FALSE(slow.has_value());
  CHECK_MESSAGE(slow.error().message.find("sweep within 13 s") != std::string::npos,
                slow.error().message);
}

TEST_CASE("the laser goes out for a scan that asks no more, within 0.2 s and a poll" *
          doctest::skip(!tests::PseudoTerminal::exist())) {
  ScriptedBoard device({});
  auto unit = Ax12Turntable::open(device.device());
  REQUIRE(unit.has_value());
  REQUIRE((*unit)->sweep(-6.0_deg, 100.0_deg, speed_rad_per_s).has_value());
  REQUIRE((*unit)->switch_laser(true).has_value());
  REQUIRE((*unit)->arrived().has_value());
  const double asked_s = hardware::steady_s();
  std::this_thread::sleep_for(400ms);  // a camera that hangs in the kernel
  CHECK_FALSE(device.lit());
  CHECK(device.last_lit_s() - asked_s < 0.2);
  const auto arrived = (*unit)->arrived();
  REQUIRE_FALSE(arrived.has_value());
  CHECK(arrived.error().message.find("the laser was put out") != std::string::npos);
}
