// SPDX-License-Identifier: Apache-2.0
#include "tuina/history/history.hpp"

#include <doctest/doctest.h>

#include <cstdlib>
#include <fstream>

#include "tests/folder.hpp"
#include "tests/history/server.hpp"
#include "tests/history/some_visit.hpp"
#include "tests/reason.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/history/person_history.hpp"
#include "tuina/history/schema.hpp"

using namespace tuina;
using namespace tuina::history;

namespace {

/// The same statements on both databases, each empty.
void on_both(const std::function<void(const std::string& address)>& test) {
  SUBCASE("SQLite") {
    const test::Folder folder;
    test(folder / "history.sqlite");
  }
  SUBCASE("PostgreSQL") {
    const auto address = test::empty_database();
    if (!address) {
      MESSAGE("skipped: there is no PostgreSQL server here");
      return;
    }
    test(*address);
  }
}

}  // namespace

TEST_CASE("what is added is what is found, in the order of time, and once") {
  on_both([](const std::string& address) {
    auto history = History::open(address);
    REQUIRE_MESSAGE(history, test::reason(history));
    const Visit second = test::visit_at("b", "2026-02-01T09:00:00Z", 3.0);
    Visit first = test::visit_at("a", "2026-01-01T09:00:00Z", 2.5);
    first.intensity = 0.75;
    for (const Visit& visit : {second, first, second}) REQUIRE(history->add(visit));
    REQUIRE(history->add_note("anna", {"2026-01-02T08:00:00Z", "sleeps well"}));
    CHECK_FALSE(history->add_note("nobody", {"2026-01-02T08:00:00Z", "?"}));

    auto again = History::open(address);  // another one opens it as it is
    REQUIRE(again);
    const auto people = again->people();
    REQUIRE(people);
    REQUIRE(people->size() == 1);
    CHECK(people->front().name == "anna");
    CHECK(people->front().sessions == 2);
    const auto visits = again->visits_of("anna");
    REQUIRE(visits);
    REQUIRE(visits->size() == 2);
    const Visit& kept = visits->front();
    CHECK(kept.id == "a");
    CHECK(visits->back().id == "b");
    CHECK(kept.stop_cause == first.stop_cause);
    CHECK(kept.duration_s == first.duration_s);
    CHECK(kept.softer == 2);
    CHECK(kept.intensity == 0.75);
    CHECK(std::isnan(visits->back().intensity));
    CHECK(kept.ended);
    REQUIRE(kept.acupoints.size() == 1);
    CHECK(kept.acupoints[0].at_in_couch == first.acupoints[0].at_in_couch);
    REQUIRE(kept.tissue.size() == 1);
    CHECK(std::isnan(kept.tissue[0].alpha_ci95_n));  // was not known
    CHECK(kept.tissue[0].stiffness_n_per_mm == 2.5);
    CHECK(kept.tissue[0].converged);
    CHECK(again->notes_of("anna")->front().words == "sleeps well");
    CHECK(again->visits_of("berta")->empty());
  });
}

TEST_CASE("a session that only began is there, and said to be cut short") {
  on_both([](const std::string& address) {
    auto history = History::open(address);
    REQUIRE(history);
    REQUIRE(history->begin({"anna", "x", "2026-01-01T09:00:00Z"}, "/nowhere"));
    CHECK_FALSE(history->visits_of("anna")->front().ended);
    REQUIRE(history->add(test::visit_at("x", "2026-01-01T09:00:00Z", 2.0)));
    REQUIRE(history->visits_of("anna")->size() == 1);
    CHECK(history->visits_of("anna")->front().ended);
  });
}

TEST_CASE("a session that was refused is taken back, one that has ended is not") {
  on_both([](const std::string& address) {
    auto history = History::open(address);
    REQUIRE(history);
    const record::VisitLabel first{"anna", "x", "2026-01-01T09:00:00Z"};
    REQUIRE(history->begin(first, "/nowhere"));
    REQUIRE(history->take_back(first));
    CHECK(history->people()->empty());
    REQUIRE(history->add(test::visit_at("x", "2026-01-01T09:00:00Z", 2.0)));
    REQUIRE(history->take_back(first));
    CHECK(history->visits_of("anna")->size() == 1);
    const record::VisitLabel second{"anna", "y", "2026-01-02T09:00:00Z"};
    REQUIRE(history->begin(second, "/nowhere"));
    REQUIRE(history->take_back(second));
    CHECK(history->visits_of("anna")->size() == 1);
  });
}

