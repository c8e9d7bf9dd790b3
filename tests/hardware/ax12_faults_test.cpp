// SPDX-License-Identifier: Apache-2.0
#include "tuina/hardware/ax12_turntable.hpp"

#include <doctest/doctest.h>

#include <future>

#include "tests/hardware/scripted_board.hpp"
#include "tests/open_files.hpp"
#include "tests/reason.hpp"
#include "tuina/core/units.hpp"

using namespace tuina;
using namespace std::chrono_literals;
using hardware::Ax12Turntable;
using tests::ScriptedBoard;
using tests::ServoEmulator;
using Script = ScriptedBoard::Script;
using Bytes = ScriptedBoard::Bytes;

namespace {

/// How a device ended that was opened and swept.
struct Ended {
  std::string message;
  bool in_time = false;
  bool dark = false;
};

Ended end_of(Script script) {
  ScriptedBoard device(std::move(script));
  const auto begun = std::chrono::steady_clock::now();
  Ended ended;
  {
    const auto unit = Ax12Turntable::open(device.device());
    ended.message = unit ? tests::end_of_turn(**unit, 30.0 * 0.666_deg) : unit.error().message;
  }
  ended.in_time = std::chrono::steady_clock::now() - begun < 12s;
  std::this_thread::sleep_for(120ms);
  ended.dark = !device.lit();
  return ended;
}

struct FaultCase {
  const char* name;
  const char* said;
  Script script;
};

/// All at the same time, since each waits most of its own.
void check_all(const std::vector<FaultCase>& cases) {
  const std::size_t open = test::open_files();
  std::vector<std::future<Ended>> all;
  for (const FaultCase& one : cases)
    all.push_back(std::async(std::launch::async, end_of, one.script));
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const Ended ended = all[i].get();
    INFO(std::string(cases[i].name));
    CHECK_MESSAGE(ended.message.find(cases[i].said) != std::string::npos, ended.message);
    CHECK(ended.in_time);
    CHECK(ended.dark);
  }
  CHECK(test::open_files() == open);
}

/// The parameters of an answer of the board, put back under a right check sum.
std::function<void(Bytes&)> packet_with(std::function<void(hardware::dynamixel::Packet&)> change) {
  return [change](Bytes& bytes) {
    hardware::dynamixel::Reader reader;
    reader.add(bytes);
    auto packet = reader.next();
    if (!packet) return;
    change(*packet);
    bytes = hardware::dynamixel::encode(*packet);
  };
}

std::vector<FaultCase> before_the_start() {
  const auto text = [](Bytes& bytes) {
    const std::string_view nmea = "$GPGGA,123519,4807.038,N,01131.000,E,1,08*47\r\n";
    bytes.assign(nmea.begin(), nmea.end());
  };
  return {
      {"nothing there", "is it plugged in", {.address = "/nowhere/ttyACM0"}},
      {"no serial line", "is no serial line", {.address = "/dev/null"}},
      {"silent",
       "did not answer within 200 ms; is it the scanner's board",
       {.from_poll = -1, .packet = [](Bytes& b) { b.clear(); }}},
      {"talks otherwise", "bytes came that are no packet", {.from_poll = -1, .packet = text}},
      {"wrong speed",
       "bytes came that are no packet",
       {.from_poll = -1, .packet = [](Bytes& b) { b.assign(b.size(), 0x80); }}},
      {"another board", "is not the scanner's board", {.hello = [](auto& who) { who[0] = 'X'; }}},
      {"old firmware", "has version 9 of its firmware", {.hello = [](auto& who) { who[2] = 9; }}},
      {"no motor",
       "is the motor's 12 V supply on, and its id 1",
       {.from_poll = -1, .motor = [](ServoEmulator& s, double) { s.id = 7; }}},
      {"another motor",
       "motor 1 is of model 29",
       {.from_poll = -1, .motor = [](ServoEmulator& s, double) { s.model = 29; }}},
      {"wheel mode",
       "limited to counts 0 to 0",
       {.from_poll = -1, .motor = [](ServoEmulator& s, double) { s.set_limits(0, 0); }}},
      {"low voltage",
       "motor 1 says: voltage out of range",
       {.from_poll = -1, .motor = [](ServoEmulator& s, double) { s.error = 1; }}},
  };
}

