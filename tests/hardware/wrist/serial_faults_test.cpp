// SPDX-License-Identifier: Apache-2.0
// What may be wrong with a wrist sensor, its line and its box: named before the start, an old
// sample afterwards.
#include <doctest/doctest.h>

#include <future>

#include "tests/hardware/scripted_wrist.hpp"
#include "tests/open_files.hpp"
#include "tests/reason.hpp"
#include "tuina/hardware/steady_clock.hpp"
#include "tuina/hardware/wrist_sensor.hpp"

using namespace tuina;
using namespace std::chrono_literals;
using hardware::WristSensor;
using tests::ScriptedWrist;
using Script = ScriptedWrist::Script;
using Sample = ScriptedWrist::Sample;
using Bytes = ScriptedWrist::Bytes;
using Kind = ScriptedWrist::Kind;
using Clock = std::chrono::steady_clock;

namespace {

struct FaultCase {
  const char* name;
  const char* said;
  Script script;
};

/// All at the same time, since each waits most of its own.
template <typename Judge>
std::vector<std::string> run_all(const std::vector<FaultCase>& cases, Judge&& judge) {
  const std::size_t open = test::open_files();
  std::vector<std::future<std::string>> all;
  for (const FaultCase& one : cases)
    all.push_back(std::async(std::launch::async, judge, one.script));
  std::vector<std::string> said;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    said.push_back(all[i].get());
    INFO(std::string(cases[i].name));
    CHECK_MESSAGE(said.back().find(cases[i].said) != std::string::npos, said.back());
  }
  CHECK(test::open_files() == open);
  return said;
}

/// Why it is not opened.
std::string refusal(Script script) {
  ScriptedWrist wrist(std::move(script));
  const auto begun = Clock::now();
  const auto sensor = WristSensor::open(wrist.device());
  if (sensor) return "opened";
  if (sensor.error().fault != Fault::device) return "another kind of fault";
  if (sensor.error().message.find(wrist.device().address) != 0) return "without its address";
  return Clock::now() - begun < 4s ? sensor.error().message : "too late";
}

/// What becomes of a sound sensor that is spoilt after it was opened: its fault, or that its sample
/// has become old, as the guard sees it.
std::string later(Script script) {
  script.from = 1 << 30;
  ScriptedWrist wrist(std::move(script));
  auto sensor = WristSensor::open(wrist.device());
  if (!sensor) return sensor.error().message;
  wrist.spoil_from_now();
  const auto until = Clock::now() + 150ms;
  while (Clock::now() < until) {
    sensor->wait(until);
    (void)sensor->hear();
  }
  const double age_s = hardware::steady_s() - sensor->stream().time_s();
  if (age_s < 0.05) return fmt::format("a sample of {:.3f} s ago", age_s);
  return sensor->stream().fault() != nullptr ? sensor->stream().fault() : "old";
}

const auto nothing = [](Bytes& bytes) { bytes.clear(); };
const auto text = [](Bytes& bytes) {
  const std::string_view nmea = "$GPGGA,123519,4807.038,N,01131.000,E,1,08*47\r\n";
  bytes.assign(nmea.begin(), nmea.end());
};

}  // namespace

