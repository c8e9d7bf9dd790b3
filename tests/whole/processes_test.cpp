// SPDX-License-Identifier: Apache-2.0
// Guard, robot and session as processes of their own, and what becomes of one that is interrupted.
#include <doctest/doctest.h>
#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "tests/whole/command.hpp"
#include "tuina/core/io/file.hpp"

extern char** environ;

namespace fs = std::filesystem;
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

/// A program that somebody interrupts; what it says goes to files of a folder.
class Running {
 public:
  Running(const Folder& folder, std::vector<std::string> words) : said_(folder / "said") {
    const std::string out = folder / "out";
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    constexpr int anew = O_WRONLY | O_CREAT | O_TRUNC;
    posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, out.c_str(), anew, 0600);
    posix_spawn_file_actions_addopen(&files, STDERR_FILENO, said_.c_str(), anew, 0600);
    words.insert(words.begin(), TUINA_BINARY);
    std::vector<char*> pointers;
    for (std::string& word : words) pointers.push_back(word.data());
    pointers.push_back(nullptr);
    // A job in the background of a shell has Ctrl-C silenced, and so would what it begins.
    sigset_t all;
    sigfillset(&all);
    posix_spawnattr_t heard;
    posix_spawnattr_init(&heard);
    posix_spawnattr_setsigdefault(&heard, &all);
    posix_spawnattr_setflags(&heard, POSIX_SPAWN_SETSIGDEF);
    REQUIRE(posix_spawn(&process_, TUINA_BINARY, &files, &heard, pointers.data(), environ) == 0);
    posix_spawnattr_destroy(&heard);
    posix_spawn_file_actions_destroy(&files);
  }
  /// Waits until this stands in what it says, which must be within half a minute.
  void wait_for(const std::string& words) const {
    for (int i = 0; i < 3000; ++i) {
      if (tuina::read_file(said_).value_or("").find(words) != std::string::npos) return;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    FAIL("it has not said ", words);
  }
  void interrupt(int signal) const { REQUIRE(::kill(process_, signal) == 0); }
  /// How it ended, as waitpid tells.
  int end() {
    int status = 0;
    ::waitpid(process_, &status, 0);
    return status;
  }
  [[nodiscard]] std::string said() const { return tuina::read_file(said_).value_or(""); }

 private:
  std::string said_;
  pid_t process_ = 0;
};

/// Whether any process has this among its words.
bool runs_with(const std::string& word) {
  std::error_code gone;
  for (const auto& process : fs::directory_iterator("/proc")) {
    const auto words = tuina::read_file(process.path() / "cmdline").value_or("");
    if (words.find(word) != std::string::npos) return true;
  }
  return false;
}

/// What is left under a name: memory, and what a guard was armed with.
int left_of(const std::string& link) {
  int left = 0;
  for (const fs::path& folder : {fs::path("/dev/shm"), fs::temp_directory_path()})
    for (const auto& file : fs::directory_iterator(folder))
      left += file.path().filename().string().starts_with("tuina-" + link) ? 1 : 0;
  return left;
}

bool has_exited(int status, int code) {
  return WIFEXITED(status) && WEXITSTATUS(status) == code;
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
                 "no memory", "processors hogged", "--json", "--quiet"});
  REQUIRE_MESSAGE(outcome.exit_code == 0, outcome.err);
  const json found = json::parse(outcome.out)["processes"];
  CHECK(found["trials"] == 7);
  CHECK(found["held"] == 7);
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

TEST_CASE("who interrupts a massage has the arms lifted away, and its report") {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    CAPTURE(signal);
    const Folder folder;
    Running massage(folder, {"massage", "--pace", "real", "--out", folder / "report"});
    massage.wait_for("map 100 %");
    std::this_thread::sleep_for(std::chrono::seconds(3));
    massage.interrupt(signal);
    CHECK_MESSAGE(has_exited(massage.end(), 4), massage.said());
    CHECK(massage.said().find("asked to stop") != std::string::npos);
    CHECK_FALSE(fs::exists(folder / "report/session.mcap.part"));
    CHECK(fs::exists(folder / "report/session.mcap"));
    CHECK(fs::exists(folder / "report/report.html"));
    const json session = json::parse(tuina::read_file(folder / "report/session.json").value());
    REQUIRE(session["stops"].size() == 1);
    CHECK(session["stops"][0]["cause"] == "asked to stop");
  }
}