std::vector<FaultCase> of_the_line() {
  const auto held = std::make_shared<Bytes>();
  return {
      {"unplugged", "plug it in again", {.from_poll = 5, .unplugged = true}},
      {"silence",
       "did not answer within 40 ms",
       {.from_poll = 5, .packet = [](Bytes& b) { b.clear(); }}},
      {"half packets",
       "but the beginning of a packet came",
       {.from_poll = 5, .packet = [](Bytes& b) { b.resize(b.size() / 2); }}},
      {"garbage",
       "bytes came that are no packet",
       {.from_poll = 5, .packet = [](Bytes& b) { std::fill(b.begin(), b.end(), 0x5A); }}},
      {"wrong check sum",
       "wrong check sum came",
       {.from_poll = 5, .packet = [](Bytes& b) { b.back() ^= 1; }}},
      {"one bit of the angle",
       "wrong check sum came",
       {.from_poll = 5,
        .packet =
            [](Bytes& b) {
              if (b.size() > 11) b[10] ^= 4;
            }}},
      {"another device", "but device 17 did", {.from_poll = 5, .packet = packet_with([](auto& p) {
                                                                 p.id = 17;
                                                               })}},
      {"too short an answer",
       "with 13 bytes where 18 belong",
       {.from_poll = 5, .packet = packet_with([](auto& p) { p.parameters.resize(13); })}},
      {"too long an answer",
       "with 20 bytes where 18 belong",
       {.from_poll = 5, .packet = packet_with([](auto& p) { p.parameters.resize(20); })}},
      {"error of the board",
       "does not understand",
       {.from_poll = 5, .packet = packet_with([](auto& p) {
                          p.kind = 0x40;
                          p.parameters.clear();
                        })}},
      {"the answer before",
       "came to question",
       {.from_poll = 5,
        .packet =
            [held](Bytes& b) {
              std::swap(b, *held);
              if (b.empty()) b = *held;
            }}},
      {"marks for ever",
       "did not answer within 40 ms",
       {.from_poll = 5, .packet = [](Bytes& b) { b.assign(200, 0xFF); }}},
      {"empty packets",
       "did not answer within 40 ms",
       {.from_poll = 5,
        .packet =
            [](Bytes& b) {
              b = {0xFF, 0xFF, 200, 0, 55};
            }}},
      {"huge length",
       "did not answer within 40 ms",
       {.from_poll = 5, .packet = [](Bytes& b) { b = {0xFF, 0xFF, 200, 255, 0, 1, 2}; }}},
  };
}

