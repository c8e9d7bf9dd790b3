// SPDX-License-Identifier: Apache-2.0
// What may be wrong with a wrist sensor on a serial line and with that line: named before the
// start, stopped by the guard afterwards.
#include "tests/hardware/wrist/judged.hpp"

using namespace tuina;
using namespace tuina::tests;
using Bytes = ScriptedWrist::Bytes;
using Answers = std::vector<Bytes>;

namespace {

/// Its frames have so many bytes of data, under a right sum.
std::function<void(Bytes&)> frames_of(std::uint8_t size) {
  return [size](Bytes& bytes) {
    bytes[3] = size;
    bytes.resize(4U + size, 0);
    std::uint32_t sum = 0;
    for (const std::uint8_t byte : bytes) sum += byte;
    bytes.push_back(static_cast<std::uint8_t>(sum >> 8 & 0xFFU));
    bytes.push_back(static_cast<std::uint8_t>(sum & 0xFFU));
  };
}
std::function<void(Bytes&)> filled_with(std::uint8_t byte) {
  return [byte](Bytes& bytes) { bytes.assign(bytes.size(), byte); };
}
std::function<void(Bytes&)> flipped(std::size_t at, std::uint8_t bits) {
  return [=](Bytes& bytes) { bytes[at] ^= bits; };
}
const auto half = [](Bytes& bytes) { bytes.resize(11); };
const auto no_answer = [](Answers& answers) { answers.clear(); };
std::function<void(hardware::WristDevice&)> at(const char* path) {
  return [path](hardware::WristDevice& device) { device.address = path; };
}

std::vector<WristFault> before_the_start() {
  return {
      {"nothing there", "is it plugged in", {}, at("/nowhere/ttyACM1")},
      {"no serial line", "is no serial line", {}, at("/dev/null")},
      {"silent line",
       "says nothing; is it at its box",
       {.bytes = as_nothing, .answers = no_answer}},
      {"silent after its answer", "says nothing; is it at its box", {.bytes = as_nothing}},
      {"another device", "no sample of this kind", {.bytes = as_text}},
      {"wrong speed", "no sample of this kind", {.bytes = filled_with(0x80)}},
      {"line held low", "no sample of this kind", {.bytes = filled_with(0)}},
      {"what is sent comes back",
       "no sample of this kind",
       {.bytes = as_nothing,
        .answers =
            [](Answers& answers) {
              answers = {{0xAA, 0x00, 0x32, 0x03, 1, 0, 0, 0x00, 0xE0}};
            }}},
      {"wrong check sum", "no sample of this kind", {.bytes = flipped(21, 1)}},
      {"half frames", "no sample of this kind", {.bytes = half}},
      {"three axes", "a HEX of 6 axes is needed", {.bytes = frames_of(10)}},
      {"four sensors", "a HEX of 6 axes is needed", {.bytes = frames_of(28)}},
      {"no acknowledgement", "does not acknowledge", {.answers = no_answer}},
      {"half an acknowledgement",
       "does not acknowledge",
       {.answers = [](Answers& answers) { answers[0].resize(4); }}},
      {"spoilt acknowledgement",
       "does not acknowledge",
       {.answers = [](Answers& answers) { answers[0].back() ^= 1; }}},
      {"refused",
       "refuses its configuration with error 2",
       {.answers =
            [](Answers& answers) {
              answers = {{0xAA, 0, 0x50, 1, 2, 0, 0xFD}};
            }}},
      {"overloaded", "tells status 0x00000200: it is overloaded", {.sample = status(0x200)}},
      {"no sensor at the box", "it has failed or is not at its box", {.sample = status(0x400)}},
      {"broken box", "its box has failed", {.sample = status(0x2000)}},
      {"saturated", "is saturated: force z is 32767 counts", {.sample = counts(2, 32767)}},
      {"one sample for ever", "repeats a sample", {.sample = hold()}},
      {"counts backwards", "counts backwards", {.sample = count_by(0xFFFFFFFFU)}},
      {"a sample of ten", "lost 9 samples in a row", {.sample = count_by(10)}},
      {"stuck counts", "says the same for half a second", {.quiet = true}},
      {"too slow", "samples a second, 1000 belong here", {.rate_hz = 333}},
      {"latency timer", "set `latency_timer`", {.at_once = 16}},
      {"unplugged at once", "was unplugged", {.from = 100, .unplugged = true}},
  };
}

std::vector<WristFault> afterwards() {
  const auto no_frame = "sends bytes that are no frame; guard: force sensor stale";
  return {
      {"unplugged", "was unplugged; plug it in again; guard: force sensor", {.unplugged = true}},
      {"silence", "guard: force sensor stale", {.bytes = as_nothing}},
      {"garbage", no_frame, {.bytes = as_text}},
      {"marks for ever", no_frame, {.bytes = [](Bytes& b) { b.assign(40, 0xAA); }}},
      {"spoilt sums", no_frame, {.bytes = flipped(21, 4)}},
      {"one bit of a force", no_frame, {.bytes = flipped(9, 8)}},
      {"half frames", no_frame, {.bytes = half}},
      {"a byte lost of each", no_frame, {.bytes = [](Bytes& b) { b.erase(b.begin() + 12); }}},
      {"another speed", no_frame, {.bytes = filled_with(0x80)}},
      {"line held low", no_frame, {.bytes = filled_with(0)}},
      {"another sensor at the box", no_frame, {.bytes = frames_of(10)}},
      {"answers alone",
       "guard: force sensor stale",
       {.bytes = [](Bytes& bytes) { bytes = {0xAA, 0, 0x50, 1, 0, 0, 0xFB}; }}},
      {"overload", "it is overloaded; guard: force sensor", {.sample = status(0x80)}},
      {"sensor off its box", "it has failed or is not at its box", {.sample = status(0x1000)}},
      {"box fails", "its box has failed", {.sample = status(0x8000)}},
      {"saturation", "is saturated: force x is -32768 counts", {.sample = counts(0, -32768)}},
      {"saturation of a torque", "is saturated: torque y", {.sample = counts(4, 32767)}},
      {"one for ever", "repeats a sample", {.sample = hold()}},
      {"jump ahead", "lost 500 samples in a row", {.sample = jump(500)}},
      {"jump back", "counts backwards", {.sample = jump(-500)}},
      {"began anew", "counts backwards: did it start anew?", {.sample = begin_anew_each(50)}},
      {"back to 100 Hz", "guard: force sensor stale", slowed(ScriptedWrist::Kind::hex_serial, 10)},
      {"stuck", "guard: force sensor stuck", {.sample = hold_counts()}},
      {"600 N at once", "guard: ", {.sample = counts(0, -30'000)}},
      {"off its calibrated zero", "guard: force sensor off its zero", {}, drifted_by(5.0)},
  };
}

}  // namespace

TEST_CASE("what is wrong with a wrist sensor on a serial line is named, or the guard stops" *
          doctest::skip(!tests::PseudoTerminal::exist())) {
  const auto before = before_the_start(), after = afterwards();
  const std::size_t count = before.size() + after.size();
  MESSAGE(count << " faults of wrist sensors on a serial line");
  CHECK(count >= 40);
  check_all(before, refusal);
  check_all(after, stopped);
}
