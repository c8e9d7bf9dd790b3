// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/whole/command.hpp"
#include "tuina/core/io/file.hpp"

namespace fs = std::filesystem;
using tuina::test::Folder;
using tuina::test::run_tuina;

namespace {

/// The subcommands that --help lists.
std::vector<std::string> verbs_of(const std::string& help) {
  std::vector<std::string> verbs;
  std::istringstream lines(help.substr(std::min(help.find("Subcommands:"), help.size())));
  std::string line;
  std::getline(lines, line);
  while (std::getline(lines, line)) {
    std::istringstream words(line);
    std::string verb;
    if (line.rfind("  ", 0) != 0 || line[2] == ' ' || !(words >> verb)) continue;
    if (verb.ends_with(',')) verb.pop_back();  // another name of it follows
    verbs.push_back(verb);
  }
  return verbs;
}

long lines_in(const std::string& text) {
  return std::count(text.begin(), text.end(), '\n');
}

}  // namespace

TEST_CASE("every verb has help with an example") {
  const auto help = run_tuina({"--help"});
  REQUIRE(help.exit_code == 0);
  const auto verbs = verbs_of(help.out);
  REQUIRE(verbs.size() >= 2);
  for (const std::string& verb : verbs) {
    CAPTURE(verb);
    const auto own = run_tuina({verb, "--help"});
    CHECK(own.exit_code == 0);
    const auto inner = verbs_of(own.out);
    if (inner.empty()) CHECK(own.out.find("Example:") != std::string::npos);
    for (const std::string& word : inner) {
      CAPTURE(word);
      const auto inner_help = run_tuina({verb, word, "--help"});
      CHECK(inner_help.exit_code == 0);
      CHECK(inner_help.out.find("Example:") != std::string::npos);
    }
  }
}

TEST_CASE("help beside an option or a value that the verb does not have says so") {
  CHECK(run_tuina({"map", "scan.ply", "--method", "surface", "--help"}).exit_code == 0);
  for (const std::vector<std::string>& wrong :
       {std::vector<std::string>{"map", "scan.ply", "--methods", "--help"},
        {"map", "scan.ply", "too_much", "--help"},
        {"map", "scan.ply", "--method", "guess", "--help"},
        {"history", "sow", "--help"},
        {"mapp", "--help"}}) {
    CAPTURE(wrong.front());
    const auto told = run_tuina(wrong);
    CHECK(told.exit_code == 1);
    CHECK_FALSE(told.err.empty());
  }
}

TEST_CASE("a misspelled option or word is named, with what may be meant") {
  const Folder folder;
  const auto says = [](const std::vector<std::string>& words, const std::string& told) {
    const auto outcome = run_tuina(words);
    CAPTURE(outcome.err);
    CHECK(outcome.exit_code == 1);
    CHECK(outcome.err.find(told) != std::string::npos);
  };
  says({"press", "--force", "8"}, "nothing here takes --force 8; is `--force-n` meant?");
  says({"press", "--force=8"}, "is `--force-n` meant?");
  says({"tissue", "fit"}, "file is required");
  says({"massage", "--adaptive", "of"}, "--adaptive: `of` is unknown; known: on, off");
  says({"massage", "--fix", "GV44=0,1,2", "--out", folder / "out"}, "is `GV4` meant?");
  CHECK_FALSE(fs::exists(folder / "out"));
  says({"atlas", "record", folder / "", "--labels", "bump=SI11", "--out", folder / "a.ply"},
       "no marks are told by 'bump' here, but in a cloud");
  says({"evaluate", "atlas", "--markers", folder / "", "--labels", "bump=C7"},
       "'bump=C7' is no point");
  says({"plan", "scan.ply", "points.json", "--picture", "back.png"}, "NAME.svg is needed");
  says({"robot", "import", "arm.urdf", "--base", "a", "--tip", "b", "--out",
        folder.with("mine.toml", "mended")},
       "may have been mended by hand");
  says({"line", "a.png", "--method", "guess"}, "`guess` is unknown; known: centroid, likelihood");
}

