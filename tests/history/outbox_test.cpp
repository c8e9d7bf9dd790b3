// SPDX-License-Identifier: Apache-2.0
#include "tuina/history/outbox.hpp"

#include <doctest/doctest.h>

#include <deque>
#include <set>
#include <thread>

#include "tests/folder.hpp"
#include "tests/history/relay.hpp"
#include "tests/history/server.hpp"
#include "tests/history/some_visit.hpp"
#include "tests/reason.hpp"
#include "tuina/history/fleet.hpp"

using namespace tuina;
using namespace tuina::history;

namespace {

const std::string day = "2026-01-01T09:00:00Z";

MachineSession session_of(const std::string& robot, const std::string& id, bool ended) {
  return {.id = id, .machine = robot, .began = day, .ended = ended, .duration_s = 60.0};
}

/// A robot with a server at the other end of a bad network.
struct Robot {
  Robot(std::string own_name, const std::string& server, std::uint64_t seed)
      : name(std::move(own_name)), network(server, seed), outbox(History::open(folder / "outbox")) {
    REQUIRE_MESSAGE(outbox, test::reason(outbox));
    REQUIRE(enter(outbox->database(), Machine{.name = name, .seen = day, .doing = "idle"}));
  }
  /// True when all went well, wherever the server is.
  bool give(int number) {
    const std::string id = name + "-" + std::to_string(number);
    Visit visit = test::visit_at(id, day, 2.5);
    visit.who = "guest-of-" + name;
    if (!outbox->begin({visit.who, id, day}, visit.folder)) return false;
    if (!enter(outbox->database(), session_of(name, id, false))) return false;
    if (number % 3 == 0) catch_up();  // in the middle of the session, as it may be
    return outbox->add(visit) && enter(outbox->database(), session_of(name, id, true));
  }
  Result<Delivered> catch_up() {
    auto server = History::open(network.address());
    if (!server) return tl::unexpected(server.error());
    return deliver(*outbox, *server);
  }

  std::string name;
  test::Relay network;
  test::Folder folder;
  Result<History> outbox;
};

/// Whether a robot's sessions are on the server, each once, whole and ended.
void check_all_there(History& server, const std::string& robot, int sessions) {
  const auto visits = server.visits_of("guest-of-" + robot);
  REQUIRE(visits);
  CHECK(visits->size() == static_cast<std::size_t>(sessions));
  std::set<std::string> ids;
  for (const Visit& visit : *visits) {
    ids.insert(visit.id);
    CHECK(visit.ended);
    CHECK(visit.acupoints.size() == 1);
    CHECK(visit.tissue.size() == 1);
  }
  CHECK(ids.size() == static_cast<std::size_t>(sessions));
  const auto fleet = fleet_of(server.database());
  REQUIRE(fleet);
  for (const MachineHistory& one : *fleet) {
    if (one.machine.name != robot) continue;
    CHECK(one.sessions.size() == static_cast<std::size_t>(sessions));
    for (const MachineSession& session : one.sessions) CHECK(session.ended);
  }
}

}  // namespace

TEST_CASE("a network that is cut 200 times at random moments loses nothing and doubles nothing") {
  const auto address = test::empty_database();
  if (!address) return;
  REQUIRE(History::open(*address));
  Robot robot("room-1", *address, 1);
  int sessions = 0, failed = 0;
  while (robot.network.cuts() < 200) {
    REQUIRE(robot.give(sessions++));
    if (!robot.catch_up()) ++failed;
  }
  MESSAGE(sessions, " sessions, ", robot.network.cuts(), " cuts, ", failed,
          " deliveries that ended early");
  CHECK(failed > 50);
  robot.network.mend();
  const auto rest = robot.catch_up();
  REQUIRE_MESSAGE(rest, test::reason(rest));
  CHECK(rest->refused.empty());
  CHECK(waiting(*robot.outbox) == 0U);
  auto server = History::open(*address);
  REQUIRE(server);
  check_all_there(*server, "room-1", sessions);
}

