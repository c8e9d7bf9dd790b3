// SPDX-License-Identifier: Apache-2.0
// What may be wrong with a wrist sensor on Ethernet and with its network: named before the start,
// stopped by the guard afterwards.
#include "tests/hardware/wrist/judged.hpp"

using namespace tuina;
using namespace tuina::tests;
using Bytes = ScriptedWrist::Bytes;
using Kind = ScriptedWrist::Kind;

namespace {

std::function<void(Bytes&)> resized(std::size_t size) {
  return [size](Bytes& bytes) { bytes.resize(size, 0x20); };
}
const auto twice = [](Bytes& bytes) {
  const Bytes one = bytes;
  bytes.insert(bytes.end(), one.begin(), one.end());
};
std::function<void(hardware::WristDevice&)> at(const char* address) {
  return [address](hardware::WristDevice& device) {
    device.address = address;
    device.udp = *hardware::parse_udp_address(address);
  };
}

std::vector<WristFault> before_the_start() {
  const Kind hex = Kind::hex_udp, ati = Kind::ati_udp;
  return {
      {"nobody at the port",
       "has it power, and is this its address",
       {.kind = hex},
       at("127.0.0.1:9")},
      {"no way to it", "cannot be reached", {.kind = ati}, at("255.255.255.255:49152")},
      {"silent port", "has it power", {.kind = ati, .bytes = as_nothing}},
      {"falls silent at once", "falls silent", {.kind = hex, .from = 100, .bytes = as_nothing}},
      {"port of another", "no sample of this kind", {.kind = ati, .bytes = as_text}},
      {"another's datagrams of its size",
       "tells status 0x20202020",
       {.kind = ati, .bytes = [](Bytes& b) { b.assign(36, 0x20); }}},
      {"empty datagrams", "no sample of this kind", {.kind = ati, .empty = true}},
      {"a byte too few", "no sample of this kind", {.kind = hex, .bytes = resized(35)}},
      {"two samples in one", "no sample of this kind", {.kind = ati, .bytes = twice}},
      {"a page of the web", "no sample of this kind", {.kind = ati, .bytes = resized(1400)}},
      {"overloaded",
       "tells status 0x00000100: it is overloaded",
       {.kind = hex, .sample = status(0x100)}},
      {"no sensor at the box", "is not at its box", {.kind = hex, .sample = status(0x800)}},
      {"broken box", "its box has failed", {.kind = hex, .sample = status(0x4000)}},
      {"status of ATI", "tells status 0x80020000", {.kind = ati, .sample = status(0x80020000U)}},
      {"rail of ATI",
       "is saturated: torque x",
       {.kind = ati, .sample = counts(3, -2147483647 - 1)}},
      {"saturated", "is saturated: force y", {.kind = hex, .sample = counts(1, 2147483647)}},
      {"one sample for ever", "repeats a sample", {.kind = ati, .sample = hold()}},
      {"one measurement",
       "one measurement under new numbers",
       {.kind = ati, .sample = [](auto& sample) { sample.counter = 7; }}},
      {"counts backwards", "counts backwards", {.kind = hex, .sample = count_by(0xFFFFFFFFU)}},
      {"a sample of ten", "lost 9 samples in a row", {.kind = ati, .sample = count_by(10)}},
      {"stuck counts", "says the same for half a second", {.kind = ati, .quiet = true}},
      {"too fast", "set its RDT output rate", {.kind = ati, .rate_hz = 2000}},
      {"too slow", "is its line or this machine overloaded", {.kind = hex, .rate_hz = 333}},
  };
}

std::vector<WristFault> afterwards() {
  const Kind hex = Kind::hex_udp, ati = Kind::ati_udp;
  const auto no_sample = "sends what is no sample of its kind; guard: force sensor stale";
  return {
      {"silence", "guard: force sensor stale", {.kind = ati, .bytes = as_nothing}},
      {"gone port", "guard: force sensor stale", {.kind = hex, .unplugged = true}},
      {"back to 100 Hz", "guard: force sensor stale", slowed(ati, 10)},
      {"another's datagrams", no_sample, {.kind = ati, .bytes = as_text}},
      {"empty datagrams", no_sample, {.kind = hex, .empty = true}},
      {"half datagrams", no_sample, {.kind = ati, .bytes = resized(18)}},
      {"too long datagrams", no_sample, {.kind = hex, .bytes = resized(72)}},
      {"two samples in one", no_sample, {.kind = ati, .bytes = twice}},
      {"overload",
       "tells status 0x00000010: it is overloaded",
       {.kind = hex, .sample = status(0x10)}},
      {"sensor off its box", "is not at its box", {.kind = hex, .sample = status(0x1000)}},
      {"box fails", "its box has failed", {.kind = hex, .sample = status(0x8000)}},
      {"status of ATI", "tells status 0x00010000", {.kind = ati, .sample = status(0x10000)}},
      {"saturation", "is saturated: force z", {.kind = hex, .sample = counts(2, -2147483647)}},
      {"saturation of a torque",
       "is saturated: torque z",
       {.kind = ati, .sample = counts(5, 2147483647)}},
      {"one for ever", "repeats a sample", {.kind = ati, .sample = hold()}},
      {"one measurement",
       "one measurement under new numbers",
       {.kind = hex, .sample = [](auto& sample) { sample.counter = 9; }}},
      {"jump ahead", "lost 500 samples in a row", {.kind = ati, .sample = jump(500)}},
      {"jump back", "counts backwards", {.kind = hex, .sample = jump(-500)}},
      {"began anew",
       "counts backwards: did it start anew?",
       {.kind = ati, .sample = begin_anew_each(50)}},
      {"stuck", "guard: force sensor stuck", {.kind = ati, .sample = hold_counts()}},
      {"600 N at once", "guard: ", {.kind = hex, .sample = counts(0, -30'000)}},
      {"off its calibrated zero",
       "guard: force sensor off its zero",
       {.kind = ati},
       drifted_by(5.0)},
  };
}

}  // namespace

TEST_CASE("what is wrong with a wrist sensor on Ethernet is named, or the guard stops") {
  const auto before = before_the_start(), after = afterwards();
  const std::size_t count = before.size() + after.size();
  MESSAGE(count << " faults of wrist sensors on Ethernet");
  CHECK(count >= 40);
  check_all(before, refusal);
  check_all(after, stopped);
}