TEST_CASE("robot import says which axes it takes as parallel") {
  const Folder folder;
  const std::string urdf = folder / "arm.urdf", out = folder / "mine.toml";
  REQUIRE(run_tuina({"export", "urdf", "--robot", "ur", "--out", urdf}).exit_code == 0);
  std::string text = tuina::read_file(urdf).value();
  const auto elbow = text.find("rpy=\"", text.find("name=\"left_elbow_joint\""));
  REQUIRE(elbow != std::string::npos);
  text.replace(elbow, text.find('"', elbow + 5) + 1 - elbow, "rpy=\"0 0.00001 0\"");
  REQUIRE(tuina::write_file(urdf, text).has_value());
  const auto made =
      run_tuina({"robot", "import", urdf, "--base", "rail", "--tip", "left_tool", "--out", out});
  CHECK(made.exit_code == 0);
  CAPTURE(made.err);
  CHECK(made.err.find("\njoints 2 and 3 are 0.00057 degrees from parallel: taken as parallel\n") !=
        std::string::npos);
  CHECK(made.err.find("d_mm") == std::string::npos);  // nothing to be mended but rotors
}

TEST_CASE("a verb is known by its other name, too") {
  const auto other = run_tuina({"dashboard", "--help"});
  CHECK(other.exit_code == 0);
  CHECK(other.out == run_tuina({"serve", "--help"}).out);
  CHECK(run_tuina({"dashboard", "--port", "much"}).err.find("--port") != std::string::npos);
}

TEST_CASE("no verb shows the help and is wrong use") {
  const auto nothing = run_tuina({});
  CHECK(nothing.exit_code == 1);
  CHECK(nothing.out.empty());
  CHECK(nothing.err.find("Subcommands:") != std::string::npos);
}

TEST_CASE("a slip in a verb is told what was meant") {
  CHECK(run_tuina({"mesage"}).err.find("no verb `mesage`; is `massage` meant?") !=
        std::string::npos);
}

TEST_CASE("wrong use gets one or two lines, exit code 1 and an empty stdout") {
  const std::vector<std::vector<std::string>> wrong = {
      {"mesage"},
      {"doctor", "--colour"},
      {"doctor", "extra"},
      {"doctor", "--seed", "x"},
      {"doctor", "--seed", "-1"},
      {"config"},
      {"config", "show", "--set", "scan.nothing=1"},
      {"config", "show", "--set", "scan.sweep_s=nan"},
      {"config", "show", "--set", "scan.sweep_s"},
      {"config", "check"},
      {"doctor", "--out", ""},
      {"doctor", "--config", ""},
      {"massage", "--out", ""},
      {"massage", "--person", ""},
      {"scan", "--record", ""},
      {"map", "scan.ply", "--out", ""},
      {"map", "scan.ply", "--atlas", ""},
      {"map", ""},
      {"map", "scan.ply", "--fix", "GV14"},
      {"map", "scan.ply", "--fix", "GV14=0,1"},
      {"map", "scan.ply", "--fix", "GV14=0,1,nan"},
      {"map", "scan.ply", "--fix", "GV14=0,1,2", "--fix", "GV14=0,1,2"},
      {"map", "scan.ply", "--fix", "GV14=0,1,2", "--method", "field_morphing"},
      {"map", "scan.ply", "--fix-error-mm", "3"},
      {"evaluate", "acupoints", "--page", ""}};
  for (auto arguments : wrong) {
    if (arguments.size() > 1) arguments.push_back("--json");
    CAPTURE(arguments);
    const auto outcome = run_tuina(arguments);
    CHECK(outcome.exit_code == 1);
    CHECK(outcome.out.empty());
    if (arguments.front() != "config" || arguments.size() > 3) CHECK(lines_in(outcome.err) <= 2);
    CHECK_FALSE(outcome.err.empty());
    CHECK((outcome.err.size() < 380 || arguments.front() == "config"));
  }
}

TEST_CASE("a configuration file that is missing or wrong is bad input, with file and line") {
  const Folder folder;
  const auto missing = run_tuina({"config", "show", "--config", folder / "none.toml"});
  CHECK(missing.exit_code == 2);
  CHECK(missing.err.find("none.toml") != std::string::npos);
  const auto path = folder.with("wrong.toml", "[scan]\nsweep_s = 1000.0\n");
  const auto wrong = run_tuina({"config", "check", path});
  CHECK(wrong.exit_code == 2);
  CHECK(wrong.out.empty());
  CHECK(wrong.err.find("wrong.toml:2") != std::string::npos);
}

TEST_CASE("--json gives one object on stdout, and --out leaves it in a file") {
  const Folder folder;
  const auto doctor = run_tuina({"doctor", "--json", "--quiet", "--out", folder / "doctor.json"});
  CHECK(doctor.exit_code == 0);
  CHECK(doctor.err.empty());
  CHECK(nlohmann::json::parse(doctor.out).contains("checks"));
  const auto shown = run_tuina({"config", "show"});
  CHECK(run_tuina({"config", "check", folder.with("shown.toml", shown.out)}).exit_code == 0);
}

