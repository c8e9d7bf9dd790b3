// SPDX-License-Identifier: Apache-2.0
// What becomes of a program that nobody hears.
#include <doctest/doctest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>

#include "tests/whole/command.hpp"
#include "tuina/core/io/file.hpp"

using tuina::test::Folder;

TEST_CASE("what cannot be said to anybody ends no massage") {
  const Folder folder;
  const std::string brief = folder.with(
      "brief.toml",
      "name = \"brief\"\n[[part]]\ntechnique = \"press\"\npoints = [\"BL47\"]\nrepeats = 1\n");
  // A full disk, a pipe that nobody reads any more, and no stderr at all.
  const std::pair<const char*, const char*> ways[] = {
      {"2>/dev/full", ""}, {"", "2>&1 >/dev/null | true"}, {"2>&-", ""}};
  for (const auto& [own, around] : ways) {
    CAPTURE(own);
    CAPTURE(around);
    const std::string out = folder / "report", code = folder / "code";
    const std::string command = std::string("{ '") + TUINA_BINARY + "' massage --programme '" +
                                brief + "' --out '" + out + "' >/dev/null " + own + "; echo $? >'" +
                                code + "'; } " + around;
    CHECK(std::system(command.c_str()) == 0);
    CHECK(tuina::read_file(code).value() == "0\n");
    CHECK(std::filesystem::exists(out + "/report.html"));
    const std::string record = tuina::read_file(out + "/session.mcap").value();
    CHECK(record.find("massage 10 %") == std::string::npos);
    std::filesystem::remove_all(out);
  }
}

TEST_CASE("a mistake that cannot be told is told by the exit code") {
  for (const char* words : {"nonsense", "scan --replay /nowhere --out x.ply", "scan", "record"}) {
    CAPTURE(words);
    const int status =
        std::system((std::string("'") + TUINA_BINARY + "' " + words + " 2>/dev/full").c_str());
    CHECK(WEXITSTATUS(status) > 0);
    CHECK(WEXITSTATUS(status) <= 4);
  }
  const int status =
      std::system((std::string("'") + TUINA_BINARY + "' --help 2>/dev/null >/dev/full").c_str());
  CHECK(WEXITSTATUS(status) == 2);
}
