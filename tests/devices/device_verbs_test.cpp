// SPDX-License-Identifier: Apache-2.0
// `tuina press` and `tuina teach` by the arms of a device file, which are another program, over
// UDP.
#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/devices/armlink_stage.hpp"
#include "tuina/core/io/file.hpp"

using nlohmann::json;
using namespace tuina::test;

namespace {

const Words person = {"--person", "phantom:slim", "--seed", "7"};
const Words prone = person + Words{"--position", "prone"};
const Words quiet = {"--json", "--quiet"};

std::string text_of(const std::string& file) {
  return tuina::read_file(file, 1 << 24).value_or("");
}

/// Largest value of a column of a trace.
double max_of(const std::string& csv, std::size_t column) {
  std::istringstream rows(csv);
  std::string row, cell;
  std::getline(rows, row);
  double max = 0.0;
  while (std::getline(rows, row)) {
    std::istringstream cells(row);
    for (std::size_t i = 0; i <= column; ++i) std::getline(cells, cell, ',');
    max = std::max(max, std::stod(cell));
  }
  return max;
}

}  // namespace

TEST_CASE("an acupoint of the person before the arms is pressed with the force that is asked for") {
  const Folder folder;
  const int port = own_port();
  const std::string device = device_file(folder, port);
  const Words press = Words{"press", "--device", device, "--force-n", "15", "--duration-s", "8"};
  const Outcome alone = run_tuina(press + prone + quiet);
  CHECK(alone.exit_code == 3);
  CHECK(alone.out.empty());
  CHECK_MESSAGE(alone.err.find("nobody answers") != std::string::npos, alone.err);
  Arms arms(port, prone);
  REQUIRE(is_there(device));
  const Outcome stranger =
      run_tuina(press + quiet + Words{"--person", "phantom:slim", "--position", "prone"});
  CHECK(stranger.exit_code == 3);
  CHECK_MESSAGE(stranger.err.find("the arms are before") != std::string::npos, stranger.err);
  const Outcome done =
      run_tuina(press + prone + quiet + Words{"--at", "BL47_R", "--out", folder / "trace.csv"});
  REQUIRE_MESSAGE(done.exit_code == 0, done.err);
  CHECK(arms.end().exit_code == 0);
  const json pressed = json::parse(done.out);
  MESSAGE(pressed.dump());
  CHECK(pressed["ordered_n"].get<double>() == doctest::Approx(15.0));
  CHECK(pressed["lowered_by"] == "");
  CHECK(pressed["force"]["rmse_n"].get<double>() < 1.0);
  CHECK(pressed["force"]["peak_n"].get<double>() == doctest::Approx(15.0).epsilon(0.1));
  for (const char* law : {"alpha_n", "beta_per_mm"})
    CHECK(pressed["estimate"][law].get<double>() ==
          doctest::Approx(pressed["true"][law].get<double>()).epsilon(0.5));  // two presses
  CHECK(pressed["stops"].empty());
  CHECK(pressed["devices"]["arms"].get<std::string>().find(std::to_string(port + 1)) !=
        std::string::npos);
  const std::string trace = text_of(folder / "trace.csv");
  CHECK(trace.starts_with("time_s,target_n,true_force_n,measured_force_n,depth_mm\n"));
  CHECK(max_of(trace, 1) == doctest::Approx(14.7));  // a light press aims so much below its order
  CHECK(max_of(trace, 2) ==
        doctest::Approx(pressed["force"]["peak_n"].get<double>()).epsilon(0.05));
}

TEST_CASE("what a press on a device cannot be is refused before any arm is asked") {
  const Folder folder;
  const Words press = Words{"press", "--device", device_file(folder, own_port())} + prone;
  const auto refused = [&](const Words& words, const std::string& why) {
    const Outcome outcome = run_tuina(press + words);
    CHECK_MESSAGE(outcome.exit_code == 1, outcome.err);
    CHECK_MESSAGE(outcome.err.find(why) != std::string::npos, outcome.err);
  };
  refused({"--force-n", "15", "--tissue", "soft"}, "excludes");
  refused({"--force-n", "15", "--rise-mm", "30"}, "excludes");
  refused({"--force-n", "15", "--at", "BL99_L"}, "--at BL99_L: is none of");
  refused({"--force-n", "2"}, "--force-n 2");
  refused({"--force-n", "15", "--technique", "stroke"}, "--technique stroke");
  refused({"--force-n", "15", "--duration-s", "90"}, "--duration-s 90");
  CHECK(run_tuina({"press", "--force-n", "15", "--at", "BL47_L"}).exit_code == 1);
  const Words missing = {"press", "--force-n", "15", "--device", folder / "none.toml"};
  CHECK(run_tuina(missing).exit_code == 2);
}

TEST_CASE("what a hand shows to an arm over UDP, and how it plays, is that of one program") {
  const Folder folder;
  const auto record = [&](const std::string& to, const Words& more) {
    return run_tuina(Words{"teach", "record", "--out", folder / to} + person + quiet + more);
  };
  const Outcome here = record("here.toml", {});
  REQUIRE_MESSAGE(here.exit_code == 0, here.err);
  const int port = own_port();
  const std::string device = device_file(folder, port);
  const Outcome alone = record("alone.toml", {"--device", device});
  CHECK(alone.exit_code == 3);
  CHECK_FALSE(std::filesystem::exists(folder / "alone.toml"));
  {
    Arms arms(port, person + Words{"--hand", "stroke"});
    REQUIRE(is_there(device));
    const Outcome there = record("there.toml", {"--device", device});
    REQUIRE_MESSAGE(there.exit_code == 0, there.err);
    CHECK(arms.end().exit_code == 0);
    CHECK(json::parse(there.out)["peak_hand_n"].is_null());
    CHECK(json::parse(there.out)["contact_s"] == json::parse(here.out)["contact_s"]);
  }
  const std::string shown = text_of(folder / "here.csv");
  CHECK(shown.size() > 10'000);
  CHECK(text_of(folder / "there.csv") == shown);

  const Words play = Words{"teach", "play", folder / "here.toml"} + person + quiet;
  const Outcome one = run_tuina(play);
  REQUIRE_MESSAGE(one.exit_code == 0, one.err);
  Arms arms(port, person);
  REQUIRE(is_there(device));
  const Outcome far = run_tuina(play + Words{"--device", device});
  REQUIRE_MESSAGE(far.exit_code == 0, far.err);
  CHECK(arms.end().exit_code == 0);
  const json played = json::parse(far.out), in_one = json::parse(one.out);
  MESSAGE(played.dump());
  CHECK(played == in_one);
}
