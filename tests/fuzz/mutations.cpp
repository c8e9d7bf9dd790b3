// SPDX-License-Identifier: Apache-2.0
// fuzz_parsers [RUNS|SECONDSs [SEED [NAME..]]]: every parser of tuina, or those named, on files
// with random faults: so many of them each, or for so long, as 60s. Says how many were refused, how
// long the slowest took and how much memory was taken; fails when one takes too long or more than a
// file of its size may.
#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <string>
#include <vector>

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

/// How long a parser is tried.
struct Length {
  long runs = 2000;
  double seconds = std::numeric_limits<double>::infinity();
};

Length length_of(const std::string& word) {
  if (!word.ends_with('s')) return {.runs = std::atol(word.c_str())};
  return {.runs = std::numeric_limits<long>::max(), .seconds = std::atof(word.c_str())};
}

struct Outcome {
  long runs = 0, refused = 0;
  double slowest_ms = 0.0;
};

// Faults pile up: a faulty file that is still accepted may become the next one to be spoilt.
Outcome spoil(const tuina::test::Parser& parser, const Length& length, tuina::Random& random) {
  using Clock = std::chrono::steady_clock;
  Outcome outcome;
  std::string content;
  const auto begun = Clock::now();
  const auto lasted_s = [&] { return std::chrono::duration<double>(Clock::now() - begun).count(); };
  for (; outcome.runs < length.runs && lasted_s() < length.seconds; ++outcome.runs) {
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
  const std::vector<std::string> words(arguments + std::min(count, 1), arguments + count);
  const Length length = words.empty() ? Length{} : length_of(words[0]);
  const auto seed = static_cast<std::uint64_t>(words.size() > 1 ? std::atol(words[1].c_str()) : 1);
  const std::vector<std::string> named(words.begin() + std::min<long>(count - 1, 2), words.end());
  bool good = length.runs > 0 && length.seconds > 0.0;
  for (const std::string& name : named)
    good = good && std::any_of(tuina::test::parsers().begin(), tuina::test::parsers().end(),
                               [&](const auto& parser) { return parser.name == name; });
  fmt::print("{:<22} {:>10} {:>10} {:>12} {:>10}\n", "parser", "runs", "refused", "slowest, ms",
             "took, MB");
  for (const auto& parser : tuina::test::parsers()) {
    if (!named.empty() && std::find(named.begin(), named.end(), parser.name) == named.end())
      continue;
    for (const std::string& content : parser.good) good = good && parser.accepts(content);
    auto random = tuina::make_random(seed, parser.name);
    const double before_mb = peak_mb();
    const Outcome outcome = spoil(parser, length, random);
    // A sanitizer keeps what was freed for a while, so the program as a whole grows with every
    // parser; one that believes a header grows at once.
    const double mb = peak_mb() - before_mb;
    fmt::print("{:<22} {:>10} {:>9.1f}% {:>12.2f} {:>10.1f}\n", parser.name, outcome.runs,
               100.0 * static_cast<double>(outcome.refused) / static_cast<double>(outcome.runs),
               outcome.slowest_ms, mb);
    if (parser.steps) fmt::print("  {} milliseconds were judged\n", parser.steps());
    std::fflush(stdout);
    good = good && outcome.slowest_ms < max_ms && mb < max_mb;
  }
  if (!good)
    fmt::print("a name is no parser's, a good file was refused, or a bad one took too much\n");
  return good ? 0 : 1;
}
