// SPDX-License-Identifier: Apache-2.0
// The record of a massage: what it holds, and that other verbs and other programs read it.
#include <doctest/doctest.h>
#include <sys/wait.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "tests/whole/command.hpp"
#include "tuina/core/io/csv.hpp"
#include "tuina/core/io/file.hpp"

using nlohmann::json;
using tuina::test::Folder;
using tuina::test::run_tuina;

namespace {

/// One short massage, looked at by several tests.
struct Given {
  Folder folder;
  std::string out = folder / "out", record = out + "/session.mcap";
  json session, shown;

  Given() {
    const std::string brief =
        folder.with("brief.toml",
                    "name = \"brief\"\n[[part]]\ntechnique = \"press\"\nrepeats = 1\n"
                    "points = [\"BL47\"]\n");
    const auto outcome =
        run_tuina({"massage", "--programme", brief, "--json", "--quiet", "--out", out});
    REQUIRE_MESSAGE(outcome.exit_code == 0, outcome.err);
    session = json::parse(outcome.out);
    const auto show = run_tuina({"record", "show", record, "--json"});
    REQUIRE_MESSAGE(show.exit_code == 0, show.err);
    shown = json::parse(show.out);
  }
  [[nodiscard]] std::uint64_t messages(const std::string& topic) const {
    for (const json& one : shown["channels"])
      if (one["topic"] == topic) return one["messages"];
    return 0;
  }
};

const Given& given() {
  static const Given massage;
  return massage;
}

/// What a reader of others says of a record; null where it is not installed.
json read_by(const std::string& script, const std::string& record) {
  const Folder folder;
  const std::string command =
      "node " TUINA_READERS "/" + script + " '" + record + "' >'" + (folder / "out") + "' 2>&1";
  const int status = std::system(command.c_str());
  const std::string said = tuina::read_file(folder / "out").value();
  constexpr int no_such_program = 127, not_installed = 77;
  if (WEXITSTATUS(status) == no_such_program || WEXITSTATUS(status) == not_installed) {
    MESSAGE("skipped: ", said, "install node 20, then: npm ci --prefix " TUINA_READERS);
    return nullptr;
  }
  REQUIRE_MESSAGE(status == 0, said);
  return json::parse(said);
}

}  // namespace

TEST_CASE("a massage leaves one record of every millisecond and all that happened") {
  const Given& massage = given();
  CHECK(massage.shown["whole"] == true);
  CHECK(massage.shown["lost"].empty());
  CHECK(massage.shown["missing_ms"] == 0);
  const double duration_s = massage.session["massage"]["duration_s"];
  CHECK(massage.shown["duration_s"].get<double>() == doctest::Approx(duration_s));
  const auto ms = static_cast<std::uint64_t>(std::llround(1e3 * duration_s)) + 1;
  CHECK(massage.messages("/joint_states") == ms);
  CHECK(massage.messages("/tools") == ms);
  CHECK(massage.messages("/profile") > 50);
  CHECK(massage.messages("/scan") == 1);
  CHECK(massage.messages("/acupoints") == 1);
  CHECK(massage.messages("/plan") == 1);
  CHECK(massage.messages("/tuina/contacts") == massage.session["massage"]["performed"].size());
  CHECK(massage.messages("/tuina/decisions") == massage.session["decisions"].size());
  CHECK(massage.messages("/tuina/stops") == massage.session["stops"].size());
  CHECK(massage.messages("/tuina/arms") > 2 * 19 * static_cast<std::uint64_t>(duration_s));
  std::set<std::string> attached;
  for (const json& one : massage.shown["attachments"]) attached.insert(one["name"]);
  CHECK(attached == std::set<std::string>{"acupoints.json.zst", "calibration.toml", "config.toml",
                                          "consent.toml", "distances.csv.zst", "joints.csv.zst",
                                          "plan.json.zst", "programme.toml", "report.html.zst",
                                          "robot.urdf", "scan.ply.zst", "session.json.zst",
                                          "trace.csv.zst"});
}

TEST_CASE("report and replay take the record for the folder that it lies in") {
  const Given& massage = given();
  const std::string page = massage.folder / "again.html";
  const auto report = run_tuina({"report", massage.record, "--out", page});
  REQUIRE_MESSAGE(report.exit_code == 0, report.err);
  CHECK(tuina::read_file(page).value() == tuina::read_file(massage.out + "/report.html").value());
  const auto again =
      run_tuina({"massage", "--replay", massage.record, "--out", massage.folder / "again"});
  REQUIRE_MESSAGE(again.exit_code == 0, again.err);
  CHECK(again.err.find("as recorded") != std::string::npos);
  CHECK(run_tuina({"massage", "--replay", massage.record, "--out", massage.out}).exit_code == 1);
}

