// SPDX-License-Identifier: Apache-2.0
// What the record of a session costs: writing a millisecond of two arms, and reading a minute back.
// The limits beside them: of writing the millisecond itself, a core's time for it; of reading the
// checksum of the file, which whoever reads it whole cannot leave out.
#include <benchmark/benchmark.h>

#include <filesystem>

#include "tuina/core/random.hpp"
#include "tuina/record/session_folder.hpp"
#include "tuina/record/session_recorder.hpp"
#include "tuina/telemetry/mcap/compression.hpp"

namespace {

using namespace tuina;

constexpr std::uint64_t minute_ticks = 60'000;

/// A minute of arms that move slowly, with the noise of their sensors.
const std::vector<session::Tick>& some_ticks() {
  static const std::vector<session::Tick> ticks = [] {
    std::vector<session::Tick> all(minute_ticks);
    Random random(5);
    for (std::uint64_t ms = 0; ms < minute_ticks; ++ms) {
      session::Tick& tick = all[ms];
      tick.reading.tick = ms;
      tick.reading.time_s = 1e-3 * static_cast<double>(ms);
      for (const Arm arm : both_arms) {
        JointVector q(6), dq(6), torque(6);
        for (int i = 0; i < 6; ++i) {
          q[i] = 0.3 * std::sin(0.3 * tick.reading.time_s + i);
          dq[i] = 0.09 * std::cos(0.3 * tick.reading.time_s + i) + gaussian(random, 2e-3);
          torque[i] = 5.0 * q[i] + gaussian(random, 0.05);
        }
        tick.reading.arms[arm].q_rad = q;
        tick.reading.arms[arm].dq_rad_per_s = dq;
        tick.verdict.command.torque_nm[arm] = torque;
        for (int i = 0; i < 3; ++i) {
          tick.reading.arms[arm].wrench_in_tool.force_n[i] = 10.0 * q[i] + gaussian(random, 0.05);
          tick.reading.arms[arm].wrench_in_tool.torque_nm[i] = gaussian(random, 2e-3);
        }
      }
    }
    return all;
  }();
  return ticks;
}

std::filesystem::path file() {
  return std::filesystem::temp_directory_path() / "tuina_record_bench.mcap";
}

std::unique_ptr<record::SessionRecorder> recorder() {
  auto recorder =
      record::SessionRecorder::begin(file(), {.robot = robot::load_robot("thesis").value()});
  (*recorder)->on_map({});
  return std::move(*recorder);
}

void record_a_millisecond(benchmark::State& state) {
  const auto& ticks = some_ticks();
  auto into = recorder();
  std::uint64_t ms = 0;
  for (auto _ : state) {
    session::Tick tick = ticks[ms % minute_ticks];
    tick.reading.tick = ms;
    tick.reading.time_s = 1e-3 * static_cast<double>(ms++);
    into->on_tick(tick);
  }
}
BENCHMARK(record_a_millisecond)->Unit(benchmark::kMicrosecond);

void write_a_minute() {
  auto into = recorder();
  for (const session::Tick& tick : some_ticks()) into->on_tick(tick);
  (void)into->finish(minute_ticks - 1);
}

void read_a_minute_back(benchmark::State& state) {
  write_a_minute();
  std::uint64_t messages = 0;
  for (auto _ : state) {
    messages = record::read_record_file(file(), [](const telemetry::mcap::Contents&,
                                                   const telemetry::mcap::Message& message) {
                 benchmark::DoNotOptimize(message.data.data());
               })->contents.messages;
  }
  state.counters["messages"] = static_cast<double>(messages);
  state.counters["file_bytes"] = static_cast<double>(std::filesystem::file_size(file()));
  std::filesystem::remove(file());
}
BENCHMARK(read_a_minute_back)->Unit(benchmark::kMillisecond);

void limit_checksum_of_a_minute(benchmark::State& state) {
  write_a_minute();
  const std::string bytes = record::read_record_file(file())->bytes;
  for (auto _ : state) benchmark::DoNotOptimize(telemetry::mcap::crc32(bytes));
  std::filesystem::remove(file());
}
BENCHMARK(limit_checksum_of_a_minute)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