TEST_CASE("a session that cannot be added whole is not there at all") {
  on_both([](const std::string& address) {
    auto history = History::open(address);
    REQUIRE(history);
    Visit twice = test::visit_at("a", "2026-01-01T09:00:00Z", 2.0);
    twice.acupoints.push_back(twice.acupoints.front());  // two points of one name
    CHECK_FALSE(history->add(twice));
    CHECK(history->people()->empty());
    // What was there before stays as it was.
    REQUIRE(history->add(test::visit_at("a", "2026-01-01T09:00:00Z", 2.0)));
    CHECK_FALSE(history->add(twice));
    CHECK(history->visits_of("anna")->front().tissue.front().stiffness_n_per_mm == 2.0);
  });
}

TEST_CASE("every earlier schema is brought up to date with what it holds, a later one is refused") {
  on_both([](const std::string& address) {
    auto database = open_database(address);
    REQUIRE(database);
    REQUIRE(migrate(**database, 1));
    REQUIRE((*database)->run("INSERT INTO person VALUES ('anna', '2025-01-01T00:00:00Z')"));
    REQUIRE(
        (*database)->run("INSERT INTO session (id, who, began, folder, ended) VALUES ('a', 'anna', "
                         "'2025-01-01T00:00:00Z', '/nowhere', 1)"));
    {
      auto history = History::open(address);
      REQUIRE_MESSAGE(history, test::reason(history));
      CHECK(history->visits_of("anna")->size() == 1);
      CHECK(history->add_note("anna", {"2026-01-02T08:00:00Z", "new table"}));
    }
    REQUIRE((*database)->run("INSERT INTO migration VALUES (99)"));
    const auto newer = History::open(address);
    REQUIRE_FALSE(newer);
    CHECK(newer.error().message.find("schema 99") != std::string::npos);
  });
}

TEST_CASE("who is forgotten is gone from every table, from the file and from the folders") {
  on_both([](const std::string& address) {
    const test::Folder folder;
    auto history = History::open(address);
    REQUIRE(history);
    record::SessionFile file{.seed = 1, .version = "0.1"};
    file.visit = {"anna", "mine", "2026-01-01T09:00:00Z"};
    for (const char* name : {"mine", "shared", "replaced"}) {
      std::filesystem::create_directories(folder.path() / name);
      REQUIRE(write_file(folder.path() / name / "session.json", record::to_json(file)));
      REQUIRE(write_file(folder.path() / name / "scan.ply", "x"));
    }
    Visit mine = test::visit_at("mine", "2026-01-01T09:00:00Z", 2.0);
    mine.folder = folder / "mine";
    Visit replaced = test::visit_at("older", "2026-01-02T09:00:00Z", 2.0);
    replaced.folder = folder / "replaced";  // where another session has been written since
    // Beside a session somebody keeps a file of their own.
    file.visit->id = "shared";
    REQUIRE(write_file(folder.path() / "shared" / "session.json", record::to_json(file)));
    REQUIRE(write_file(folder.path() / "shared" / "thesis.txt", "x"));
    Visit shared = test::visit_at("shared", "2026-01-03T09:00:00Z", 2.0);
    shared.folder = folder / "shared";
    REQUIRE(history->add(mine));
    REQUIRE(history->add(replaced));
    REQUIRE(history->add(shared));
    REQUIRE(history->add_note("anna", {"2026-01-02T08:00:00Z", "SECRETWORDS"}));
    const auto kept = history->forget("anna", "2026-03-01T00:00:00Z");
    REQUIRE_MESSAGE(kept, test::reason(kept));
    REQUIRE(kept->size() == 2);
    CHECK(kept->front().folder == folder / "replaced");
    CHECK(kept->front().other_session);
    CHECK(kept->back().folder == folder / "shared");
    CHECK_FALSE(kept->back().other_session);
    CHECK(std::filesystem::exists(folder.path() / "shared" / "thesis.txt"));
    CHECK_FALSE(std::filesystem::exists(folder.path() / "shared" / "scan.ply"));
    CHECK_FALSE(std::filesystem::exists(folder.path() / "shared" / "session.json"));
    CHECK_FALSE(std::filesystem::exists(folder.path() / "mine"));
    CHECK(std::filesystem::exists(folder.path() / "replaced" / "scan.ply"));
    CHECK(history->people()->empty());
    CHECK(history->visits_of("anna")->empty());
    CHECK(history->notes_of("anna")->empty());
    auto database = open_database(address);
    REQUIRE(database);
    const auto trace = (*database)->query("SELECT at, sessions FROM forgotten", {});
    REQUIRE(trace);
    CHECK(std::get<std::int64_t>(trace->front()[1]) == 3);
    if (!address.starts_with("postgresql")) {
      for (const char* end : {"", "-wal"}) {
        const auto bytes = read_file(address + end);
        if (bytes) CHECK(bytes->find("SECRETWORDS") == std::string::npos);
      }
    }
  });
}