TEST_CASE("the channels come out as tables that agree with those of the folder") {
  const Given& massage = given();
  const std::string tables = massage.folder / "tables";
  const auto outcome = run_tuina({"export", "csv", massage.record, "--out", tables, "--json"});
  REQUIRE_MESSAGE(outcome.exit_code == 0, outcome.err);
  const json answer = json::parse(outcome.out);
  CHECK(answer["lost"].empty());
  for (const json& one : answer["files"])
    CHECK(std::filesystem::exists(std::filesystem::path(tables) / one["file"]));
  const auto each = tuina::read_csv(tables + "/joint_states.csv",
                                    {"time_s", "rail_joint_m", "left_shoulder_pitch_joint_rad"});
  REQUIRE(each.has_value());
  CHECK(each->rows() == massage.messages("/joint_states"));
  const auto some = tuina::read_csv(massage.out + "/joints.csv", {"time_s", "left_q1_deg"});
  REQUIRE(some.has_value());
  for (std::size_t i = 0; i < some->rows(); ++i) {
    const auto row = static_cast<std::size_t>(std::llround(1e3 * some->columns[0][i]));
    REQUIRE(each->columns[0][row] == doctest::Approx(some->columns[0][i]));
    CHECK(std::abs(each->columns[2][row] * 180.0 / M_PI - some->columns[1][i]) < 5e-3);
  }
  const auto contacts = tuina::read_csv(tables + "/tuina_contacts.csv", {"time_s", "end_s"});
  REQUIRE(contacts.has_value());
  CHECK(contacts->rows() == massage.messages("/tuina/contacts"));
}

TEST_CASE("a record that was cut off is shown as far as it is whole, and is no finished session") {
  const Given& massage = given();
  const std::string bytes = tuina::read_file(massage.record).value();
  const Folder folder;
  const std::string cut = folder.with("cut.mcap", bytes.substr(0, bytes.size() / 3));
  const auto show = run_tuina({"record", "show", cut, "--json"});
  REQUIRE_MESSAGE(show.exit_code == 0, show.err);
  const json shown = json::parse(show.out);
  CHECK(shown["whole"] == false);
  CHECK_FALSE(shown["lost"].empty());
  CHECK(shown["messages"] > 1000);
  CHECK(run_tuina({"record", "show", cut}).err.find("lost: ") != std::string::npos);
  const auto report = run_tuina({"report", cut, "--out", folder / "page.html"});
  CHECK(report.exit_code == 2);
  CHECK(report.err.find("cut.mcap: holds no session.json") != std::string::npos);
  CHECK_FALSE(std::filesystem::exists(folder / "page.html"));
  CHECK(run_tuina({"export", "csv", cut, "--out", folder / "tables"}).exit_code == 0);
  const std::string none = folder.with("none.mcap", "time_s\n");
  CHECK(run_tuina({"record", "show", none}).err.find("none.mcap: is no MCAP file") !=
        std::string::npos);
  CHECK(run_tuina({"export", "csv", none, "--out", folder / "none"}).exit_code == 2);
  CHECK_FALSE(std::filesystem::exists(folder / "none"));
}

TEST_CASE("the readers of others read the record whole, with every checksum and definition") {
  const Given& massage = given();
  const json read = read_by("read_mcap.mjs", massage.record);
  if (read.is_null()) return;
  CHECK(read["streamed"] == massage.shown["messages"]);
  CHECK(read["within_a_second"] == 1000);
  CHECK(read["definitions"] > 20);
  REQUIRE(read["topics"].size() == massage.shown["channels"].size());
  for (const json& one : massage.shown["channels"]) {
    const json& other = read["topics"][one["topic"].get<std::string>()];
    CHECK(other["messages"] == one["messages"]);
    CHECK(other["schema"] == one["schema"]);
  }
  REQUIRE(read["attachments"].size() == massage.shown["attachments"].size());
  const json& last = read["topics"]["/joint_states"]["last"];
  CHECK(last["name"][0] == "rail_joint");
  CHECK(last["position"].size() == 13);
  const double end_s = massage.shown["end_s"];
  CHECK(last["header"]["stamp"]["sec"] == static_cast<int>(end_s));
}

TEST_CASE("the robot in a record stands in urdf-loader, its tools where the record has them") {
  const json robot = read_by("read_urdf.mjs", given().record);
  if (robot.is_null()) return;
  CHECK(robot["links"] == 17);
  CHECK(robot["shapes"] == 25);
  REQUIRE(robot["joints"].size() == 13);
  CHECK(robot["joints"]["rail_joint"]["type"] == "prismatic");
  const json& elbow = robot["joints"]["left_elbow_joint"];
  CHECK(elbow["type"] == "revolute");
  CHECK(elbow["upper"].get<double>() == doctest::Approx(M_PI / 3.0));
  CHECK(robot["compared"] > 100);
  // Joints and tools are rounded: docs/record.md.
  CHECK(robot["off_m"] < 1e-3);
}
