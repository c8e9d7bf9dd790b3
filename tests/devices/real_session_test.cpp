// SPDX-License-Identifier: Apache-2.0
// `tuina massage --device` with nothing simulated in it: the scanner is a camera and a board at
// their wires, the arms are another program behind a network. That these are emulated, the session
// does not know.
#include <doctest/doctest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/devices/armlink_stage.hpp"
#include "tests/devices/child.hpp"
#include "tests/devices/whole_scanner.hpp"
#include "tests/reason.hpp"
#include "tuina/robot/robot_model.hpp"
#include "tuina/session/consent.hpp"
#include "tuina/session/robot_pose.hpp"

using namespace tuina;
using nlohmann::json;
using test::Folder;
using test::Outcome;
using test::Scanned;
using test::Words;
using test::operator+;

namespace {

const Words person = {"--person", "phantom:slim", "--position", "prone", "--seed", "7"};

const test::Sweep& lying_sweep() {
  static const test::Sweep made(person);
  return made;
}

std::string device_file_of_all(const Folder& folder, int port) {
  const std::string arms = test::text_of(test::device_file(folder, port));
  return folder.with("device.toml", arms + test::scanner_of(folder.path()));
}

/// What a therapist has prepared: answers, and where the robot stands.
std::string prepared(const Folder& folder) {
  const auto thesis = robot::load_robot("thesis");
  REQUIRE_MESSAGE(thesis.has_value(), test::reason(thesis));
  const session::PlacedRobot placed{
      .robot = "thesis",
      .position = BodyPosture::prone,
      .base_from_couch = robot::place_robot(*thesis, BodyPosture::prone).mount.base_from_couch};
  return " --consent " + folder.with("consent.toml", session::consent_form("anna", "no")) +
         " --robot-pose " + folder.with("robot.toml", session::to_toml(placed)) +
         " --calibration " + lying_sweep().calibration("0") + " --out " + folder / "report";
}

std::string turn_words() {
  std::string words;
  for (const std::string& word : test::turn) words += " " + word;
  return words;
}

}  // namespace

TEST_CASE("a massage by one's own scanner and arms is as planned, and claims no truth") {
  if (!test::has_stage) {
    MESSAGE("skipped: ", test::no_stage);
    return;
  }
  const Folder folder;
  const int port = test::own_port();
  test::Arms arms(port, person);
  REQUIRE(test::is_there(test::device_file(folder, port)));
  (void)device_file_of_all(folder, port);
  const Scanned session = test::on_stage(
      folder, lying_sweep(), "massage --quiet" + prepared(folder) + turn_words(), "", 40, "go\n");
  REQUIRE_MESSAGE(session.host.exit_code == 0, session.host.err);
  CHECK(session.host.err.find("the arms move once you type `go`") != std::string::npos);
  CHECK(session.stage["is_lit"] == false);

  const json told = json::parse(session.host.out);
  CHECK(told["person"] == "");
  CHECK(told["realism"] == "real");
  CHECK(told["consent"]["answered_by"] == "anna");
  CHECK(told["scan"]["points"] > 10'000);
  CHECK(told["scan"]["rms_error_mm"].is_null());
  CHECK(told["acupoints"]["mean_error_mm"].is_null());
  CHECK(told["devices"]["scanner"] == folder / "camera" + ", " + folder / "board");
  const double rmse_n = told["massage"]["force"]["rmse_n"];
  MESSAGE(told["massage"]["performed"].size(), " paths, force error ", rmse_n,
          " N RMS as measured");
  CHECK(rmse_n < 0.5);
  REQUIRE(told["massage"]["performed"].size() == 13);
  for (const json& path : told["massage"]["performed"]) {
    CHECK(path["trouble"] == "none");
    CHECK(path["true_peak_n"].is_null());
    const json& compared_n = path["mean_n"].is_null() ? path["given_n"] : path["mean_n"];
    CHECK(compared_n.get<double>() ==
          doctest::Approx(path["ordered_n"].get<double>()).epsilon(0.05));
  }
  for (const json& felt : told["tissue"]) CHECK_FALSE(felt.contains("true_alpha_n"));

  // What those arms know, and the session does not.
  const json truth = json::parse(arms.end().out, nullptr, false);
  REQUIRE(truth.is_object());
  MESSAGE("truly ", truth["max_force_n"].get<double>(), " N at most");
  CHECK(truth["max_force_n"] > 20.0);
  CHECK(truth["max_force_n"] < 25.0);

  const std::string page = test::text_of(folder / "report" + "/report.html");
  CHECK(page.find("A person lay face down") != std::string::npos);
  CHECK(page.find("happened in a simulation") == std::string::npos);
  CHECK(page.find("known only in simulation") == std::string::npos);
  const Outcome again = test::run_tuina(
      {"report", folder / "report" + "/session.mcap", "--out", folder / "again.html"});
  CHECK_MESSAGE(again.exit_code == 0, again.err);
  CHECK(test::text_of(folder / "again.html") == page);
  const Outcome replayed =
      test::run_tuina({"massage", "--replay", folder / "report", "--out", folder / "once_more"});
  CHECK(replayed.exit_code == 2);
  CHECK_MESSAGE(
      replayed.err.find("only a simulated one can be given once more") != std::string::npos,
      replayed.err);
}

TEST_CASE("nobody is touched without answers, calibration, the robot's place and a word") {
  const Folder folder;
  const int port = test::own_port();
  const std::string device = device_file_of_all(folder, port);
  const std::string answers = folder.with("consent.toml", session::consent_form("anna", "no"));
  const auto refused = [&](const Words& more) {
    const Outcome outcome =
        test::run_tuina(Words{"massage", "--device", device, "--out", folder / "report"} + more);
    CHECK(outcome.exit_code == 1);
    CHECK_FALSE(std::filesystem::exists(folder / "report"));
    return outcome.err;
  };
  CHECK(refused({}).find("needs --consent FILE.toml") != std::string::npos);
  CHECK(refused({"--consent", answers}).find("needs --calibration FILE.toml") != std::string::npos);
  CHECK(refused({"--consent", answers, "--calibration", "c.toml"})
            .find("needs --robot-pose FILE.toml") != std::string::npos);
  if (!test::has_stage) {
    MESSAGE("the word was not tried: ", test::no_stage);
    return;
  }
  const tests::Child left({TUINA_ARM_CLIENT, std::to_string(port)}),
      right({TUINA_ARM_CLIENT, std::to_string(port + 1)});
  REQUIRE(test::is_there(test::device_file(folder, port)));
  (void)device_file_of_all(folder, port);
  const Scanned no =
      test::on_stage(folder, lying_sweep(), "massage --quiet" + prepared(folder) + turn_words(), "",
                     40, "yes, go\n");
  CHECK(no.host.exit_code == 4);
  CHECK_MESSAGE(
      no.host.err.find("the plan was not approved, and no arm has moved") != std::string::npos,
      no.host.err);
  CHECK(no.stage["is_lit"] == false);
}
