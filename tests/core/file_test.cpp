// SPDX-License-Identifier: Apache-2.0
#include "tuina/core/io/file.hpp"
#include "tuina/core/io/scratch_folder.hpp"

#include <doctest/doctest.h>

#include "tests/folder.hpp"

using namespace tuina;

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
