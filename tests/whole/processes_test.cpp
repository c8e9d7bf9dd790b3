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

namespace {

/// Gives the same brief massage in one process and in three; the folders `one` and `three`.
void give_both(const Folder& folder, int repeats, const std::vector<std::string>& more) {
  const std::string brief = folder.with(
      "brief.toml",
      "name = \"brief\"\n[[part]]\ntechnique = \"press\"\npoints = [\"BL47\"]\nrepeats = " +
          std::to_string(repeats) + "\n");
  for (const char* out : {"one", "three"}) {
    std::vector<std::string> words = {
        "massage", "--quiet",    "--programme", brief,          "--seed",     "7",
        "--out",   folder / out, "--person",    "phantom:slim", "--position", "prone"};
    words.insert(words.end(), more.begin(), more.end());
    if (out == std::string("three")) words.emplace_back("--processes");
    const auto outcome = run_tuina(words);
    REQUIRE_MESSAGE(outcome.exit_code == 0, outcome.err);
  }
}

void same_to_the_last_bit(const Folder& folder) {
  for (const char* file : {"joints.csv", "trace.csv", "distances.csv"}) {
    CAPTURE(file);
    const auto one = tuina::read_file(std::filesystem::path(folder / "one") / file);
    const auto three = tuina::read_file(std::filesystem::path(folder / "three") / file);
    REQUIRE(one.has_value());
    REQUIRE(three.has_value());
    CHECK(*one == *three);
  }
}

}  // namespace

TEST_CASE("a session in three processes is the session in one, to the last bit") {
  const Folder folder;
  give_both(folder, 1, {});
  same_to_the_last_bit(folder);
}

TEST_CASE("a person who moves is scanned again, and a new guard takes over, to the last bit") {
  const Folder folder;
  give_both(folder, 1, {"--set", "simulation.shift_mm=20", "--set", "simulation.shift_at_s=5"});
  same_to_the_last_bit(folder);
  for (const char* out : {"one", "three"}) {
    const json session =
        json::parse(tuina::read_file(std::filesystem::path(folder / out) / "session.json").value());
    CHECK(session["rescans_s"].size() == 1);
    CHECK(session["stops"].empty());
  }
}

TEST_CASE("whatever befalls controller, guard or machine, the person is safe") {
  const auto outcome =
      run_tuina({"evaluate", "processes", "--trials", "1", "--blow", "kill -9", "SIGSTOP",
                 "segmentation fault", "no memory", "processors hogged", "--json", "--quiet"});
  REQUIRE_MESSAGE(outcome.exit_code == 0, outcome.err);
  const json found = json::parse(outcome.out)["processes"];
  CHECK(found["trials"] == 9);
  CHECK(found["held"] == 9);
  for (const json& row : found["rows"]) {
    CAPTURE(row.dump());
    CHECK(row["force_before_n"] > 8.0);
    CHECK(row["max_force_n"] < 60.0);
    const bool is_gone = row["blow"] != "no memory" && row["blow"] != "processors hogged";
    if (row["process"] == "guard" || !is_gone) continue;
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
