// SPDX-License-Identifier: Apache-2.0
#include "tuina/history/archive.hpp"

#include <doctest/doctest.h>
#include <sys/resource.h>

#include <csignal>
#include <cstdlib>

#include "tests/folder.hpp"
#include "tests/history/some_visit.hpp"
#include "tests/reason.hpp"
#include "tuina/core/io/file.hpp"

using namespace tuina;
using namespace tuina::history;
using test::visit_at;

TEST_CASE(
    "an archive has all that is kept of somebody, says what is missing, and is never a part") {
  const test::Folder folder;
  record::SessionFile file{.seed = 1, .version = "0.1"};
  file.visit = {"anna", "mine", "2026-01-01T09:00:00Z"};
  const std::string bytes("\0a\nb\xff", 5);
  for (const char* name : {"mine", "replaced"}) {
    std::filesystem::create_directories(folder.path() / name / "deep");
    REQUIRE(write_file(folder.path() / name / "session.json", record::to_json(file)));
    REQUIRE(write_file(folder.path() / name / "deep/scan.ply", bytes));
  }
  REQUIRE(write_file(folder.path() / "secret.txt", "somebody else's"));
  std::filesystem::create_symlink(folder.path() / "secret.txt", folder.path() / "mine/linked.txt");
  PersonHistory anna{.who = "anna", .visits = {}, .notes = {{"2026-01-02T08:00:00Z", "sleeps"}}};
  for (const char* id : {"mine", "gone", "replaced"}) {
    anna.visits.push_back(visit_at(id, "2026-01-01T09:00:00Z", 2.0));
    anna.visits.back().folder = folder / id;
  }
  anna.visits.front().said = R"({"no_go": []})";
  const std::string zip = folder / "anna.zip";
  const auto archived = write_archive(anna, "2026-03-01T00:00:00Z", zip);
  REQUIRE_MESSAGE(archived, test::reason(archived));
  CHECK(archived->sessions == 1);
  CHECK(archived->files == 5);
  REQUIRE(archived->missing.size() == 2);
  CHECK(archived->missing[0].find(folder / "gone") != std::string::npos);
  CHECK(archived->missing[1].find("another session") != std::string::npos);
  const auto only_owner = std::filesystem::perms::owner_read | std::filesystem::perms::owner_write;
  CHECK(std::filesystem::status(zip).permissions() == only_owner);

  // Another program than the one that writes it reads it.
  const std::string out = folder / "out";
  REQUIRE(std::system(("python3 -m zipfile -e '" + zip + "' '" + out + "'").c_str()) == 0);
  CHECK(read_file(out + "/sessions/001_2026-01-01/deep/scan.ply").value() == bytes);
  CHECK(read_file(out + "/sessions/001_2026-01-01/session.json").value() == record::to_json(file));
  CHECK_FALSE(std::filesystem::exists(out + "/sessions/001_2026-01-01/linked.txt"));
  CHECK_FALSE(std::filesystem::exists(out + "/sessions/003_2026-01-01"));
  CHECK(read_file(out + "/history.json").value() == to_json(anna) + "\n");
  CHECK(read_file(out + "/history.json")->find("no_go") != std::string::npos);
  CHECK(read_file(out + "/tissue.csv").value() == to_csv(anna));
  const auto readme = read_file(out + "/README.txt");
  for (const std::string& missing : archived->missing)
    CHECK(readme->find(missing) != std::string::npos);

  // Where the disk is full, the archive before stays as it was.
  const auto before = read_file(zip).value();
  rlimit usual{};
  REQUIRE(getrlimit(RLIMIT_FSIZE, &usual) == 0);
  const rlimit little{.rlim_cur = 600, .rlim_max = usual.rlim_max};
  const bool ignored = std::signal(SIGXFSZ, SIG_IGN) != SIG_ERR;
  REQUIRE(ignored);
  REQUIRE(setrlimit(RLIMIT_FSIZE, &little) == 0);
  const auto full = write_archive(anna, "2026-03-02T00:00:00Z", zip);
  REQUIRE(setrlimit(RLIMIT_FSIZE, &usual) == 0);
  REQUIRE_FALSE(full);
  CHECK(full.error().message.find(zip) != std::string::npos);
  CHECK(read_file(zip).value() == before);
  CHECK_FALSE(std::filesystem::exists(zip + ".part"));
  CHECK(write_archive(anna, "", folder / "mine/anna.zip").error().fault == Fault::usage);
}
