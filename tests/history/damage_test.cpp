// SPDX-License-Identifier: Apache-2.0
// What would hurt a history, or what it must not hurt.
#include <doctest/doctest.h>

#include <filesystem>

#include "tests/folder.hpp"
#include "tests/reason.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/history/database.hpp"
#include "tuina/history/history.hpp"

using namespace tuina;
using namespace tuina::history;

TEST_CASE(
    "nobody is forgotten while their session runs, and what a killed one was writing goes, too") {
  const test::Folder folder;
  auto history = History::open(folder / "history.sqlite");
  REQUIRE(history);
  std::filesystem::create_directories(folder.path() / "runs");
  REQUIRE(history->begin({"anna", "1", "2026-01-01T09:00:00Z"}, folder.path() / "runs"));
  {
    const auto record = FileWriter::open(folder.path() / "runs" / "session.mcap");
    REQUIRE(record);
    CHECK_FALSE(FileWriter::open(folder.path() / "runs" / "session.mcap"));
    const auto early = history->forget("anna", "2026-03-01T00:00:00Z");
    REQUIRE_FALSE(early);
    CHECK(early.error().message.find("a session is running there") != std::string::npos);
    CHECK(history->people()->size() == 1);
  }
  REQUIRE(write_file(folder.path() / "runs" / "session.json.part", "\"who\": \"anna\""));
  const auto kept = history->forget("anna", "2026-03-01T00:00:00Z");
  REQUIRE_MESSAGE(kept, test::reason(kept));
  CHECK(kept->empty());
  CHECK_FALSE(std::filesystem::exists(folder.path() / "runs"));
}

TEST_CASE("what is no text is no note, for it could never be given out again") {
  const test::Folder folder;
  auto history = History::open(folder / "history.sqlite");
  REQUIRE(history);
  REQUIRE(history->begin({"anna", "1", "2026-01-01T09:00:00Z"}, folder.path() / "a"));
  CHECK_FALSE(history->add_note("anna", {"2026-01-02T08:00:00Z", "bad \xff byte"}));
  CHECK_FALSE(history->begin({"bob", "2", "2026-01-01T09:00:00Z"}, folder.path() / "b\xff"));
  CHECK(history->add_note("anna", {"2026-01-02T08:00:00Z", "左肩"}));
  CHECK(history->notes_of("anna")->size() == 1);
}

TEST_CASE("a database of another program stays as it is") {
  const test::Folder folder;
  {
    auto other = open_database(folder / "bookmarks.sqlite");
    REQUIRE(other);
    REQUIRE((*other)->run("CREATE TABLE bookmarks (url TEXT)"));
  }
  const auto history = History::open(folder / "bookmarks.sqlite");
  REQUIRE_FALSE(history);
  CHECK(history.error().message.find("of another program") != std::string::npos);
}