TEST_CASE(
    "what a session that was cut short has left goes too, unless another one has begun there") {
  on_both([](const std::string& address) {
    const test::Folder folder;
    auto history = History::open(address);
    REQUIRE(history);
    for (const char* name : {"cut", "reused"}) {
      REQUIRE(std::filesystem::create_directory(folder.path() / name));
      REQUIRE(write_file(folder.path() / name / "session.mcap.part", "x"));
      REQUIRE(history->begin({"anna", name, "2026-01-04T09:00:00Z"}, folder / name));
    }
    REQUIRE(history->begin({"berta", "now", "2026-01-05T09:00:00Z"}, folder / "reused"));
    const auto kept = history->forget("anna", "2026-03-01T00:00:00Z");
    REQUIRE_MESSAGE(kept, test::reason(kept));
    REQUIRE(kept->size() == 1);
    CHECK(kept->front().folder == folder / "reused");
    CHECK(kept->front().other_session);
    CHECK(std::filesystem::exists(folder.path() / "reused" / "session.mcap.part"));
    CHECK_FALSE(std::filesystem::exists(folder.path() / "cut"));
    CHECK(history->visits_of("berta")->size() == 1);
  });
}

TEST_CASE("the index is made anew of folders, and what is not a session of somebody is named") {
  const test::Folder folder;
  record::SessionFile file{.seed = 1, .version = "0.1", .person = "phantom:slim"};
  file.massage.force.rmse_n = 0.25;
  file.order.commands = {{1.0, session::LiveCommand::softer}, {2.0, session::LiveCommand::firmer}};
  file.tissue = {{.name = "GV4", .estimate = {.presses = 3}, .stiffness_n_per_mm = 2.5}};
  const auto put = [&](const std::string& name, const std::string& content) {
    std::filesystem::create_directories(folder.path() / "all" / name);
    REQUIRE(write_file(folder.path() / "all" / name / "session.json", content));
  };
  file.visit = {"anna", "1", "2026-01-01T09:00:00Z"};
  put("one", record::to_json(file));
  file.visit = {"anna", "2", "2026-01-02T09:00:00Z"};
  put("deep/two", record::to_json(file));
  file.visit.reset();
  put("nobody", record::to_json(file));
  put("broken", "{\"seed\": 1");
  auto history = History::open(folder / "new.sqlite");
  REQUIRE(history);
  for (int again = 0; again < 2; ++again) {
    const auto rebuilt = history->rebuild(folder.path() / "all");
    REQUIRE_MESSAGE(rebuilt, test::reason(rebuilt));
    CHECK(rebuilt->sessions == 2);
    CHECK(rebuilt->left_out.size() == 2);
    const auto visits = history->visits_of("anna");
    REQUIRE(visits->size() == 2);
    CHECK(visits->front().softer == 1);
    CHECK(visits->front().firmer == 1);
    CHECK(visits->front().force_rmse_n == 0.25);
    CHECK(visits->front().tissue.front().presses == 3);
  }
  CHECK_FALSE(history->rebuild(folder.path() / "not there"));
}

TEST_CASE("what is no database is refused with its name, and so is what is no name of a person") {
  const test::Folder folder;
  const auto text = History::open(folder.with("text.txt", std::string(4096, 'x')));
  REQUIRE_FALSE(text);
  CHECK(text.error().message.find("text.txt") != std::string::npos);
  CHECK_FALSE(History::open(folder / "no/folder/x.sqlite"));
  const auto far = History::open("postgresql://nobody:secret@127.0.0.1:1/none");
  REQUIRE_FALSE(far);
  CHECK(far.error().message.find("secret") == std::string::npos);
  for (const char* name : {"", "a b", "../x", "ä", "'"}) CHECK_FALSE(check_name(name));
  CHECK_FALSE(check_name(std::string(41, 'a')));
  CHECK(check_name("Anna-2_b"));
}