std::vector<FaultCase> of_motor_laser_and_clock() {
  const auto stamp = [](Bytes& told, std::int64_t add_us) {
    std::uint32_t us = 0;
    for (unsigned i = 0; i < 4; ++i) us |= std::uint32_t{told[10 + i]} << (8 * i);
    us += static_cast<std::uint32_t>(add_us);
    for (unsigned i = 0; i < 4; ++i) told[10 + i] = static_cast<std::uint8_t>(us >> (8 * i));
  };
  const auto from_first = std::make_shared<std::uint32_t>(0);
  return {
      {"blocked",
       "the motor has stood at",
       {.from_poll = 5,
        .motor =
            [](ServoEmulator& s, double t) {
              if (!s.blocked) s.block(t);
            }}},
      {"swings about a place",
       "the motor has stood at",
       {.from_poll = 5,
        .motor = [](ServoEmulator& s,
                    double) { s.stuck_count = s.stuck_count == 512 ? 515 : 512; }}},
      {"impossible value",
       "the motor tells count 1500",
       {.from_poll = 5, .motor = [](ServoEmulator& s, double) { s.stuck_count = 1500; }}},
      {"overload",
       "motor 1 says: overload",
       {.from_poll = 5, .motor = [](ServoEmulator& s, double) { s.error = 0x20; }}},
      {"overheated",
       "motor 1 says: overheated",
       {.from_poll = 5, .motor = [](ServoEmulator& s, double) { s.error = 0x04; }}},
      {"supply",
       "motor 1 says: voltage",
       {.from_poll = 5, .motor = [](ServoEmulator& s, double) { s.error = 0x01; }}},
      {"motor silent",
       "motor 1 does not answer",
       {.from_poll = 5, .told = [](Bytes& t) { t[3] = 1; }}},
      {"motor noisy",
       "motor 1 answers with a wrong check sum",
       {.from_poll = 5, .told = [](Bytes& t) { t[3] = 2; }}},
      {"laser: silence",
       "put the laser out: it heard nothing",
       {.from_poll = 5, .told = [](Bytes& t) { t[2] = 1; }}},
      {"laser: stands",
       "put the laser out: the beam stood still",
       {.from_poll = 5, .told = [](Bytes& t) { t[2] = 2; }}},
      {"laser: a minute",
       "put the laser out: it was lit for a minute",
       {.from_poll = 5, .told = [](Bytes& t) { t[2] = 3; }}},
      {"laser: no motor",
       "put the laser out: the motor did not answer",
       {.from_poll = 5, .told = [](Bytes& t) { t[2] = 4; }}},
      {"laser: unknown",
       "put the laser out: for a cause",
       {.from_poll = 5, .told = [](Bytes& t) { t[2] = 77; }}},
      {"clock back",
       "it has started anew",
       {.from_poll = 5, .told = [stamp](Bytes& t) { stamp(t, -30'000'000); }}},
      {"clock jumps",
       "its clock jumped by",
       {.from_poll = 5, .told = [stamp](Bytes& t) { stamp(t, 200'000); }}},
      {"clock stands",
       "its clock jumped",
       {.from_poll = 5,
        .told =
            [from_first](Bytes& t) {
              if (*from_first == 0)
                for (unsigned i = 0; i < 4; ++i) *from_first |= std::uint32_t{t[10 + i]} << (8 * i);
              for (unsigned i = 0; i < 4; ++i)
                t[10 + i] = static_cast<std::uint8_t>(*from_first >> (8 * i));
            }}},
  };
}

/// A motor at a USB adapter, which no board watches.
std::vector<FaultCase> of_an_adapter() {
  return {
      {"adapter: no motor",
       "is the motor's 12 V supply on, and its id 1",
       {.alone = true, .from_poll = -1, .packet = [](Bytes& b) { b.clear(); }}},
      {"adapter: hears itself alone",
       "is the motor's 12 V supply on, and its id 1",
       {.alone = true, .echo = true, .from_poll = -1, .packet = [](Bytes& b) { b.clear(); }}},
      {"adapter: unplugged",
       "plug it in again",
       {.alone = true, .from_poll = 5, .unplugged = true}},
      {"adapter: garbage",
       "bytes came that are no packet",
       {.alone = true,
        .from_poll = 5,
        .packet = [](Bytes& b) { std::fill(b.begin(), b.end(), 0x5A); }}},
      {"adapter: overload",
       "motor 1 says: overload",
       {.alone = true, .from_poll = 5, .motor = [](ServoEmulator& s, double) { s.error = 0x20; }}},
      {"adapter: stuck value",
       "is the unit blocked, or its 12 V supply too weak",
       {.alone = true,
        .from_poll = 5,
        .motor = [](ServoEmulator& s, double) { s.stuck_count = 512; }}},
  };
}

}  // namespace

TEST_CASE("what goes wrong with board, line, motor, laser or clock is named, and the laser dark" *
          doctest::skip(!tests::PseudoTerminal::exist())) {
  const std::array all = {before_the_start(), of_the_line(), of_motor_laser_and_clock(),
                          of_an_adapter()};
  std::size_t count = 1;  // an adapter without a line for its laser, at the end
  for (const auto& cases : all) count += cases.size();
  MESSAGE(count << " faults of a turntable");
  CHECK(count >= 40);
  tests::adapters_have_dtr = true;
  for (const auto& cases : all) check_all(cases);
  CHECK_FALSE(tests::dtr_is_high);
  tests::adapters_have_dtr = false;
  const Ended without = end_of({.alone = true});
  CHECK_MESSAGE(without.message.find("has no line DTR") != std::string::npos, without.message);
}

TEST_CASE("a single lost or broken answer in a turn changes nothing" *
          doctest::skip(!tests::PseudoTerminal::exist())) {
  const auto once = [](void (*spoil)(Bytes&)) {
    return Script{.from_poll = 7, .once = true, .packet = spoil};
  };
  check_all({{"lost", "arrived", once([](Bytes& b) { b.clear(); })},
             {"wrong check sum", "arrived", once([](Bytes& b) { b.back() ^= 1; })},
             {"marks before", "arrived", once([](Bytes& b) { b.insert(b.begin(), 3, 0xFF); })},
             {"a byte behind", "arrived", once([](Bytes& b) { b.push_back(0x17); })}});
}
