// SPDX-License-Identifier: Apache-2.0
// Time to the page of one person among many sessions, in a history of a file.
#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>
#include <optional>

#include "tuina/history/history.hpp"
#include "tuina/history/history_page.hpp"

using namespace tuina;

namespace {

constexpr int people = 1000, points = 27, places = 12;

/// A session as a massage leaves it; without a folder, since the maps are read from the records.
history::Visit visit_of(int number) {
  history::Visit visit;
  visit.id = fmt::format("session-{}", number);
  visit.who = fmt::format("person-{}", number % people);
  const int day = number / people;
  visit.began = fmt::format("2026-{:02}-{:02}T09:00:00Z", 1 + day % 12, 1 + day / 12);
  visit.ended = true;
  for (int i = 0; i < points; ++i)
    visit.acupoints.push_back({fmt::format("P{}", i), Vector3(0.01 * i, 0.1, 0.3), {}, 8e-3});
  for (int i = 0; i < places; ++i) {
    visit.tissue.push_back({.name = fmt::format("P{}", i),
                            .alpha_n = 5.0 + 0.01 * (number % 7),
                            .alpha_ci95_n = 0.2,
                            .beta_per_m = 230.0,
                            .beta_ci95_per_m = 6.0,
                            .stiffness_n_per_mm = 5.7,
                            .stiffness_ci95_n_per_mm = 0.1,
                            .presses = 5,
                            .converged = true});
  }
  return visit;
}

/// The file goes with the program.
struct Filled {
  std::filesystem::path file =
      std::filesystem::temp_directory_path() / fmt::format("tuina-{}.sqlite", ::getpid());
  std::optional<history::History> history;

  explicit Filled(int sessions) {
    auto opened = history::History::open(file.string());
    if (!opened) return;
    history.emplace(std::move(*opened));
    // Filling it need not wait for the disk.
    if (!history->database().run("PRAGMA synchronous = OFF")) history.reset();
    for (int i = 0; history && i < sessions; ++i)
      if (!history->add(visit_of(i))) history.reset();
  }
  Filled(const Filled&) = delete;
  Filled& operator=(const Filled&) = delete;
  ~Filled() {
    history.reset();
    for (const char* beside : {"", "-wal", "-shm"}) {
      std::error_code fault;
      std::filesystem::remove(file.string() + beside, fault);
    }
  }
};

void page_of_a_person(benchmark::State& state) {
  Filled filled(static_cast<int>(state.range(0)));
  for (auto _ : state) {
    if (!filled.history) {
      state.SkipWithError("no history could be written");
      break;
    }
    auto visits = filled.history->visits_of("person-7");
    auto notes = filled.history->notes_of("person-7");
    benchmark::DoNotOptimize(history::history_page({"person-7", *visits, *notes}));
  }
}
BENCHMARK(page_of_a_person)->Arg(10'000)->Arg(100'000)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
