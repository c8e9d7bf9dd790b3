// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/whole/command.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/core/io/surface_file.hpp"
#include "tuina/core/random.hpp"
#include "tuina/core/units.hpp"
#include "tuina/sim/person/phantom.hpp"
#include "tuina/sim/scanner/depth_camera.hpp"

namespace tuina {
namespace {

using test::Folder;
using test::run_tuina;

/// A person on the chair and a board that lay there before, as files of a folder.
void put_scene(const Folder& folder) {
  const auto person =
      sim::make_phantom(sim::draw_phantom(sim::BodyType::medium, 3), BodyPosture::sitting);
  REQUIRE(write_cloud(folder / "person.ply", {.points = person.skin_in_couch.vertices}));
  PointCloud board;
  Random random = make_random(1, "board");
  for (int i = 0; i < 4000; ++i) {
    const double up = uniform(random, 0.1, 0.7);
    board.points.emplace_back(uniform(random, -0.2, 0.2), -0.1 * up, up);
  }
  REQUIRE(write_cloud(folder / "board.ply", board));
}

}  // namespace

TEST_CASE("an installed program takes the atlas beside the folder that it is in") {
  const Folder folder;
  put_scene(folder);
  std::filesystem::create_directories(folder / "share/tuina/models");
  (void)folder.with("share/tuina/models/atlas.tuina", "mine");
  for (const char* where : {"bin", "lib", "lib64"}) {
    CAPTURE(where);
    std::filesystem::create_directory(folder / where);
    const std::string program = folder / where + "/tuina";
    std::filesystem::copy(TUINA_BINARY, program);
    const std::string command =
        "'" + program + "' map '" + folder / "person.ply" + "' --quiet 2>'" + folder / "err'";
    CHECK(std::system(command.c_str()) != 0);
    CHECK(read_file(folder / "err").value().find("share/tuina/models/atlas.tuina: not an atlas") !=
          std::string::npos);
  }
}

TEST_CASE("map takes the plane of the thesis from the scan of a board") {
  const Folder folder;
  put_scene(folder);
  const auto map = [&](std::vector<std::string> more) {
    std::vector<std::string> words = {"map", folder / "person.ply", "--json", "--quiet"};
    words.insert(words.end(), more.begin(), more.end());
    return run_tuina(words);
  };
  const auto own = map({"--method", "field_morphing"});
  const auto board = map({"--method", "field_morphing", "--board", folder / "board.ply"});
  REQUIRE_MESSAGE(own.exit_code == 0, own.err);
  REQUIRE_MESSAGE(board.exit_code == 0, board.err);
  const auto place = [](const test::Outcome& answer) {
    const auto xyz = nlohmann::json::parse(answer.out)["acupoints"]["GV4"]["position_m"];
    return Vector3(xyz[0].get<double>(), xyz[1].get<double>(), xyz[2].get<double>());
  };
  // The back leans a little against the board, so the two planes see it a little differently.
  CHECK((place(own) - place(board)).norm() < 60_mm);
  CHECK((place(own) - place(board)).norm() > 0.01_mm);
  CHECK(map({"--board", folder / "board.ply"}).exit_code == 1);
  CHECK(map({"--method", "field_morphing", "--board", folder / "person.ply"}).exit_code == 2);
  CHECK(map({"--method", "field_morphing", "--board", folder / "none.ply"}).exit_code == 2);
}

TEST_CASE("a finger that shows a point moves the others, and a wrong one is refused") {
  const Folder folder;
  put_scene(folder);
  const auto map = [&](std::vector<std::string> more) {
    std::vector<std::string> words = {"map", folder / "person.ply", "--json", "--quiet"};
    words.insert(words.end(), more.begin(), more.end());
    return run_tuina(words);
  };
  const auto before = map({});
  REQUIRE_MESSAGE(before.exit_code == 0, before.err);
  const auto over_itself = map({"--out", folder / "person.ply"});
  CHECK(over_itself.exit_code == 1);
  CHECK(over_itself.err.find("would be lost") != std::string::npos);
  CHECK(map({}).exit_code == 0);
  const auto points = nlohmann::json::parse(before.out)["acupoints"];
  CHECK_FALSE(nlohmann::json::parse(before.out).contains("fixed"));
  const auto place = [&](const char* name, double up_m) {
    const auto at = points[name]["position_m"];
    return fmt::format("{},{},+{}", at[0].get<double>(), at[1].get<double>(),
                       at[2].get<double>() + up_m);
  };
  const auto after = map({"--fix", "BL18_L=" + place("BL18_L", 0.01), "--fix-error-mm", "2",
                          "--out", folder / "acupoints.json"});
  REQUIRE_MESSAGE(after.exit_code == 0, after.err);
  const auto answer = nlohmann::json::parse(after.out);
  CHECK(answer["fixed"]["BL18_L"]["error_mm"] == 2.0);
  const auto& moved = answer["acupoints"]["BL47_R"];
  CHECK(moved["position_m"][2].get<double>() >
        points["BL47_R"]["position_m"][2].get<double>() + 5_mm);
  // The radius reaches back to where the scan had it; where the finger agrees, it shrinks.
  CHECK(moved["uncertainty_mm"].get<double>() >
        to_mm(moved["position_m"][2].get<double>() -
              points["BL47_R"]["position_m"][2].get<double>()));
  const auto agrees = map({"--fix", "BL18_L=" + place("BL18_L", 0.001)});
  REQUIRE_MESSAGE(agrees.exit_code == 0, agrees.err);
  CHECK(nlohmann::json::parse(agrees.out)["acupoints"]["BL47_R"]["uncertainty_mm"].get<double>() <
        points["BL47_R"]["uncertainty_mm"].get<double>());

  const auto other_side = map({"--fix", "BL18_L=" + place("BL18_R", 0.0)});
  CHECK(other_side.exit_code == 2);
  CHECK(other_side.err.find("other side") != std::string::npos);
  CHECK(map({"--fix", "GV4=0,2,0.3"}).exit_code == 2);
  const auto unknown = map({"--fix", "GV44=" + place("GV4", 0.0)});
  CHECK(unknown.exit_code == 1);
  CHECK(unknown.err.find("is `GV4` meant?") != std::string::npos);
}

TEST_CASE("a picture of a depth camera says the same as PLY and as PCD") {
  const Folder folder;
  const auto person =
      sim::make_phantom(sim::draw_phantom(sim::BodyType::medium, 3), BodyPosture::prone);
  const PointCloud picture =
      sim::depth_picture(person.skin_in_couch, person.position, 5, {.points = 50'000});
  REQUIRE(write_cloud(folder / "person.ply", picture));
  REQUIRE(write_cloud(folder / "person.pcd", picture, CloudFormat::pcd_binary));
  const auto ply = run_tuina({"map", folder / "person.ply", "--json", "--quiet"});
  const auto pcd = run_tuina({"map", folder / "person.pcd", "--json", "--quiet"});
  REQUIRE_MESSAGE(ply.exit_code == 0, ply.err);
  REQUIRE_MESSAGE(pcd.exit_code == 0, pcd.err);
  const auto from_ply = nlohmann::json::parse(ply.out);
  CHECK(from_ply["position"] == "prone");
  CHECK(from_ply["acupoints"] == nlohmann::json::parse(pcd.out)["acupoints"]);
}

TEST_CASE("the points of a depth picture are asked for with a depth picture only") {
  const auto outcome = run_tuina({"evaluate", "acupoints", "--depth-points", "20000"});
  CHECK(outcome.exit_code == 1);
  CHECK(outcome.err.find("--scan depth") != std::string::npos);
  CHECK(run_tuina({"evaluate", "acupoints", "--scan", "depth", "--depth-points", "5"}).exit_code ==
        1);
}

}  // namespace tuina
