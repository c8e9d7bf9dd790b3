// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <nlohmann/json.hpp>

#include "tests/whole/command.hpp"
#include "tuina/core/io/file.hpp"

using nlohmann::json;
using tuina::test::Folder;
using tuina::test::run_tuina;

TEST_CASE("a table of evaluate control is one object, its page and its figures are whole") {
  const Folder folder;
  const auto outcome = run_tuina({"evaluate", "control", "--table", "taps", "--json", "--quiet",
                                  "--html", folder / "control.html", "--figures", folder / "."});
  REQUIRE_MESSAGE(outcome.exit_code == 0, outcome.err);
  const json taps = json::parse(outcome.out)["control"]["taps"];
  REQUIRE(taps.size() == 6);
  for (const json& row : taps) {
    CHECK(row["stopped"] == 0);
    CHECK(row["runs"] == 3);
    CHECK(row["rmse_n"] < 2.0);  // the bound on the rate of a tap's force
  }
  const std::string page = tuina::read_file(folder / "control.html").value();
  CHECK(page.find("Taps") != std::string::npos);
  CHECK(page.ends_with("</html>\n"));
  CHECK(tuina::read_file(folder / "control_press.svg").value().ends_with("</svg>"));
}

TEST_CASE("evaluate control refuses a table it does not have and a folder that is not there") {
  const Folder folder;
  CHECK(run_tuina({"evaluate", "control", "--table", "chairs"}).exit_code == 1);
  const auto nowhere =
      run_tuina({"evaluate", "control", "--table", "taps", "--html", folder / "no/c.html"});
  CHECK(nowhere.exit_code == 2);
  CHECK(nowhere.out.empty());
}

TEST_CASE("a robot is exported to a file or to stdout, the successor with all its joints") {
  const Folder folder;
  const auto file = run_tuina({"export", "urdf", "--robot", "successor", "--json", "--quiet",
                               "--out", folder / "robot.urdf"});
  REQUIRE_MESSAGE(file.exit_code == 0, file.err);
  CHECK(json::parse(file.out)["joints"] == 26);
  const std::string urdf = tuina::read_file(folder / "robot.urdf").value();
  CHECK(urdf.starts_with("<?xml"));
  CHECK(urdf.find("left_wrist_yaw") != std::string::npos);
  CHECK(urdf.ends_with("</robot>\n"));
  const auto stream = run_tuina({"export", "mjcf", "--quiet"});
  CHECK(stream.exit_code == 0);
  const auto loud = run_tuina({"export", "mjcf"});
  CHECK(loud.out.starts_with("<mujoco"));
  CHECK(loud.out.find("right_wrist") != std::string::npos);
  CHECK(run_tuina({"export", "urdf", "--robot", "toaster"}).exit_code == 1);
  CHECK(run_tuina({"export", "urdf", "--out", folder / "no/robot.urdf"}).exit_code == 2);
}
