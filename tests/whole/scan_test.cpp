// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <tuple>

#include "tests/whole/command.hpp"
#include "tuina/core/image.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/core/io/png.hpp"
#include "tuina/scanner/recording.hpp"
#include "tuina/scanner/sweep.hpp"
#include "tuina/sim/person/solids.hpp"
#include "tuina/sim/scanner/laser_scanner.hpp"

using tuina::test::Folder;
using tuina::test::run_tuina;

namespace {

// A vertical line at column 40.25 in a picture of 96 x 64.
std::string line_png() {
  tuina::Image image(96, 64);
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 96; ++x) {
      const double u = (x - 40.25) / 2.0;
      image.row(y)[x] =
          static_cast<std::uint8_t>(20.5 + 180.0 * std::exp(-0.5 * u * u) + (7 * x + 3 * y) % 3);
    }
  }
  return tuina::to_png(image);
}

// A sweep over the box of the thesis, a corner towards the scanner at 1 m.
void record_box(const std::string& folder) {
  using namespace tuina;
  const Mesh box = sim::box_mesh({0.0, 0.13, 0.41}, sim::corner_towards_y(), {0.15, 0.15, 0.2});
  sim::LaserScanner unit(box, sim::couch_mesh(BodyPosture::sitting),
                         sim::true_calibration(BodyPosture::sitting), 1, {});
  auto recorder = scanner::Recorder::open(unit, unit, folder);
  REQUIRE(recorder.has_value());
  REQUIRE(scanner::scan_sweep(*recorder, *recorder, unit.true_calibration()).has_value());
  REQUIRE(recorder->finish(unit.true_calibration()).has_value());
}

}  // namespace

TEST_CASE("scan, record and replay give one cloud, and say how good it is") {
  const Folder folder;
  const auto live =
      run_tuina({"scan", "--person", "phantom:medium", "--seed", "3", "--record", folder / "sweep",
                 "--out", folder / "live.ply", "--json", "--quiet"});
  REQUIRE_MESSAGE(live.exit_code == 0, live.err);
  CHECK(live.err.empty());
  const auto json = nlohmann::json::parse(live.out);
  CHECK(json["profiles"] > 60);
  CHECK(json["points"] > 20000);
  CHECK(json["rows_lit"] >= json["points"]);
  CHECK(json["sweep_s"] == doctest::Approx(6.0).epsilon(0.1));
  CHECK(json["rms_error_mm"] < 1.5);
  CHECK(json["expected_error_mm"] > 0.3);
  const auto replay =
      run_tuina({"scan", "--replay", folder / "sweep", "--out", folder / "replay.ply", "--json"});
  REQUIRE_MESSAGE(replay.exit_code == 0, replay.err);
  CHECK(nlohmann::json::parse(replay.out)["rms_error_mm"].is_null());
  CHECK(tuina::read_file(folder / "live.ply").value() ==
        tuina::read_file(folder / "replay.ply").value());

  // A second recording does not write over the first.
  const auto again =
      run_tuina({"scan", "--person", "phantom:medium", "--record", folder / "sweep", "--json"});
  CHECK(again.exit_code == 2);
  CHECK(again.out.empty());
}

TEST_CASE("a scan both ways finds the breath, and its recording replays to the same cloud") {
  const Folder folder;
  const auto live =
      run_tuina({"scan", "--person", "phantom:medium", "--breathing-mm", "6", "--both-ways",
                 "--record", folder / "sweep", "--out", folder / "live.ply", "--json", "--quiet"});
  REQUIRE_MESSAGE(live.exit_code == 0, live.err);
  const auto json = nlohmann::json::parse(live.out);
  CHECK(json["both_ways"]["breath_mm"] == doctest::Approx(6.0).epsilon(0.3));
  CHECK(json["both_ways"]["remaining_mm"] < 0.3);
  CHECK(json["rms_error_mm"] < 2.0);
  const auto replay =
      run_tuina({"scan", "--replay", folder / "sweep", "--out", folder / "replay.ply", "--json"});
  REQUIRE_MESSAGE(replay.exit_code == 0, replay.err);
  CHECK(nlohmann::json::parse(replay.out)["both_ways"] == json["both_ways"]);
  CHECK(tuina::read_file(folder / "live.ply").value() ==
        tuina::read_file(folder / "replay.ply").value());
}

