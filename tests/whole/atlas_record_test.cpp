// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/marked_cloud.hpp"
#include "tests/reason.hpp"
#include "tests/whole/command.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/core/io/surface_file.hpp"
#include "tuina/core/units.hpp"
#include "tuina/sim/person/person.hpp"

namespace tuina {
namespace {

using test::Folder;
using test::run_tuina;

/// A sweep of a person with stickers, made once.
const Folder& recorded() {
  static const Folder folder;
  static const bool made = [] {
    const auto scanned =
        run_tuina({"scan", "--person", "phantom:medium", "--seed", "3", "--stickers",
                   "magenta=SI11,BL47,BL50", "yellow=GV4", "--record", folder / "sweep", "--json"});
    REQUIRE_MESSAGE(scanned.exit_code == 0, scanned.err);
    // The light of the room does not disturb the scan.
    CHECK(nlohmann::json::parse(scanned.out)["rms_error_mm"] < 1.0);
    return true;
  }();
  REQUIRE(made);
  return folder;
}

test::Outcome record(const std::vector<std::string>& labels, const std::string& sweep,
                     const std::string& out) {
  std::vector<std::string> words = {"atlas", "record", sweep, "--json", "--quiet", "--out", out};
  if (!labels.empty()) words.emplace_back("--labels");
  words.insert(words.end(), labels.begin(), labels.end());
  return run_tuina(words);
}

}  // namespace

TEST_CASE("a person with stickers becomes a labelled back that an atlas is learned from") {
  const Folder& folder = recorded();
  const Folder people;
  const auto made =
      record({"magenta=SI11,BL47,BL50", "yellow=GV4"}, folder / "sweep", people / "anna.ply");
  REQUIRE_MESSAGE(made.exit_code == 0, made.err);
  const auto json = nlohmann::json::parse(made.out);
  CHECK(json["position"] == "sitting");
  CHECK(json["points"] == 7);
  const auto truth = sim::parse_person("phantom:medium", BodyPosture::sitting, 3);
  const auto person = sim::load_person(people / "anna.ply");
  REQUIRE(truth);
  REQUIRE_MESSAGE(person.has_value(), test::reason(person));
  double sum_mm = 0.0;
  for (std::size_t i = 0; i < seven_acupoints.size(); ++i) {
    const Vector3 off = person->acupoints[i].at_in_couch - truth->acupoints[i].at_in_couch;
    INFO(seven_acupoints[i], " is ", to_mm(off.norm()), " mm off");
    CHECK(to_mm(off.norm()) < 4.0);
    CHECK(person->acupoints[i].normal_in_couch.dot(truth->acupoints[i].normal_in_couch) > 0.97);
    CHECK(json["stickers"][seven_acupoints[i]]["dots"] >= 3);
    sum_mm += to_mm(off.norm());
  }
  MESSAGE("recorded points are ", sum_mm / 7.0, " mm off");
  CHECK(sum_mm / 7.0 < 2.0);

  const auto learned = run_tuina({"atlas", "learn", people / "anna.ply", "--prior", "default",
                                  "--out", people / "anna.tuina", "--json", "--quiet"});
  REQUIRE_MESSAGE(learned.exit_code == 0, learned.err);
  CHECK(nlohmann::json::parse(learned.out)["bodies"] == 1);

  const auto learn = [&](std::vector<std::string> words) {
    words.insert(words.begin(), {"atlas", "learn"});
    words.insert(words.end(),
                 {"--prior", "default", "--out", people / "anna.tuina", "--json", "--quiet"});
    return run_tuina(words);
  };
  // One file that is named twice is one person, and a copy is refused.
  CHECK(nlohmann::json::parse(learn({people / "anna.ply", people.path()}).out)["bodies"] == 1);
  for (const char* end : {".ply", ".json"}) {
    const auto content = read_file(people / (std::string("anna") + end)).value();
    REQUIRE(write_file(people / (std::string("berta") + end), content).has_value());
  }
  const auto twice = learn({people.path()});
  CHECK(twice.exit_code == 2);
  CHECK(twice.err.find("berta: its labels are those of anna") != std::string::npos);
}

TEST_CASE("stickers that do not fit what is said of them are refused with the cause") {
  const Folder& folder = recorded();
  const std::string sweep = folder / "sweep";
  const std::string out = folder / "nobody.ply";
  const auto says = [&](const std::vector<std::string>& labels, int exit_code,
                        std::string_view words) {
    const auto refused = record(labels, sweep, out);
    CAPTURE(refused.err);
    CHECK(refused.exit_code == exit_code);
    CHECK(refused.out.empty());
    CHECK(refused.err.find(words) != std::string::npos);
    CHECK_FALSE(std::filesystem::exists(out));
  };
  says({"magenta=SI11,BL47,BL50,BL13", "yellow=GV4"}, 2, "6 of 8 magenta stickers are seen");
  says({"magenta=SI11,BL47,BL50", "green=GV4"}, 2, "none near GV4");
  says({"magenta=SI11,BL47", "yellow=GV4", "green=BL50"}, 2, "6 magenta stickers are seen and 4");
  says({"magenta=BL47,SI11,BL50", "yellow=GV4"}, 2, "from the head to the feet");
  // Three single points are listed where pairs lie at one level.
  says({"magenta=SI11_L,SI11_R,BL47,BL50", "yellow=GV4"}, 2, "cannot be told");
  says({"magenta=SI11,BL47,BL50"}, 1, "lacks GV4");
  says({"magenta=SI11,BL47,BL50", "magenta=GV4"}, 1, "magenta stands there twice");
  says({"magenta=SI11,BL47,BL50,SI11_L", "yellow=GV4"}, 1, "SI11_L is named twice");
  says({"magenta=SI11,BL47,BL50", "yelow=GV4"}, 1, "`yellow` meant");
  says({"magenta=SI11,BL47,BL50", "yellow=GV5"}, 1, "`GV4` meant");
  says({"GV4"}, 1, "names no kind of marks");
  says({}, 1, "--labels is required");
}

TEST_CASE("balls on the skin of a cloud are labels, too, and an atlas is judged at them") {
  const auto truth = sim::parse_person("phantom:medium", BodyPosture::sitting, 3);
  REQUIRE(truth);
  std::vector<Vector3> places;
  for (std::size_t i = 0; i < seven_acupoints.size(); ++i)
    places.push_back(truth->acupoints[i].at_in_couch);
  const Folder folder;
  const std::string scan = folder / "scan.ply";
  REQUIRE(write_file(scan, to_ply(test::marked_cloud(*truth, places, 1.5_mm, 1))));
  const Folder people;
  const auto made = record({"bump=SI11,BL47,BL50,GV4"}, scan, people / "ben.ply");
  REQUIRE_MESSAGE(made.exit_code == 0, made.err);
  const auto person = sim::load_person(people / "ben.ply");
  REQUIRE_MESSAGE(person.has_value(), test::reason(person));
  for (std::size_t i = 0; i < seven_acupoints.size(); ++i) {
    const Vector3 off = person->acupoints[i].at_in_couch - truth->acupoints[i].at_in_couch;
    CHECK_MESSAGE(to_mm(off.norm()) < 4.0, seven_acupoints[i]);
  }
  const auto judged = run_tuina({"evaluate", "atlas", "--markers", folder / "", "--labels",
                                 "SI11,BL47,BL50,GV4", "--json", "--quiet"});
  REQUIRE_MESSAGE(judged.exit_code == 0, judged.err);
  const auto points = nlohmann::json::parse(judged.out)["markers"]["points"];
  CHECK(points.size() == seven_acupoints.size());
  CHECK(points["GV4"]["marked"] == 1);
  CHECK(points["GV4"]["mean_mm"] < 25.0);
  const auto over_itself = record({"bump=SI11,BL47,BL50,GV4"}, scan, scan);
  CHECK(over_itself.exit_code == 1);
  CHECK(over_itself.err.find("would be lost") != std::string::npos);
  const auto too_few = record({"bump=SI11,BL47,BL50,GV4,GV14"}, scan, people / "x.ply");
  CHECK(too_few.exit_code == 2);
  CHECK(too_few.err.find("7 of 8 bumps are seen; there is none near GV14") != std::string::npos);
}

TEST_CASE("a sweep in grey shows no stickers, and a cloud no colours") {
  const Folder folder;
  const auto scanned = run_tuina({"scan", "--person", "phantom:medium", "--record", folder / "grey",
                                  "--out", folder / "grey.ply", "--quiet"});
  REQUIRE(scanned.exit_code == 0);
  const std::vector<std::string> labels = {"magenta=SI11,BL47,BL50", "yellow=GV4"};
  const auto grey = record(labels, folder / "grey", folder / "x.ply");
  CHECK(grey.exit_code == 2);
  CHECK(grey.err.find("frame 0 is grey") != std::string::npos);
  const auto cloud = record(labels, folder / "grey.ply", folder / "x.ply");
  CHECK(cloud.exit_code == 1);
  CHECK(cloud.err.find("known: bump") != std::string::npos);
  CHECK(record(labels, folder / "nowhere", folder / "x.ply").exit_code == 2);
  CHECK(record(labels, folder / "grey", folder / "x.obj").exit_code == 1);
  const auto alone = run_tuina({"scan", "--person", "phantom:medium", "--stickers", "magenta=GV4"});
  CHECK(alone.exit_code == 1);
}

}  // namespace tuina
