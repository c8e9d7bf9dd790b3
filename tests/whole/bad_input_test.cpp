// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "tests/whole/command.hpp"
#include "tuina/session/consent.hpp"

using tuina::test::Folder;
using tuina::test::run_tuina;

namespace {

/// Every verb that reads a file, with the file in the place of "FILE".
const std::vector<std::vector<std::string>> readers = {
    {"line", "FILE"},
    {"map", "FILE"},
    {"map", "FILE", "--atlas", "FILE"},
    {"atlas", "show", "FILE"},
    {"plan", "FILE", "FILE"},
    {"plan", "FILE", "FILE", "--programme", "FILE"},
    {"tissue", "fit", "FILE"},
    {"tissue", "estimate", "FILE"},
    {"scan", "--replay", "FILE"},
    {"scan", "--person", "FILE"},
    {"massage", "--person", "FILE", "--out", "OUT"},
    {"massage", "--programme", "FILE", "--out", "OUT"},
    {"massage", "--atlas", "FILE", "--out", "OUT"},
    {"massage", "--replay", "FILE", "--out", "OUT"},
    {"report", "FILE", "--out", "OUT"},
    {"record", "show", "FILE"},
    {"export", "csv", "FILE", "--out", "OUT"},
    {"evaluate", "acupoints", "--bodies", "FILE"},
    {"evaluate", "acupoints", "--atlas", "FILE"}};

void refuse_everywhere(const std::string& file, const std::string& out) {
  for (auto arguments : readers) {
    for (std::string& word : arguments) {
      if (const auto at = word.find("FILE"); at != std::string::npos) word.replace(at, 4, file);
      if (word == "OUT") word = out;
    }
    arguments.push_back("--json");
    CAPTURE(arguments);
    const auto start = std::chrono::steady_clock::now();
    const auto outcome = run_tuina(arguments);
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    CHECK(outcome.exit_code == 2);
    CHECK(outcome.out.empty());
    CHECK(outcome.err.find("tuina: ") != std::string::npos);
    // A message has at most 300 letters; the progress of the work before it is the rest.
    CHECK(outcome.err.size() < 400);
    CHECK(took.count() < 20.0);  // 2 s on a machine with nothing else to do, without sanitizers
    CHECK_FALSE(std::filesystem::exists(out));
  }
}

}  // namespace

TEST_CASE("a file that is not there, empty or a device is refused by every verb that reads one") {
  const Folder folder;
  refuse_everywhere(folder / "none.x", folder / "out");
  refuse_everywhere(folder.with("empty.x", ""), folder / "out");
  refuse_everywhere("/dev/null", folder / "out");
}

