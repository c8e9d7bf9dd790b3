// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/whole/command.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/sim/person/person.hpp"

using nlohmann::json;
using tuina::test::Folder;
using tuina::test::run_tuina;

TEST_CASE("what a hand has shown is played to the same person, and not to one of another build") {
  const Folder folder;
  const std::string file = folder / "stroke.toml";
  const auto taught = run_tuina({"teach", "record", "--out", file, "--json", "--quiet"});
  REQUIRE_MESSAGE(taught.exit_code == 0, taught.err);
  const json shown = json::parse(taught.out);
  CHECK(shown["contact_s"].get<double>() > 5.0);
  CHECK(shown["peak_n"].get<double>() > 8.0);
  CHECK(shown["peak_hand_n"].get<double>() < 45.0);

  const std::string plot = folder / "played.svg";
  const auto played = run_tuina({"teach", "play", file, "--plot", plot, "--json", "--quiet"});
  REQUIRE_MESSAGE(played.exit_code == 0, played.err);
  const json same = json::parse(played.out);
  CHECK(same["stops"].empty());
  CHECK(same["tracking_rms_mm"].get<double>() < 6.0);
  CHECK(same["force"]["rmse_n"].get<double>() < 4.0);
  CHECK(tuina::read_file(plot).value().find("<svg") != std::string::npos);

  // In joint space it knows nothing of the person: on a broader back the guard has to end it.
  const auto other =
      run_tuina({"teach", "play", file, "--person", "phantom:hefty", "--json", "--quiet"});
  CHECK(other.exit_code == 4);
  const json stopped = json::parse(other.out);
  CHECK(stopped["stops"].size() == 1);
  CHECK(stopped["force"]["peak_n"].get<double>() < 45.0);

  // Carried over the map of the back, the session's own way of pressing gives it to the same
  // person.
  const std::string programme = folder / "carried.toml";
  REQUIRE(run_tuina({"teach", "carry", file, "--out", programme}).exit_code == 0);
  const auto carried = run_tuina({"massage", "--programme", programme, "--person", "phantom:hefty",
                                  "--out", folder / "report", "--json", "--quiet"});
  REQUIRE_MESSAGE(carried.exit_code == 0, carried.err);
  const json given = json::parse(carried.out);
  CHECK(given["massage"]["performed"].size() == 2);
  CHECK(given["massage"]["force"]["rmse_n"].get<double>() < 0.6);
  // The stroke was shown from SI11 to BL50: on this back, too, it passes them.
  const json plan = json::parse(tuina::read_file(folder / "report/plan.json").value());
  const auto person =
      tuina::sim::parse_person("phantom:hefty", tuina::BodyPosture::sitting, 1).value();
  for (const tuina::Acupoint& point : person.acupoints) {
    if (point.name != "SI11_L" && point.name != "BL47_L" && point.name != "BL50_L") continue;
    double nearest_m = 1.0;
    for (const json& path : plan["paths"]) {
      for (const json& place : path["points"]) {
        const auto at = place["position_m"].get<std::vector<double>>();
        nearest_m =
            std::min(nearest_m, (tuina::Vector3(at[0], at[1], at[2]) - point.at_in_couch).norm());
      }
    }
    MESSAGE(point.name, ": the carried stroke passes it by ", 1e3 * nearest_m, " mm");
    CHECK(nearest_m < 25e-3);
  }

  const auto seen = run_tuina({"teach", "show", file, "--json"});
  CHECK(seen.exit_code == 0);
  CHECK(json::parse(seen.out)["name"] == shown["name"]);
}

TEST_CASE("teach refuses what it cannot use") {
  const Folder folder;
  CHECK(run_tuina({"teach", "record", "--out", folder / "stroke.csv"}).exit_code == 1);
  CHECK(run_tuina({"teach", "record", "--out", folder / "no/stroke.toml"}).exit_code == 2);
  CHECK(
      run_tuina({"teach", "record", "--technique", "tap", "--out", folder / "a.toml"}).exit_code ==
      1);
  CHECK(run_tuina({"teach", "play", folder / "nothing.toml"}).exit_code == 2);
  CHECK(run_tuina({"teach", "show"}).exit_code == 1);
  CHECK(run_tuina({"teach", "carry", folder / "nothing.toml", "--out", folder / "b.toml"})
            .exit_code == 2);
}

TEST_CASE("a taught stroke that no programme may ask for is not written as one") {
  const Folder folder;
  std::string csv = "time_s,q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg,force_n\n";
  for (int i = 0; i < 60; ++i) csv += fmt::format("{:.2f},0,0,0,0,0,0,0\n", 0.01 * i);
  REQUIRE(tuina::write_file(folder / "rest.csv", csv).has_value());
  const auto carry = [&](const char* line, double force_n) {
    const std::string file = folder.with(
        "rest.toml",
        fmt::format("name = \"rest\"\nposition = \"sitting\"\narm = \"left\"\nrail_mm = 0\n"
                    "zone = \"muscle\"\nsamples = \"rest.csv\"\nrobot = \"thesis\"\nline = {}\n"
                    "force_n = {}\nspeed_mm_per_s = 60\n",
                    line, force_n));
    return run_tuina({"teach", "carry", file, "--out", folder / "carried.toml"});
  };
  const auto refused = [&](const tuina::test::Outcome& outcome, const char* value) {
    CAPTURE(outcome.err);
    CHECK(outcome.exit_code == 2);
    CHECK(outcome.err.find("rest.toml: cannot be carried") != std::string::npos);
    CHECK(outcome.err.find(value) != std::string::npos);
    CHECK_FALSE(std::filesystem::exists(folder / "carried.toml"));
  };
  refused(carry("[[3.0, 0.8], [3.0, 0.2]]", 900.0), "force_n = 900");
  refused(carry("[[3.0, 0.8], [9.5, 0.2]]", 12.0), "[9.5, 0.2]: a place is");
  CHECK(carry("[[3.0, 0.8], [3.0, 0.2]]", 12.0).exit_code == 0);
}

TEST_CASE("shown to a person a stroke is exact, planned it is quick and even") {
  const auto done = run_tuina({"evaluate", "teach", "--people", "1", "--json", "--quiet"});
  REQUIRE_MESSAGE(done.exit_code == 0, done.err);
  const json people = json::parse(done.out)["teach"]["people"];
  REQUIRE(people.size() == 1);
  for (const char* way : {"taught", "carried", "automatic"}) {
    CAPTURE(way);
    REQUIRE_FALSE(people[0][way].contains("failed"));
    CHECK(people[0][way]["passes_mm"] < (std::string(way) == "carried" ? 20.0 : 8.0));
  }
  CHECK(people[0]["taught"]["time_s"] > people[0]["automatic"]["time_s"]);
  CHECK(people[0]["taught"]["force_rmse_n"] > people[0]["automatic"]["force_rmse_n"]);
  CHECK(run_tuina({"evaluate", "teach", "--people", "0"}).exit_code == 1);
}
