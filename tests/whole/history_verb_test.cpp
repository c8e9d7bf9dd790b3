// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/reason.hpp"
#include "tests/whole/command.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/record/session_file.hpp"

namespace tuina {
namespace {

using test::Folder;
using test::run_tuina;
namespace fs = std::filesystem;

/// A session as somebody's next one, some days later: with other names, and softer by a third.
void give_again(const fs::path& from, const fs::path& to) {
  fs::copy(from, to, fs::copy_options::recursive);
  auto session = nlohmann::ordered_json::parse(*read_file(to / "session.json"));
  session["session_id"] = "the second one";
  session["began"] = "2126-01-01T09:00:00Z";
  for (auto& place : session["tissue"]) place["alpha_n"] = 0.6667 * place["alpha_n"].get<double>();
  REQUIRE(write_file(to / "session.json", session.dump(2)).has_value());
}

constexpr auto others = fs::perms::group_all | fs::perms::others_all;

/// What a session has left is all that `forget` removes, file by file, and its owner's alone.
void check_is_private(const fs::path& session, const std::string& history) {
  for (const auto& entry : fs::directory_iterator(session)) {
    const std::string name = entry.path().filename();
    CAPTURE(name);
    CHECK(std::ranges::find(record::files_of_session, name) != record::files_of_session.end());
  }
  CHECK((fs::status(session).permissions() & others) == fs::perms::none);
  CHECK((fs::status(history).permissions() & others) == fs::perms::none);
}

/// Nobody's session is written over, not by one of nobody either.
void check_is_kept(const std::string& session) {
  const auto again = run_tuina({"massage", "--out", session});
  CHECK(again.exit_code == 2);
  CHECK(again.err.find("holds the session of anna") != std::string::npos);
}

/// Who is refused before anything was done has had no session.
void check_refused_is_nobodys(const Folder& folder) {
  const std::string history = folder / "refused.sqlite";
  CHECK(run_tuina({"massage", "--who", "cleo", "--history", history, "--fix", "GV44=0,1,2", "--out",
                   folder / "refused"})
            .exit_code == 1);
  CHECK(run_tuina({"history", "show", "--history", history}).err.find("nobody yet") !=
        std::string::npos);
}

/// Sessions of anna that press two points.
struct BriefSessions {
  test::Outcome operator()(const char* out, const std::vector<std::string>& more) const {
    std::vector<std::string> words = {"massage",     "--position", "sitting",
                                      "--programme", programme,    "--who",
                                      "anna",        "--history",  folder / "history.sqlite",
                                      "--out",       folder / out, "--json",
                                      "--quiet"};
    words.insert(words.end(), more.begin(), more.end());
    return run_tuina(words);
  }
  Folder folder;
  std::string programme = folder.with(
      "brief.toml", "name = \"brief\"\n[[part]]\ntechnique = \"press\"\npoints = [\"BL50\"]\n");
};

}  // namespace

TEST_CASE("a person's sessions are remembered, compared, exported and forgotten") {
  const Folder folder;
  const std::string history = folder / "history.sqlite";
  const auto first =
      run_tuina({"massage", "--who", "anna", "--history", history, "--out", folder / "all/first",
                 "--json", "--quiet", "--set", "simulation.realism=ideal"});
  REQUIRE_MESSAGE(first.exit_code == 0, first.err);
  CHECK(nlohmann::json::parse(first.out)["who"] == "anna");
  check_is_private(folder.path() / "all/first", history);
  check_is_kept(folder / "all/first");
  check_refused_is_nobodys(folder);
  give_again(folder.path() / "all/first", folder.path() / "all/second");
  const auto rebuilt =
      run_tuina({"history", "rebuild", folder / "all", "--history", history, "--json", "--quiet"});
  REQUIRE_MESSAGE(rebuilt.exit_code == 0, rebuilt.err);
  CHECK(nlohmann::json::parse(rebuilt.out)["sessions"] == 2);
  REQUIRE(run_tuina({"history", "note", "anna", "sleeps well", "--history", history}).exit_code ==
          0);

  const auto shown = run_tuina({"history", "show", "anna", "--history", history, "--json",
                                "--quiet", "--out", folder / "anna.html"});
  REQUIRE_MESSAGE(shown.exit_code == 0, shown.err);
  const auto json = nlohmann::json::parse(shown.out);
  REQUIRE(json["sessions"].size() == 2);
  CHECK(json["sessions"][0]["ended"] == true);
  CHECK(json["sessions"][0]["tissue"].size() == nlohmann::json::parse(first.out)["tissue"].size());
  CHECK(json["notes"][0]["words"] == "sleeps well");
  REQUIRE(json["change"]["places"].size() >= 5);
  for (const auto& place : json["change"]["places"]) {
    CHECK(place["change_percent"].get<double>() == doctest::Approx(-33.3).epsilon(0.01));
  }
  CHECK(json["change"]["whole"]["real"] == true);
  const auto page = read_file(folder / "anna.html");
  REQUIRE(page);
  CHECK(page->find("sleeps well") != std::string::npos);
  CHECK(page->find("Softer as a whole since") != std::string::npos);

  REQUIRE(
      run_tuina({"history", "export", "anna", "--history", history, "--out", folder / "anna.csv"})
          .exit_code == 0);
  CHECK(read_file(folder / "anna.csv")->find("the second one") != std::string::npos);
  CHECK((fs::status(folder / "anna.csv").permissions() & others) == fs::perms::none);
  fs::rename(folder.path() / "all/second", folder.path() / "elsewhere");
  const auto archive = run_tuina({"history", "export", "anna", "--history", history, "--out",
                                  folder / "anna.zip", "--json", "--quiet"});
  REQUIRE_MESSAGE(archive.exit_code == 0, archive.err);
  const auto archived = nlohmann::json::parse(archive.out);
  CHECK(archived["files"].get<int>() >= 12);
  CHECK(archived["missing"].size() == 1);
  CHECK(fs::file_size(folder / "anna.zip") > 10000);

  CHECK(run_tuina({"history", "forget", "anna", "--history", history}).exit_code == 1);
  CHECK(fs::exists(folder.path() / "all/first/session.json"));
  CHECK(run_tuina({"history", "forget", "anna", "--yes", "--history", history}).exit_code == 0);
  CHECK_FALSE(fs::exists(folder.path() / "all/first"));
  const auto gone = run_tuina({"history", "show", "anna", "--history", history});
  CHECK(gone.exit_code == 2);
  CHECK(gone.out.empty());
  CHECK(gone.err.find("nobody called anna") != std::string::npos);
}

TEST_CASE("what was said of a person by hand holds in the next session, and of nobody else") {
  const BriefSessions session;
  const Folder& folder = session.folder;
  const auto plain = session("plain", {});
  REQUIRE_MESSAGE(plain.exit_code == 0, plain.err);
  const auto found = nlohmann::json::parse(plain.out)["acupoints"]["points"];
  const auto place = [&](const char* name) {
    for (const auto& point : found) {
      if (point["name"] == name) return point["position_m"].get<std::vector<double>>();
    }
    return std::vector<double>(3);
  };
  const auto gv4 = place("GV4"), bl50 = place("BL50_L");
  std::string corners;
  for (const auto& [x, z] : {std::pair(-1, -1), {1, -1}, {1, 1}, {-1, 1}})
    corners += fmt::format("[{}, {}, {}], ", bl50[0] + 0.04 * x, bl50[1], bl50[2] + 0.04 * z);
  const auto no_go = folder.with(
      "no_go.toml", fmt::format("[[no_go]]\nname = \"scar\"\ncorners_m = [{}]\n", corners));
  const std::string fix = fmt::format("GV4={},{},{}", gv4[0], gv4[1], gv4[2] + 0.006);

  const auto first = session("first", {"--fix", fix, "--no-go", no_go});
  REQUIRE_MESSAGE(first.exit_code == 0, first.err);
  const auto pressed = [](const test::Outcome& outcome) {
    std::vector<std::string> names;
    const auto given = nlohmann::json::parse(outcome.out);
    for (const auto& path : given["massage"]["performed"]) names.push_back(path["name"]);
    return names;
  };
  CHECK(pressed(plain) == std::vector<std::string>{"press BL50_L", "press BL50_R"});
  CHECK(pressed(first) == std::vector<std::string>{"press BL50_R"});
  // The scan differs by its noise, and by nothing that anybody says.
  const auto second = session("second", {"--set", "simulation.room_light_dn=9"});
  REQUIRE_MESSAGE(second.exit_code == 0, second.err);
  CHECK(pressed(second) == pressed(first));
  const auto said = nlohmann::json::parse(second.out)["said"];
  CHECK(said["no_go"][0]["name"] == "scar");
  CHECK(said["fixed"][0]["name"] == "GV4");
  CHECK(second.out.find("GV4 was put by hand") != std::string::npos);
  // Given once more, from the record alone.
  const auto again =
      run_tuina({"massage", "--replay", folder / "second", "--out", folder / "again"});
  CHECK_MESSAGE(again.err.find("as recorded") != std::string::npos, again.err);

  const auto other = session("other", {"--seed", "2"});
  CHECK(other.exit_code == 2);
  CHECK(other.out.empty());
  CHECK(other.err.find("1 ruled out and 1 put right by hand") != std::string::npos);
  CHECK(other.err.find("--anew") != std::string::npos);
  CHECK(session("anew", {"--seed", "2", "--anew"}).exit_code == 0);
}

TEST_CASE("wishes of the last session hold in the next one, firmer ones by a word") {
  const BriefSessions session;
  const std::string history = session.folder / "history.sqlite";
  const auto end_with = [&](const char* out, double intensity) {
    const std::string file = session.folder / out + std::string("/session.json");
    auto ended = nlohmann::ordered_json::parse(*read_file(file));
    ended["massage"]["intensity"] = intensity;
    REQUIRE(write_file(file, ended.dump(2)).has_value());
    REQUIRE(
        run_tuina({"history", "rebuild", session.folder / out, "--history", history}).exit_code ==
        0);
  };
  const auto first = session("first", {});
  REQUIRE_MESSAGE(first.exit_code == 0, first.err);
  CHECK(nlohmann::json::parse(first.out)["massage"]["intensity"] == 1.0);
  CHECK_FALSE(nlohmann::json::parse(first.out).contains("known"));
  end_with("first", 0.7);
  const auto second = session("second", {"--set", "simulation.room_light_dn=9"});
  REQUIRE_MESSAGE(second.exit_code == 0, second.err);
  const auto given = nlohmann::json::parse(second.out);
  CHECK(given["order"]["intensity"] == 0.7);
  CHECK(given["massage"]["intensity"] == 0.7);
  REQUIRE(given["massage"]["performed"].size() == 2);
  int as_wished = 0;
  for (const auto& path : given["massage"]["performed"]) {
    const double share = path["given_n"].get<double>() / path["ordered_n"].get<double>();
    CHECK(share < 0.77);
    as_wished += share > 0.63;
    // Less than was wished is given only where rule A2 holds it back.
    CHECK((share > 0.63 || path["why"].get<std::string>().find("A2") != std::string::npos));
  }
  CHECK(as_wished >= 1);
  CHECK(given["known"]["places"].empty());  // kept to notice somebody else by
  const auto again = run_tuina(
      {"massage", "--replay", session.folder / "second", "--out", session.folder / "again"});
  CHECK_MESSAGE(again.err.find("as recorded") != std::string::npos, again.err);

  // What is remembered is told before the session begins; these never do.
  end_with("second", 1.3);
  const auto told = [&](const char* more) {
    return run_tuina({"massage", "--who", "anna", "--history", history, "--out",
                      session.folder / "told", "--consent", "not there", more})
        .err;
  };
  CHECK(told("--adaptive=on").find("with --as-firm it begins so") != std::string::npos);
  CHECK(told("--as-firm").find("begins at 130 % of the planned forces") != std::string::npos);
  CHECK(told("--anew").find("remembered") == std::string::npos);
}

TEST_CASE("what cannot be a history is wrong before anybody is scanned") {
  const Folder folder;
  const auto spaced = run_tuina(
      {"massage", "--who", "a b", "--history", folder / "h.sqlite", "--out", folder / "out"});
  CHECK(spaced.exit_code == 1);
  CHECK_FALSE(fs::exists(folder / "out"));
  const auto nowhere = run_tuina(
      {"massage", "--who", "anna", "--history", folder / "no/h.sqlite", "--out", folder / "out"});
  CHECK(nowhere.exit_code == 2);
  CHECK_FALSE(fs::exists(folder / "out"));
  CHECK(run_tuina({"massage", "--history", folder / "h.sqlite"}).exit_code == 1);
  CHECK(run_tuina({"history", "rebuild", folder / "nothing", "--history", folder / "new.sqlite"})
            .exit_code == 2);
  CHECK_FALSE(fs::exists(folder / "new.sqlite"));
  for (const std::string& slip : {folder / "typo.sqlite", folder.with("empty.sqlite", "")}) {
    const auto shown = run_tuina({"history", "show", "--history", slip});
    CHECK(shown.exit_code == 2);
    CHECK_MESSAGE(shown.err.find(slip) != std::string::npos, shown.err);
  }
  CHECK_FALSE(fs::exists(folder / "typo.sqlite"));
  CHECK(fs::file_size(folder / "empty.sqlite") == 0);
}

TEST_CASE("while the server is away a session begins without its memory only, and waits") {
  const Folder folder;
  const test::Folder data;
  ::setenv("XDG_DATA_HOME", data.path().c_str(), 1);
  const std::vector<std::string> words = {"massage",
                                          "--who",
                                          "anna",
                                          "--history",
                                          "postgresql://carla:secret@127.0.0.1:9/t",
                                          "--out",
                                          folder / "one",
                                          "--position",
                                          "sitting"};
  const auto refused = run_tuina(words);
  CHECK(refused.exit_code == 3);
  CHECK(refused.err.find("does not answer") != std::string::npos);
  CHECK(refused.err.find("--anew begins with nothing of earlier sessions") != std::string::npos);
  CHECK(refused.err.find("secret") == std::string::npos);
  CHECK_FALSE(fs::exists(folder.path() / "one"));

  auto alone = words;
  alone.emplace_back("--anew");
  const auto given = run_tuina(alone);
  CHECK(given.exit_code == 0);
  const std::string outbox = data / "tuina/outbox-127.0.0.1-9-t-carla.sqlite";
  CHECK_MESSAGE(given.err.find("anna: the session waits in " + outbox) != std::string::npos,
                given.err);
  const auto waits = run_tuina({"history", "show", "anna", "--history", outbox, "--json"});
  REQUIRE_MESSAGE(waits.exit_code == 0, waits.err);
  const auto sessions = nlohmann::json::parse(waits.out)["sessions"];
  REQUIRE(sessions.size() == 1);
  CHECK(sessions[0]["ended"] == true);
  ::unsetenv("XDG_DATA_HOME");
}

}  // namespace tuina
