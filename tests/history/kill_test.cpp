// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>
#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <thread>

#include "tests/folder.hpp"
#include "tests/history/server.hpp"
#include "tests/reason.hpp"
#include "tuina/core/random.hpp"
#include "tuina/history/history.hpp"

using namespace tuina;
using namespace tuina::history;

namespace {

constexpr int places = 12;

/// Twenty, or as many as TUINA_KILLS says.
int kills() {
  const char* wanted = std::getenv("TUINA_KILLS");
  return wanted == nullptr ? 20 : std::atoi(wanted);
}

/// A program that says when it has begun, adds sessions as fast as it can, and says of each that it
/// is there.
[[noreturn]] void add_for_ever(const std::string& address, int round, int acknowledged) {
  auto history = History::open(address);
  constexpr std::int32_t begun = -1;
  if (::write(acknowledged, &begun, sizeof begun) != sizeof begun) ::_exit(1);
  for (std::int32_t i = 0; history; ++i) {
    Visit visit;
    visit.id = std::to_string(round) + "-" + std::to_string(i);
    visit.who = "anna";
    visit.began = "2026-01-01T09:00:00Z";
    visit.ended = true;
    for (int k = 0; k < places; ++k) visit.tissue.push_back({.name = "P", .presses = k});
    if (!history->begin({visit.who, visit.id, visit.began}, "/nowhere")) break;
    if (!history->add(visit)) break;
    if (::write(acknowledged, &i, sizeof i) != sizeof i) break;
  }
  ::_exit(1);
}

void kill_again_and_again(const std::string& address) {
  REQUIRE(History::open(address));
  Random random = make_random(1, "kills");
  int all_acknowledged = 0, cut_short = 0;
  for (int round = 0; round < kills(); ++round) {
    int ends[2];
    REQUIRE(::pipe2(ends, O_CLOEXEC) == 0);
    const pid_t child = ::fork();
    REQUIRE(child >= 0);
    if (child == 0) add_for_ever(address, round, ends[1]);
    ::close(ends[1]);
    std::int32_t last = 0, number = 0;
    REQUIRE(::read(ends[0], &last, sizeof last) == sizeof last);
    std::this_thread::sleep_for(std::chrono::microseconds(
        20000 + static_cast<int>(30000.0 * std::abs(gaussian(random, 0.5)))));
    ::kill(child, SIGKILL);
    int status = 0;
    ::waitpid(child, &status, 0);
    REQUIRE(WIFSIGNALED(status));
    while (::read(ends[0], &number, sizeof number) == sizeof number) last = number;
    ::close(ends[0]);
    all_acknowledged += last + 1;

    auto history = History::open(address);
    REQUIRE_MESSAGE(history, test::reason(history));
    const auto visits = history->visits_of("anna");
    REQUIRE(visits);
    std::vector<bool> there(static_cast<std::size_t>(last + 1));
    const std::string mine = std::to_string(round) + "-";
    for (const Visit& visit : *visits) {
      if (!visit.id.starts_with(mine)) continue;
      // One that had begun is whole, or said to be cut short.
      CHECK(visit.tissue.size() == (visit.ended ? places : 0));
      cut_short += visit.ended ? 0 : 1;
      const auto i = static_cast<std::size_t>(std::stoul(visit.id.substr(mine.size())));
      if (visit.ended && i < there.size()) there[i] = true;
    }
    for (const bool one : there) CHECK(one);
  }
  MESSAGE(all_acknowledged, " sessions acknowledged before ", kills(), " kills, ", cut_short,
          " cut short");
  CHECK(all_acknowledged > kills() / 2);  // a busy disk takes its time
}

}  // namespace

TEST_CASE("a program that is killed while it writes loses nothing that it was told is there") {
  SUBCASE("SQLite") {
    const test::Folder folder;
    kill_again_and_again(folder / "history.sqlite");
  }
  SUBCASE("PostgreSQL") {
    const auto address = test::empty_database();
    if (address) kill_again_and_again(*address);
  }
}
