// SPDX-License-Identifier: Apache-2.0
#include "tuina/core/io/file.hpp"
#include "tuina/core/io/scratch_folder.hpp"
#include "tuina/core/io/unfinished_file.hpp"

#include <doctest/doctest.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <thread>

#include "tests/folder.hpp"

using namespace tuina;
namespace fs = std::filesystem;

TEST_CASE("what is written to a file is read back, and nothing is left beside it") {
  const test::Folder folder;
  const auto path = folder.path() / "points.txt";
  REQUIRE(write_file(path, "acupoint\n").has_value());
  CHECK(read_file(path).value() == "acupoint\n");
  CHECK_FALSE(std::filesystem::exists(path.string() + ".part"));
}

TEST_CASE("a file for its owner is nobody else's, and a part is left where it is asked for") {
  const test::Folder folder;
  const auto path = folder.path() / "answers.toml";
  REQUIRE(write_file(path, "x", Readers::owner).has_value());
  constexpr auto others = std::filesystem::perms::group_all | std::filesystem::perms::others_all;
  CHECK((std::filesystem::status(path).permissions() & others) == std::filesystem::perms::none);
  {
    auto cut = FileWriter::open(folder.path() / "session.mcap");
    REQUIRE(cut.has_value());
    REQUIRE(cut->append("so far").has_value());
    cut->leave_part();
  }
  CHECK(read_file(folder.path() / "session.mcap.part").value() == "so far");
  CHECK_FALSE(std::filesystem::exists(folder.path() / "session.mcap"));
}

TEST_CASE("a link stays a link, and what it leads to is written") {
  const test::Folder folder;
  fs::create_directory(folder / "disk");
  fs::create_symlink("disk/far.txt", folder / "near.txt");
  for (const char* content : {"first", "second"}) {
    REQUIRE(write_file(folder / "near.txt", content).has_value());
    CHECK(fs::is_symlink(folder / "near.txt"));
    CHECK(read_file(folder / "disk/far.txt").value() == content);
  }
  fs::create_symlink("round.txt", folder / "round.txt");
  CHECK_FALSE(write_file(folder / "round.txt", "x").has_value());
}

TEST_CASE("what a killed session has left is not written over, nor what a link there leads to") {
  const test::Folder folder;
  (void)folder.with("session.mcap.part", "all that is left");
  (void)folder.with("other.txt", "kept");
  (void)folder.with("empty.csv.part", "");
  fs::create_symlink("other.txt", folder / "table.csv.part");
  for (const char* name : {"session.mcap", "table.csv"}) {
    CAPTURE(name);
    for (const auto& refused : {check_can_begin(folder / name), write_file(folder / name, "x")}) {
      REQUIRE_FALSE(refused.has_value());
      CHECK(refused.error().message.starts_with(folder / name + ".part: is there already"));
    }
  }
  CHECK(read_file(folder / "session.mcap.part").value() == "all that is left");
  CHECK(read_file(folder / "other.txt").value() == "kept");
  CHECK(check_can_begin(folder / "empty.csv").has_value());
  CHECK(write_file(folder / "empty.csv", "x").has_value());
  CHECK_FALSE(check_can_begin(folder / std::string(251, 'a')).has_value());
  CHECK(check_can_begin(folder / std::string(250, 'a')).has_value());
}

TEST_CASE("what cannot be brought to its place is left as the part, and the error says so") {
  const test::Folder folder;
  auto file = FileWriter::open(folder / "session.mcap");
  REQUIRE(file.has_value());
  REQUIRE(file->append("an hour of it").has_value());
  fs::create_directory(folder / "session.mcap");
  const auto finished = file->finish();
  REQUIRE_FALSE(finished.has_value());
  CHECK(finished.error().message.find("is left as " + folder / "session.mcap.part") !=
        std::string::npos);
  CHECK(read_file(folder / "session.mcap.part").value() == "an hour of it");
}