TEST_CASE("what is wrong is said in at most 300 letters, without the words of a library") {
  const Folder folder;
  std::string keys, answers = "answered_by = \"anna\"\n[answers]\n";
  for (int i = 0; i < 60; ++i) keys += "unknown_key_" + std::to_string(i) + " = 1\n";
  const std::string words(2000, 'x');
  std::string yes;
  for (const auto& question : tuina::session::health_questions)
    yes += std::string(question.key) + " = \"yes\"\n";
  const std::string cut = folder.with("cut.json", "{\"acupoints\": {\"GV4\": ");
  const std::string none = folder.with("none.json", "");
  const std::string wrong = folder.with("wrong.json", "{\"position\": 3, \"acupoints\": []}");
  std::string labels =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n"
      "property float y\nproperty float z\nelement face 1\n"
      "property list uchar int vertex_indices\nend_header\n"
      "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  std::vector<std::vector<std::string>> commands = {
      {"config", "check", folder.with("keys.toml", "[scan]\n" + keys)},
      {"config", "check", folder.with("cut.toml", "[scan]\nsweep_s = [1, 2\n")},
      {"config", "check", folder.with("equals.toml", "[scan]\nsweep_s == 3\n")},
      {"config", "check", folder.with("long.toml", words)},
      {"config", "show", "--set", "scan.sweep_s=[" + words},
      {"config", "show", "--set", words},
      {"config", "show", "--seed", words},
      {"massage", "--consent", folder.with("answers.toml", answers), "--out", folder / "out"},
      {"massage", "--consent", folder.with("keys2.toml", answers + keys), "--out", folder / "out"},
      {"massage", "--consent", folder.with("yes.toml", answers + yes), "--out", folder / "out"},
      {"massage", "--programme", folder.with("programme.toml", keys), "--out", folder / "out"},
      {"massage", "--robot", folder.with("robot.toml", keys), "--out", folder / "out"},
      {"massage", "--robot", words, "--out", folder / "out"},
      {"massage", "--replay", folder / "out"},
      {"map", words},
      {"map", folder.with("a.ply", labels), "--method", words},
      {"robot", "show", words}};
  for (const std::string& json : {cut, none, wrong}) {
    static_cast<void>(folder.with("person.ply", labels));
    std::filesystem::copy_file(json, folder / "person.json",
                               std::filesystem::copy_options::overwrite_existing);
    const std::string person = folder / "person.ply";
    commands.push_back({"plan", folder.with("b.ply", labels), json});
    commands.push_back({"scan", "--person", person});
    commands.push_back({"atlas", "learn", person, "--out", folder / "x.tuina"});
    for (const auto& arguments : commands) {
      CAPTURE(arguments);
      const auto outcome = run_tuina(arguments);
      CHECK(outcome.exit_code != 0);
      CHECK(outcome.out.empty());
      CAPTURE(outcome.err);
      CHECK(outcome.err.size() <= std::string("tuina: \nSee `tuina --help`.\n").size() + 300);
      for (const char* innards : {"json.exception", "parse error", "Error while parsing", "toml::"})
        CHECK(outcome.err.find(innards) == std::string::npos);
    }
    commands.clear();
  }
}

TEST_CASE("a setting that is none is told by every verb, also by one that needs none") {
  const Folder folder;
  const std::vector<std::vector<std::string>> commands = {{"map", folder.with("a.ply", "x")},
                                                          {"history", "show"},
                                                          {"doctor"},
                                                          {"robot", "show", "thesis"}};
  const std::vector<std::pair<std::vector<std::string>, int>> wrong = {
      {{"--set", "foo.bar=1"}, 1},
      {{"--set", "scan.sweep_s=nan"}, 1},
      {{"--config", "/nowhere.toml"}, 2}};
  for (auto words : commands) {
    for (const auto& [more, code] : wrong) {
      auto all = words;
      all.insert(all.end(), more.begin(), more.end());
      CAPTURE(all);
      const auto outcome = run_tuina(all);
      CHECK(outcome.exit_code == code);
      CHECK(outcome.out.empty());
    }
  }
}

TEST_CASE("a cloud whose name says another format than --format is not written") {
  const Folder folder;
  const auto outcome = run_tuina(
      {"scan", "--person", "phantom:medium", "--out", folder / "a.ply", "--format", "pcd"});
  CHECK(outcome.exit_code == 1);
  CHECK_FALSE(std::filesystem::exists(folder / "a.ply"));
}

TEST_CASE("an answer that cannot be written is refused before the work, not after it") {
  const Folder folder;
  for (const std::string& out : {folder / "none/a.json", folder / ""}) {
    const auto outcome = run_tuina({"plan", "none.ply", "none.json", "--out", out});
    CHECK(outcome.exit_code == 2);
    CHECK_MESSAGE(outcome.err.find("folder") != std::string::npos, outcome.err);
  }
}

TEST_CASE("300 MB of nothing are refused by every verb in less than 512 MB of memory") {
  const Folder folder;
  const std::string path = folder.with("large.x", "");
  std::filesystem::resize_file(path, std::uintmax_t{300} << 20);
  refuse_everywhere(path, folder / "out");
  refuse_everywhere("/dev/zero", folder / "out");
  struct rusage used {};
  REQUIRE(getrusage(RUSAGE_CHILDREN, &used) == 0);
#ifndef __SANITIZE_ADDRESS__  // whose shadow memory is many times that of the program
  CHECK(used.ru_maxrss < 512 * 1024);
#endif
}