TEST_CASE("a box of known size confirms a scan, and refuses it when it has another size") {
  const Folder folder;
  record_box(folder / "sweep");
  const auto check = [&](const std::string& size) {
    return run_tuina({"scan", "--replay", folder / "sweep", "--check-box", size, "--out",
                      folder / "box.ply", "--json", "--quiet"});
  };
  const auto good = check("200x150x150mm");
  REQUIRE_MESSAGE(good.exit_code == 0, good.err);
  const auto box = nlohmann::json::parse(good.out)["box"];
  CHECK(box["edges_mm"][0] == doctest::Approx(200.0).epsilon(0.02));
  CHECK(box["edges_mm"][1] == doctest::Approx(150.0).epsilon(0.02));
  CHECK(box["angles_deg"].size() == 3);
  std::filesystem::remove(folder / "box.ply");

  const std::vector<std::tuple<std::string, int, std::string>> refused = {
      {"210x150x150mm", 2, "scale"},      {"400x400x400mm", 2, "no box"},
      {"200x150", 1, "three edges"},      {"200x150x150cm", 1, "three edges"},
      {"-200x150x150", 1, "three edges"}, {"nanx150x150", 1, "three edges"}};
  for (const auto& [size, exit_code, cause] : refused) {
    CAPTURE(size);
    const auto outcome = check(size);
    CHECK(outcome.exit_code == exit_code);
    CHECK(outcome.out.empty());
    CHECK(outcome.err.find(cause) != std::string::npos);
    CHECK_FALSE(std::filesystem::exists(folder / "box.ply"));
  }
}

TEST_CASE("evaluate scanner answers for the parts that were asked for, with a page") {
  const Folder folder;
  const auto outcome = run_tuina({"evaluate", "scanner", "--only", "bodies", "--page",
                                  folder / "page.html", "--json", "--quiet"});
  REQUIRE_MESSAGE(outcome.exit_code == 0, outcome.err);
  const auto json = nlohmann::json::parse(outcome.out)["scanner"];
  CHECK(json["box"]["edges_mm"].size() == 3);
  CHECK(json["sphere"]["radius_mm"] == doctest::Approx(75.0).epsilon(0.01));
  CHECK_FALSE(json.contains("curves"));
  CHECK(tuina::read_file(folder / "page.html").value().find("</html>") != std::string::npos);
  CHECK(run_tuina({"evaluate", "scanner", "--only", "moon"}).exit_code == 1);
  CHECK(run_tuina({"evaluate", "scanner", "--calibration", "guessed"}).exit_code == 1);
}

TEST_CASE("a cloud is written as its name ends, in capitals, too") {
  const Folder folder;
  record_box(folder / "sweep");
  for (const auto& [name, begins] :
       {std::pair{"s.PCD", "# .PCD"}, std::pair{"s.pcd", "# .PCD"}, std::pair{"s.PLY", "ply"}}) {
    CAPTURE(name);
    const auto scan =
        run_tuina({"scan", "--replay", folder / "sweep", "--out", folder / name, "--quiet"});
    REQUIRE_MESSAGE(scan.exit_code == 0, scan.err);
    CHECK(tuina::read_file(folder / name).value().starts_with(begins));
  }
}