TEST_CASE("arms in a process of their own are there until they have left") {
  const Folder folder;
  Running massage(folder, {"massage", "--processes", "--pace", "real", "--out", folder / "report"});
  massage.wait_for("map 100 %");
  std::this_thread::sleep_for(std::chrono::seconds(4));
  massage.interrupt(SIGINT);
  CHECK_MESSAGE(has_exited(massage.end(), 4), massage.said());
  CHECK(massage.said().find("asked to stop") != std::string::npos);
}

TEST_CASE("guard and robot of a session that was killed let go and end, and leave nothing") {
  const Folder folder;
  const std::string link = "orphan-" + std::to_string(getpid());
  Running massage(folder, {"massage", "--processes", "--pace", "real", "--link", link, "--out",
                           folder / "report"});
  massage.wait_for("map 100 %");
  std::this_thread::sleep_for(std::chrono::seconds(4));
  CHECK(runs_with(link));
  CHECK(left_of(link) == 7);
  massage.interrupt(SIGINT);
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  massage.interrupt(SIGINT);
  const int status = massage.end();
  CHECK((WIFSIGNALED(status) && WTERMSIG(status) == SIGINT));
  CHECK(runs_with(link));  // the arms are not left where they press
  for (int i = 0; i < 300 && runs_with(link); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  CHECK_FALSE(runs_with(link));
  CHECK(left_of(link) == 0);
}

TEST_CASE("a terminal that is closed twice over is one request to end") {
  const Folder folder;
  Running massage(folder, {"massage", "--pace", "real", "--out", folder / "report"});
  massage.wait_for("map 100 %");
  std::this_thread::sleep_for(std::chrono::seconds(3));
  for (int i = 0; i < 3; ++i) {
    massage.interrupt(SIGHUP);
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  CHECK_MESSAGE(has_exited(massage.end(), 4), massage.said());
  CHECK(fs::exists(folder / "report/report.html"));
}

TEST_CASE("who interrupts twice does not wait") {
  const Folder folder;
  Running massage(folder, {"massage", "--pace", "real", "--out", folder / "report"});
  massage.wait_for("map 100 %");
  std::this_thread::sleep_for(std::chrono::seconds(3));
  massage.interrupt(SIGINT);
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  massage.interrupt(SIGINT);
  const int status = massage.end();
  CHECK((WIFSIGNALED(status) && WTERMSIG(status) == SIGINT));
  // What is left of it is not written over.
  const auto again = run_tuina({"massage", "--out", folder / "report"});
  CHECK(again.exit_code == 2);
  CHECK(again.err.find("session.mcap.part: is there already") != std::string::npos);
}

TEST_CASE("a press and a taught motion that are interrupted leave what they have") {
  const Folder folder;
  Running press(folder,
                {"press", "--force-n", "20", "--duration-s", "300", "--out", folder / "trace.csv"});
  press.wait_for("press 10 %");
  press.interrupt(SIGINT);
  CHECK_MESSAGE(has_exited(press.end(), 4), press.said());
  CHECK(press.said().find("asked to stop") != std::string::npos);
  CHECK(fs::exists(folder / "trace.csv"));

  const std::string motion = folder / "stroke.toml", cut = folder / "cut.toml";
  Running record(folder, {"teach", "record", "--out", cut});
  record.wait_for("teach 70 %");
  record.interrupt(SIGINT);
  CHECK_MESSAGE(has_exited(record.end(), 4), record.said());
  CHECK(record.said().find("asked to stop") != std::string::npos);
  CHECK(run_tuina({"teach", "show", cut}).exit_code == 0);

  REQUIRE(run_tuina({"teach", "record", "--out", motion}).exit_code == 0);
  Running play(folder, {"teach", "play", motion, "--plot", folder / "played.svg"});
  play.wait_for("play 10 %");
  play.interrupt(SIGINT);
  CHECK_MESSAGE(has_exited(play.end(), 4), play.said());
  CHECK(play.said().find("asked to stop") != std::string::npos);
  CHECK(fs::exists(folder / "played.svg"));
}