TEST_CASE("of ten robots with cut networks all thousand sessions are there once") {
  const auto address = test::empty_database();
  if (!address) return;
  constexpr int robots = 10, sessions = 100;
  REQUIRE(History::open(*address));
  std::deque<Robot> all;
  for (int i = 0; i < robots; ++i)
    all.emplace_back("room-" + std::to_string(i), *address, static_cast<std::uint64_t>(i));
  std::vector<int> given(robots);
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < all.size(); ++i) {
    threads.emplace_back([&robot = all[i], &good = given[i]] {
      for (int k = 0; k < sessions; ++k) {
        good += robot.give(k) ? 1 : 0;
        if (k % 4 == 0) static_cast<void>(robot.catch_up());
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  auto server = History::open(*address);
  REQUIRE(server);
  int cuts = 0;
  for (int i = 0; i < robots; ++i) {
    Robot& robot = all[static_cast<std::size_t>(i)];
    CHECK(given[static_cast<std::size_t>(i)] == sessions);
    cuts += robot.network.cuts();
    robot.network.mend();
    const auto rest = robot.catch_up();
    REQUIRE_MESSAGE(rest, test::reason(rest));
    check_all_there(*server, robot.name, sessions);
  }
  MESSAGE(cuts, " cuts");
  CHECK(cuts > robots);
}

TEST_CASE("what comes late or twice does not undo what is newer") {
  const test::Folder folder;
  auto history = History::open(folder / "history.sqlite");
  REQUIRE(history);
  Database& database = history->database();
  const Machine now{.name = "room-1", .seen = "2026-01-02T09:00:00Z", .doing = "massage"};
  const Machine before{.name = "room-1", .seen = day, .doing = "idle"};
  for (const Machine& told : {now, before}) REQUIRE(enter(database, told));
  for (const bool ended : {true, false}) {
    REQUIRE(enter(database, session_of("room-1", "a", ended)));
    if (ended) REQUIRE(history->add(test::visit_at("a", day, 2.5)));
    REQUIRE(history->begin({"anna", "a", day}, "/nowhere"));
  }
  const auto fleet = fleet_of(database);
  REQUIRE(fleet);
  CHECK(fleet->front().machine.doing == "massage");
  REQUIRE(fleet->front().sessions.size() == 1);
  CHECK(fleet->front().sessions.front().ended);
  CHECK(history->visits_of("anna")->front().ended);
}

TEST_CASE("a session that ends while its beginning is on the way is not lost") {
  const auto address = test::empty_database();
  if (!address) return;
  const test::Folder folder;
  auto robot = History::open(folder / "outbox.sqlite");
  auto carrier = History::open(folder / "outbox.sqlite");  // the same one, from another thread
  auto server = History::open(*address);
  auto other = History::open(*address);
  REQUIRE(robot);
  REQUIRE(carrier);
  REQUIRE(server);
  REQUIRE(other);
  REQUIRE(robot->begin({"anna", "a", day}, "/nowhere"));
  // Somebody holds the server up, so that the beginning has been read and has not arrived.
  REQUIRE(other->database().run("BEGIN"));
  REQUIRE(other->database().run("LOCK TABLE person IN ACCESS EXCLUSIVE MODE"));
  Result<Delivered> delivered;
  std::thread carries([&] { delivered = deliver(*carrier, *server); });
  std::int64_t waits = 0;
  while (waits == 0) {
    const auto rows =
        other->database().query("SELECT COUNT(*) FROM pg_locks WHERE NOT granted", {});
    if (!rows) break;
    waits = as_whole(rows->front().front());
  }
  const auto ended = robot->add(test::visit_at("a", day, 2.5));
  const auto freed = other->database().run("COMMIT");
  carries.join();
  REQUIRE(ended);
  REQUIRE(freed);
  REQUIRE_MESSAGE(delivered, test::reason(delivered));
  CHECK(waits == 1);
  CHECK_FALSE(server->visits_of("anna")->front().ended);
  CHECK(waiting(*robot) == 1U);
  REQUIRE(deliver(*carrier, *server));
  CHECK(waiting(*robot) == 0U);
  REQUIRE(server->visits_of("anna")->size() == 1);
  CHECK(server->visits_of("anna")->front().ended);
}

TEST_CASE("a session that the server refuses waits, and the others go") {
  const test::Folder folder;
  auto outbox = History::open(folder / "outbox.sqlite");
  auto server = History::open(folder / "server.sqlite");
  REQUIRE(outbox);
  REQUIRE(server);
  REQUIRE(
      server->database().run("CREATE TRIGGER odd BEFORE INSERT ON session WHEN NEW.id = 'b' "
                             "BEGIN SELECT RAISE(ABORT, 'not this one'); END"));
  for (const char* id : {"a", "b", "c"}) REQUIRE(outbox->add(test::visit_at(id, day, 2.5)));
  const auto delivered = deliver(*outbox, *server);
  REQUIRE_MESSAGE(delivered, test::reason(delivered));
  CHECK(delivered->sessions == 2);
  REQUIRE(delivered->refused.size() == 1);
  CHECK(delivered->refused.front().find("b: ") == 0);
  CHECK(delivered->refused.front().find("not this one") != std::string::npos);
  CHECK(outbox->visits_of("anna")->size() == 1);
  CHECK(server->visits_of("anna")->size() == 2);
}
