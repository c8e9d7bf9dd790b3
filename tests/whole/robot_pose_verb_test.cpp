// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/whole/command.hpp"

using nlohmann::json;
using tuina::test::Folder;
using tuina::test::run_tuina;

TEST_CASE("a robot that has touched a board is placed to a millimetre or two") {
  const Folder folder;
  const std::string touches = folder / "touches", pose = folder / "robot.toml";
  REQUIRE(run_tuina({"calibrate", "--robot", "--rehearse", touches, "--quiet"}).exit_code == 0);
  const auto found = run_tuina({"calibrate", touches, "--robot", "--out", pose, "--json"});
  REQUIRE(found.exit_code == 0);
  const json result = json::parse(found.out);
  CHECK(result["touches"] == 12);
  CHECK(result["residual_rms_mm"].get<double>() < 3.0);
  CHECK(result["expected_error_mm"]["BL47_L"].get<double>() < 2.0);

  // For a person in the other position it says nothing.
  const auto prone = run_tuina({"massage", "--position", "prone", "--robot-pose", pose, "--out",
                                folder / "report", "--quiet"});
  CHECK(prone.exit_code == 2);
  CHECK(prone.err.find("for a person sitting, and this one is prone") != std::string::npos);
}

TEST_CASE("touches for the other position, and a folder that is not new, are refused") {
  const Folder folder;
  const std::string touches = folder / "touches", pose = folder / "robot.toml";
  const std::vector<std::string> rehearse = {"calibrate",  "--robot", "--position", "prone",
                                             "--rehearse", touches,   "--quiet"};
  REQUIRE(run_tuina(rehearse).exit_code == 0);
  const auto again = run_tuina(rehearse);
  CHECK(again.exit_code == 2);
  CHECK(again.err.find("there is such a folder already") != std::string::npos);
  const auto sitting = run_tuina({"calibrate", touches, "--robot", "--out", pose});
  CHECK(sitting.exit_code == 2);
  CHECK(sitting.err.find("would lean by 90 degrees") != std::string::npos);
  CHECK_FALSE(std::filesystem::exists(pose));
}
