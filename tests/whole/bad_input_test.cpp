// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "tests/whole/command.hpp"

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
    CHECK(outcome.err.size() < 600);
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