TEST_CASE("names too long for a message or a folder are refused in words") {
  const Folder folder;
  fs::path nested;
  for (int i = 0; i < 4; ++i) nested /= std::string(60, 'a');
  const auto missing = run_tuina({"tissue", "fit", nested / "nope.csv"});
  CHECK(missing.exit_code == 2);
  CHECK(missing.err.size() < 380);
  const std::string out = folder / (std::string(251, 'a') + ".ply");
  const auto scan = run_tuina({"scan", "--person", "phantom:slim", "--out", out});
  CHECK(scan.exit_code == 2);
  CHECK(scan.err.find("scan 10 %") == std::string::npos);
  CHECK(scan.err.find("File name too long") != std::string::npos);
}

TEST_CASE("an option that is given twice is told so") {
  const auto twice = run_tuina({"doctor", "--out", "a.json", "--out", "b.json"});
  CHECK(twice.exit_code == 1);
  CHECK(twice.err.find("--out is given 2 times; once is right") != std::string::npos);
}

TEST_CASE("two results do not go into one file") {
  const Folder folder;
  const std::string file = folder / "both.csv";
  const std::string same = (folder.path() / "." / "both.csv").string();
  const std::vector<std::vector<std::string>> twice = {
      {"press", "--force-n", "8", "--out", file, "--felt", file},
      {"press", "--force-n", "8", "--out", file, "--plot", same},
      {"tissue", "estimate", "a.csv", "--out", file, "--predict", "b.csv", "--predict-out", file}};
  for (const auto& words : twice) {
    CAPTURE(words.back());
    const auto refused = run_tuina(words);
    CHECK(refused.exit_code == 1);
    CHECK(refused.err.find("each needs its own") != std::string::npos);
    CHECK_FALSE(fs::exists(file));
  }
}

TEST_CASE("a program finds what is installed beside its bin, not what lies above a build") {
  const Folder folder;
  const fs::path models = folder.path() / "share/tuina/models";
  fs::create_directories(models);
  REQUIRE(tuina::write_file(models / "atlas.tuina", "of another version"));
  const std::string cloud =
      folder.with("point.ply",
                  "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
                  "property float z\nend_header\n0 0 0\n");
  const auto reads_that = [&](const fs::path& program) {
    fs::create_directories(program.parent_path());
    fs::copy_file(TUINA_BINARY, program);
    const std::string said = folder / "said";
    CHECK(std::system(fmt::format("'{}' map '{}' 2>'{}'", program.string(), cloud, said).c_str()) !=
          0);
    return tuina::read_file(said).value().find(models.string()) != std::string::npos;
  };
  CHECK(reads_that(folder.path() / "bin/tuina"));
  CHECK_FALSE(reads_that(folder.path() / "src/tuina/build/release/tuina"));
}

TEST_CASE("no command writes onto what it reads, or into a record that it reads") {
  const Folder folder;
  fs::create_directory(folder / "session");
  for (const char* name : {"press.csv", "line.png", "session/session.json", "session/session.mcap"})
    (void)folder.with(name, "kept");
  const std::vector<std::vector<std::string>> onto_itself = {
      {"tissue", "fit", folder / "press.csv", "--out", folder / "press.csv"},
      {"tissue", "estimate", folder / "press.csv", "--out", folder / "session/../press.csv"},
      {"line", folder / "line.png", "--picture", folder / "line.png"},
      {"report", folder / "session", "--out", folder / "session/session.json"},
      {"report", folder / "session/session.mcap", "--out", folder / "session/session.json"},
      {"scan", "--replay", folder / "session", "--out", folder / "session/session.mcap"}};
  for (const auto& words : onto_itself) {
    CAPTURE(words.back());
    const auto refused = run_tuina(words);
    CHECK(refused.exit_code == 1);
    CHECK(refused.err.find("is read by this command, and would be lost") != std::string::npos);
  }
  for (const char* name : {"press.csv", "line.png", "session/session.json", "session/session.mcap"})
    CHECK(tuina::read_file(folder / name).value() == "kept");
  // What merely lies there is nothing that the command reads.
  for (const char* name : {"session/felt.csv", "session/shot.png", "session/notes.json"}) {
    for (const char* record : {"session", "session/session.mcap"}) {
      CAPTURE(name);
      const auto tried = run_tuina({"report", folder / record, "--out", folder.with(name, "mine")});
      CHECK(tried.exit_code == 2);
      CHECK(tried.err.find("would be lost") == std::string::npos);
    }
  }
}