TEST_CASE("a full disk behind stdout is an error and not an abort") {
  for (const std::string verb : {"doctor", "config show"}) {
    const std::string command = "'" TUINA_BINARY "' " + verb + " --json >/dev/full 2>/dev/null";
    const int status = std::system(command.c_str());
    CHECK(WIFEXITED(status));
    CHECK(WEXITSTATUS(status) == 2);
  }
}

TEST_CASE("a report folder that cannot be made is refused before the massage") {
  const auto outcome = run_tuina({"massage", "--out", "/dev/null/report", "--json"});
  CHECK(outcome.exit_code == 2);
  CHECK(outcome.err.find("scan") == std::string::npos);
}

TEST_CASE("serve does not begin with a folder in which no page is") {
  const Folder folder;
  const auto outcome =
      run_tuina({"serve", "--port", "0", "--page", folder / "", "--out", folder / "sessions"});
  CHECK(outcome.exit_code == 2);
  CHECK(outcome.err.find("no page.js is in this folder") != std::string::npos);
}

TEST_CASE("a page for which there is no folder is refused before the evaluation, not after it") {
  const Folder folder;
  for (const std::vector<std::string>& verb :
       {std::vector<std::string>{"evaluate", "scanner", "--page"},
        std::vector<std::string>{"evaluate", "acupoints", "--page"},
        std::vector<std::string>{"scan", "--person", "phantom:slim", "--out"}}) {
    std::vector<std::string> arguments = verb;
    arguments.push_back(folder / "none/page.html");
    CAPTURE(arguments);
    const auto outcome = run_tuina(arguments);
    CHECK(outcome.exit_code == 2);
    CHECK(outcome.err.find("page.html: there is no folder") != std::string::npos);
    CHECK(outcome.err.find('%') == std::string::npos);
  }
}

TEST_CASE("when the drawing of an estimate cannot be written, no trace is left") {
  const Folder folder;
  std::string csv = "time_s,position_mm,force_n\n";
  for (int i = 0; i < 200; ++i)
    csv += std::to_string(i) + "e-3,0," + std::to_string(i % 3) + "e-2\n";
  const auto outcome = run_tuina({"tissue", "estimate", folder.with("press.csv", csv), "--plot",
                                  folder / "no/x.svg", "--out", folder / "trace.csv", "--json"});
  CHECK(outcome.exit_code == 2);
  CHECK_FALSE(std::filesystem::exists(folder / "trace.csv"));
}

TEST_CASE("a calibration without its sections is refused in one line that names them all") {
  const Folder folder;
  const std::string sweep = folder / "sweep";
  REQUIRE(run_tuina({"scan", "--person", "phantom:slim", "--record", sweep, "--quiet"}).exit_code ==
          0);
  const auto outcome = run_tuina(
      {"scan", "--replay", sweep, "--calibration", folder.with("empty.toml", ""), "--json"});
  CHECK(outcome.exit_code == 2);
  CHECK(std::count(outcome.err.begin(), outcome.err.end(), '\n') == 1);
  CHECK(outcome.err.find("camera, laser, yaw_axis, couch_from_camera are missing") !=
        std::string::npos);

  // One broken reading of the turntable would bend the cloud.
  std::ifstream in(sweep + "/yaw.csv");
  std::string yaw, line;
  for (int i = 0; std::getline(in, line); ++i) {
    yaw += i == 200 ? line.substr(0, line.find(',')) + ",60" : line;
    yaw += '\n';
  }
  static_cast<void>(folder.with("sweep/yaw.csv", yaw));
  const auto bent = run_tuina({"scan", "--replay", sweep, "--json"});
  CHECK(bent.exit_code == 2);
  CHECK(bent.out.empty());
  CHECK(bent.err.find("yaw.csv: yaw reading 199") != std::string::npos);
}