TEST_CASE("25 ways not to be a wrist sensor are named before the start") {
  const auto other_axes = [](std::uint8_t size) {
    return [size](Bytes& bytes) {
      bytes[3] = size;
      bytes.resize(4U + size, 0);
      std::uint32_t sum = 0;
      for (const std::uint8_t byte : bytes) sum += byte;
      bytes.push_back(static_cast<std::uint8_t>(sum >> 8 & 0xFFU));
      bytes.push_back(static_cast<std::uint8_t>(sum & 0xFFU));
    };
  };
  const std::vector<FaultCase> cases = {
      {"silent line",
       "says nothing; is it at its box",
       {.bytes = nothing, .answers = [](auto& a) { a.clear(); }}},
      {"silent after its answer", "says nothing; is it at its box", {.bytes = nothing}},
      {"another device", "no sample of this kind", {.bytes = text}},
      {"wrong speed",
       "no sample of this kind",
       {.bytes = [](Bytes& b) { b.assign(b.size(), 0x80); }}},
      {"wrong check sum", "no sample of this kind", {.bytes = [](Bytes& b) { b.back() ^= 1; }}},
      {"half frames", "no sample of this kind", {.bytes = [](Bytes& b) { b.resize(11); }}},
      {"three axes", "a HEX of 6 axes is needed", {.bytes = other_axes(10)}},
      {"four sensors", "a HEX of 6 axes is needed", {.bytes = other_axes(28)}},
      {"no acknowledgement", "does not acknowledge", {.answers = [](auto& a) { a.clear(); }}},
      {"refused",
       "refuses its configuration with error 2",
       {.answers =
            [](auto& a) {
              a = {{0xAA, 0, 0x50, 1, 2, 0, 0xFD}};
            }}},
      {"overloaded",
       "tells status 0x00000200: it is overloaded",
       {.sample = [](Sample& s) { s.status = 0x200; }}},
      {"no sensor at the box",
       "it has failed or is not at its box",
       {.sample = [](Sample& s) { s.status = 0x400; }}},
      {"broken box", "its box has failed", {.sample = [](Sample& s) { s.status = 0x2000; }}},
      {"saturated",
       "is saturated: force z is 32767 counts",
       {.sample = [](Sample& s) { s.counts[2] = 32767; }}},
      {"stuck counts", "says the same for half a second", {.quiet = true}},
      {"too slow", "samples a second, 1000 belong here", {.rate_hz = 333}},
      {"too fast", "samples a second, 1000 belong here", {.kind = Kind::ati_udp, .rate_hz = 2000}},
      {"latency timer", "set `latency_timer`", {.at_once = 16}},
      {"silent port", "has it power", {.kind = Kind::ati_udp, .bytes = nothing}},
      {"port of another", "no sample of this kind", {.kind = Kind::ati_udp, .bytes = text}},
      {"empty datagrams' kin",
       "no sample of this kind",
       {.kind = Kind::hex_udp, .bytes = [](Bytes& b) { b.resize(35); }}},
      {"status of ATI",
       "tells status 0x80020000",
       {.kind = Kind::ati_udp, .sample = [](Sample& s) { s.status = 0x80020000U; }}},
      {"rail of ATI",
       "is saturated: torque x",
       {.kind = Kind::ati_udp, .sample = [](Sample& s) { s.counts[3] = -2147483647 - 1; }}},
      {"unplugged at once", "was unplugged", {.from = 100, .unplugged = true}},
      {"one measurement",
       "one measurement under new numbers",
       {.kind = Kind::ati_udp, .sample = [](Sample& s) { s.counter = 7; }}},
  };
  MESSAGE(cases.size() << " faults of wrist sensors before the start");
  CHECK(cases.size() == 25);
  run_all(cases, refusal);
  CHECK(
      WristSensor::open({.address = "/nowhere/ttyACM1"}).error().message.find("is it plugged in") !=
      std::string::npos);
}

TEST_CASE("20 ways to fail afterwards leave an old sample, and the fault stays") {
  const auto jump = [](int by) {
    return [by](Sample& s) {
      s.sequence += static_cast<std::uint32_t>(by);
      s.counter += static_cast<std::uint32_t>(by);
    };
  };
  const auto hold = [] {
    return [kept = Sample{}](Sample& s) mutable {
      if (kept.counter == 0) kept = s;
      s = kept;
    };
  };
  const std::vector<FaultCase> cases = {
      {"unplugged", "was unplugged", {.unplugged = true}},
      {"silence", "old", {.bytes = nothing}},
      {"silence of a port", "old", {.kind = Kind::ati_udp, .bytes = nothing}},
      {"gone port", "old", {.kind = Kind::hex_udp, .unplugged = true}},
      {"garbage", "sends bytes that are no frame", {.bytes = text}},
      {"marks for ever",
       "sends bytes that are no frame",
       {.bytes = [](Bytes& b) { b.assign(40, 0xAA); }}},
      {"spoilt sums", "sends bytes that are no frame", {.bytes = [](Bytes& b) { b.back() ^= 4; }}},
      {"one bit of a force",
       "sends bytes that are no frame",
       {.bytes = [](Bytes& b) { b[9] ^= 8; }}},
      {"other datagrams", "sends what is no sample", {.kind = Kind::ati_udp, .bytes = text}},
      {"too long datagrams",
       "sends what is no sample",
       {.kind = Kind::hex_udp, .bytes = [](Bytes& b) { b.resize(72); }}},
      {"overload", "it is overloaded", {.sample = [](Sample& s) { s.status = 0x80; }}},
      {"overload of a port",
       "tells status 0x00000010: it is overloaded",
       {.kind = Kind::hex_udp, .sample = [](Sample& s) { s.status = 0x10; }}},
      {"saturation",
       "is saturated: force x is -32768 counts",
       {.sample = [](Sample& s) { s.counts[0] = -32768; }}},
      {"saturation of a torque",
       "is saturated: torque z",
       {.kind = Kind::ati_udp, .sample = [](Sample& s) { s.counts[5] = 2147483647; }}},
      {"one for ever", "repeats a sample", {.sample = hold()}},
      {"one for ever, a port", "repeats a sample", {.kind = Kind::ati_udp, .sample = hold()}},
      {"jump ahead", "lost 500 samples in a row", {.sample = jump(500)}},
      {"jump back", "counts backwards", {.sample = jump(-500)}},
      {"began anew",
       "counts backwards",
       {.kind = Kind::ati_udp, .sample = [](Sample& s) { s.sequence %= 50; }}},
      {"one measurement",
       "one measurement under new numbers",
       {.kind = Kind::hex_udp, .sample = [](Sample& s) { s.counter = 9; }}},
  };
  MESSAGE(cases.size() << " faults of wrist sensors afterwards");
  CHECK(cases.size() == 20);
  run_all(cases, later);
}