TEST_CASE("wrong use of scan is told from bad input, and leaves no file") {
  const Folder folder;
  const std::string out = folder / "scan.ply";
  const std::vector<std::pair<int, std::vector<std::string>>> cases = {
      {1, {}},
      {1, {"--person", "phantom:medium", "--replay", folder / "x"}},
      {1, {"--person", "phantom:medium", "--position", "standing"}},
      {1, {"--person", "phantom:medium", "--breathing-mm", "nan"}},
      {1, {"--person", "phantom:medium", "--set", "scan.sweep_s=0"}},
      {2, {"--person", folder / "nobody.ply"}},
      {2, {"--person", "phantom:medium", "--calibration", folder / "none.toml"}},
      {2, {"--replay", folder / "nothing"}},
      {2, {"--person", "phantom:medium", "--record", "/proc/no/sweep"}}};
  for (auto [exit_code, arguments] : cases) {
    arguments.insert(arguments.begin(), "scan");
    arguments.insert(arguments.end(), {"--json", "--out", out});
    CAPTURE(arguments);
    const auto outcome = run_tuina(arguments);
    CHECK(outcome.exit_code == exit_code);
    CHECK(outcome.out.empty());
    CHECK_FALSE(outcome.err.empty());
    CHECK_FALSE(std::filesystem::exists(out));
  }
  const auto nowhere =
      run_tuina({"scan", "--person", "phantom:slim", "--out", folder / "no/scan.ply"});
  CHECK(nowhere.exit_code == 2);
}

TEST_CASE("line writes a table of the rows and draws what it saw") {
  const Folder folder;
  const auto image = folder.with("frame.png", line_png());
  for (const char* method : {"centroid", "likelihood"}) {
    const auto outcome = run_tuina({"line", image, "--method", method, "--out", folder / "line.csv",
                                    "--picture", folder / "seen.png", "--json", "--quiet"});
    REQUIRE_MESSAGE(outcome.exit_code == 0, outcome.err);
    const auto json = nlohmann::json::parse(outcome.out);
    CHECK(json["rows"] == 64);
    CHECK(json["lit"] == 64);
    CHECK(json["compute_us"] > 0.0);
    std::istringstream csv(tuina::read_file(folder / "line.csv").value());
    std::string row;
    std::getline(csv, row);
    CHECK(row == "row,column_px,amplitude_dn");
    int rows = 0;
    while (std::getline(csv, row)) {
      const auto comma = row.find(',');
      CHECK(std::stoi(row) == rows++);
      CHECK(std::stod(row.substr(comma + 1)) == doctest::Approx(40.25).epsilon(0.002));
    }
    CHECK(rows == 64);
    CHECK(tuina::read_png(folder / "seen.png")->image.channels == 3);
  }
  const auto to_stdout = run_tuina({"line", image});
  CHECK(to_stdout.out.rfind("row,column_px,amplitude_dn\n", 0) == 0);
}

TEST_CASE("line refuses what is no picture, or not the picture's own dark frame") {
  const Folder folder;
  const auto image = folder.with("frame.png", line_png());
  const auto small = folder.with("small.png", tuina::to_png(tuina::Image(10, 10)));
  const auto text = folder.with("text.png", "row,column\n");
  CHECK(run_tuina({"line", folder / "none.png"}).exit_code == 2);
  CHECK(run_tuina({"line", text}).exit_code == 2);
  CHECK(run_tuina({"line", image, "--dark", small}).exit_code == 2);
  const tuina::PngFile frame = tuina::read_png(image).value();
  tuina::Image white(frame.image.width, frame.image.height);
  std::fill(white.data.begin(), white.data.end(), std::uint8_t{255});
  const auto saturated =
      run_tuina({"line", image, "--dark", folder.with("white.png", tuina::to_png(white))});
  CHECK(saturated.exit_code == 2);
  CHECK(saturated.err.find("100 % of it is saturated") != std::string::npos);
  CHECK(run_tuina({"line", image, "--method", "guess"}).exit_code == 1);
  CHECK(run_tuina({"line"}).exit_code == 1);
  const auto unwritable = run_tuina({"line", image, "--json", "--out", folder / "no/line.csv"});
  CHECK(unwritable.exit_code == 2);
  CHECK(unwritable.out.empty());
}