TEST_CASE("a part that others can read, and one that is no file, are not written to") {
  const test::Folder folder;
  fs::create_hard_link(folder.with("mine.csv", ""), folder / "linked.csv.part");
  REQUIRE(::mkfifo((folder / "pipe.csv.part").c_str(), 0600) == 0);
  fs::create_directory(folder / "folder.csv.part");
  std::vector<std::string> names = {"linked.csv", "pipe.csv", "folder.csv"};
  constexpr uid_t nobody = 65534;
  if (::geteuid() == 0) {  // nobody else can give a file away
    const std::string theirs = folder.with("theirs.csv.part", "");
    REQUIRE(::chown(theirs.c_str(), nobody, nobody) == 0);
    REQUIRE(::chmod(theirs.c_str(), 0666) == 0);
    names.emplace_back("theirs.csv");
  }
  for (const std::string& name : names) {
    CAPTURE(name);
    for (const auto& refused : {check_can_begin(folder / name), write_file(folder / name, "x")}) {
      REQUIRE_FALSE(refused.has_value());
      CHECK(refused.error().message.starts_with(folder / name + ".part: is there already"));
    }
  }
}

TEST_CASE("writers of one file lose nothing to each other: who has begun it finishes it") {
  const test::Folder folder;
  const auto path = folder.path() / "told.csv";
  std::atomic<int> lost = 0, finished = 0;
  const auto write_again_and_again = [&] {
    for (int i = 0; i < 6000; ++i) {
      auto file = FileWriter::open(path);
      if (!file || i % 8 != 0) continue;  // most of them give up
      if (!file->append("x") || !file->finish())
        ++lost;
      else
        ++finished;
    }
  };
  std::vector<std::thread> writers;
  for (int i = 0; i < 4; ++i) writers.emplace_back(write_again_and_again);
  for (std::thread& writer : writers) writer.join();
  CHECK(lost == 0);
  CHECK(finished > 0);
  CHECK(read_file(path).value() == "x");
  CHECK_FALSE(fs::exists(path.string() + ".part"));
}

TEST_CASE("a descriptor of this process takes more at its own end, as >> of a shell wants it") {
  const test::Folder folder;
  const std::string log = folder.with("log", "before\n");
  const int descriptor = ::open(log.c_str(), O_WRONLY | O_APPEND);
  REQUIRE(descriptor >= 0);
  fs::create_symlink("/proc/self/fd", folder / "fd");
  for (const std::string& by :
       {"/proc/self/fd/" + std::to_string(descriptor), "/dev/fd/" + std::to_string(descriptor),
        folder / "fd/" + std::to_string(descriptor)}) {
    CAPTURE(by);
    CHECK(check_can_begin(by).has_value());
    CHECK(write_file(by, "more\n").has_value());
  }
  ::close(descriptor);
  CHECK(read_file(log).value() == "before\nmore\nmore\nmore\n");
  CHECK_FALSE(fs::exists(log + ".part"));
  CHECK_FALSE(write_file("/proc/self/fd/" + std::to_string(descriptor), "x").has_value());
}

TEST_CASE("a file that is written over keeps its rights") {
  const test::Folder folder;
  const fs::path path = folder.with("private.csv", "x");
  for (const fs::perms rights : {fs::perms{0600}, fs::perms{0664}}) {
    fs::permissions(path, rights);
    REQUIRE(write_file(path, "y").has_value());
    CHECK(fs::status(path).permissions() == rights);
  }
  REQUIRE(write_file(path, "y", Readers::owner).has_value());
  CHECK(fs::status(path).permissions() == fs::perms{0600});
}

TEST_CASE("a file that is not there gives an error with its path") {
  const auto content = read_file("/nowhere/at/all");
  REQUIRE_FALSE(content.has_value());
  CHECK(content.error().fault == Fault::file);
  CHECK(content.error().message.find("/nowhere/at/all") != std::string::npos);
}

TEST_CASE("a scratch folder is there for its owner alone, and goes with what is in it") {
  std::filesystem::path path;
  {
    auto made = ScratchFolder::make();
    REQUIRE(made);
    const ScratchFolder folder = std::move(*made);  // what was moved from does not remove it
    path = folder.path();
    REQUIRE(write_file(path / "file", "content"));
    CHECK((std::filesystem::status(path).permissions() & std::filesystem::perms::others_all) ==
          std::filesystem::perms::none);
  }
  CHECK_FALSE(std::filesystem::exists(path));
}
