// SPDX-License-Identifier: Apache-2.0
// Guard, robot and session as processes of their own.
#include <doctest/doctest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/whole/command.hpp"
#include "tuina/core/io/file.hpp"

using nlohmann::json;
using tuina::test::Folder;
using tuina::test::run_tuina;

TEST_CASE("a session in three processes is the session in one, to the last bit") {
  const Folder folder;
  const std::string brief = folder.with("brief.toml",
                                        "name = \"brief\"\n"
                                        "[[part]]\ntechnique = \"press\"\nrepeats = 1\n"
                                        "points = [\"BL47\"]\n");
  const auto give = [&](const std::string& out, bool processes) {
    std::vector<std::string> words = {
        "massage", "--quiet",    "--programme", brief,          "--seed",     "7",
        "--out",   folder / out, "--person",    "phantom:slim", "--position", "prone"};
    if (processes) words.emplace_back("--processes");
    return run_tuina(words).exit_code;
  };
  REQUIRE(give("one", false) == 0);
  REQUIRE(give("three", true) == 0);
  for (const char* file : {"joints.csv", "trace.csv", "distances.csv"}) {
    CAPTURE(file);
    const auto one = tuina::read_file(std::filesystem::path(folder / "one") / file);
    const auto three = tuina::read_file(std::filesystem::path(folder / "three") / file);
    REQUIRE(one.has_value());
    REQUIRE(three.has_value());
    CHECK(*one == *three);
  }
}

TEST_CASE("whoever of controller and guard is killed, stopped or crashes, the person is safe") {
  const auto outcome = run_tuina({"evaluate", "processes", "--trials", "1", "--json", "--quiet"});
  REQUIRE(outcome.exit_code == 0);
  const json found = json::parse(outcome.out)["processes"];
  CHECK(found["trials"] == 6);
  CHECK(found["held"] == 6);
  for (const json& row : found["rows"]) {
    CAPTURE(row.dump());
    CHECK(row["force_before_n"] > 8.0);
    CHECK(row["max_force_n"] < 60.0);
    if (row["process"] == "guard") continue;
    CHECK(row["first_action_ms"] <= 10.0);
    CHECK(row["released_ms"] < 250.0);
  }
}

TEST_CASE("what is no arming file, or one that is cut or spoilt, arms no guard") {
  const Folder folder;
  const std::string junk = folder.with("junk.arming", std::string(100, 'x'));
  const auto told = [&](const std::string& file) {
    const auto outcome = run_tuina({"guard", "--arm", file, "--link", "nobody"});
    CHECK(outcome.exit_code != 0);
    return outcome.err;
  };
  CHECK(told(junk).find("is no arming file") != std::string::npos);
  CHECK(told(folder / "missing").find("missing") != std::string::npos);
}
