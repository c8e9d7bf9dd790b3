// SPDX-License-Identifier: Apache-2.0
// fuzz_parsers [RUNS [SEED]]: every parser of tuina on files with random faults, RUNS of
// them each. Says how many were refused, how long the slowest took and how much memory was taken;
// fails when one takes too long or more than a file of its size may.
#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>

#include "tests/core/mutation.hpp"
#include "tests/fuzz/parsers.hpp"

namespace {

constexpr double max_ms = 2000.0;
constexpr double max_mb = 256.0;
constexpr std::size_t max_bytes = 20000;  // a file that grew longer is given up

double peak_mb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

struct Outcome {
  long refused = 0;
  double slowest_ms = 0.0;
};

// Faults pile up: a faulty file that is still accepted may become the next one to be spoilt.
Outcome spoil(const tuina::test::Parser& parser, long runs, tuina::Random& random) {
  using Clock = std::chrono::steady_clock;
  Outcome outcome;
  std::string content;
  for (long run = 0; run < runs; ++run) {
    const bool anew = content.empty() || content.size() > max_bytes || random() % 4 == 0;
    const std::string bad =
        tuina::tests::mutated(anew ? parser.good[random() % parser.good.size()] : content, random);
    const auto start = Clock::now();
    const bool accepted = parser.accepts(bad);
    const std::chrono::duration<double, std::milli> took = Clock::now() - start;
    outcome.slowest_ms = std::max(outcome.slowest_ms, took.count());
    outcome.refused += accepted ? 0 : 1;
    content = accepted ? bad : std::string();
  }
  return outcome;
}

}  // namespace

int main(int count, char** arguments) {
  const long runs = count > 1 ? std::atol(arguments[1]) : 2000;
  const auto seed = static_cast<std::uint64_t>(count > 2 ? std::atol(arguments[2]) : 1);
  bool good = runs > 0;
  fmt::print("{:<22} {:>10} {:>10} {:>12} {:>10}\n", "parser", "runs", "refused", "slowest, ms",
             "took, MB");
  for (const auto& parser : tuina::test::parsers()) {
    for (const std::string& content : parser.good) good = good && parser.accepts(content);
    auto random = tuina::make_random(seed, parser.name);
    const double before_mb = peak_mb();
    const Outcome outcome = spoil(parser, runs, random);
    // A sanitizer keeps what was freed for a while, so the program as a whole grows with every
    // parser; one that believes a header grows at once.
    const double mb = peak_mb() - before_mb;
    fmt::print("{:<22} {:>10} {:>9.1f}% {:>12.2f} {:>10.1f}\n", parser.name, runs,
               100.0 * static_cast<double>(outcome.refused) / static_cast<double>(runs),
               outcome.slowest_ms, mb);
    good = good && outcome.slowest_ms < max_ms && mb < max_mb;
  }
  if (!good) fmt::print("a good file was refused, or a bad one took too much\n");
  return good ? 0 : 1;
}
