// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/whole/command.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/core/io/surface_file.hpp"
#include "tuina/core/units.hpp"
#include "tuina/sim/person/person.hpp"

using nlohmann::json;
using tuina::test::Folder;
using tuina::test::run_tuina;

namespace {

/// scan.ply and acupoints.json of a phantom, as `scan` and `map` would leave them.
void write_phantom(const Folder& folder) {
  const auto person =
      tuina::sim::parse_person("phantom:medium", tuina::BodyPosture::sitting, 1).value();
  json map = {
      {"position", "sitting"}, {"acupoints", json::object()}, {"landmarks", json::object()}};
  const auto three = [](const tuina::Vector3& v) { return json{v.x(), v.y(), v.z()}; };
  for (const tuina::Acupoint& point : person.acupoints) {
    map["acupoints"][point.name] = {{"position_m", three(point.at_in_couch)},
                                    {"normal", three(point.normal_in_couch)},
                                    {"uncertainty_mm", 8.0}};
  }
  for (const tuina::Landmark& landmark : person.landmarks) {
    map["landmarks"][landmark.name] = three(landmark.at_in_couch);
  }
  REQUIRE(tuina::write_file(folder / "scan.ply", tuina::to_ply(person.skin_in_couch)).has_value());
  REQUIRE(tuina::write_file(folder / "acupoints.json", map.dump()).has_value());
}

}  // namespace

TEST_CASE("plan writes the paths of two arms and draws them") {
  const Folder folder;
  write_phantom(folder);
  const std::string mine =
      folder.with("mine.toml",
                  "name = \"mine\"\n"
                  "[[part]]\ntechnique = \"press\"\npoints = [\"BL47\", \"GV4\"]\n"
                  "[[part]]\ntechnique = \"rub\"\npoints = [\"BL47\"]\nrepeats = 1\n");
  const auto planned = run_tuina({"plan", folder / "scan.ply", folder / "acupoints.json",
                                  "--programme", mine, "--json", "--quiet", "--out",
                                  folder / "plan.json", "--picture", folder / "plan.svg"});
  REQUIRE_MESSAGE(planned.exit_code == 0, planned.err);
  const json plan = json::parse(planned.out);
  CHECK(json::parse(tuina::read_file(folder / "plan.json").value()) == plan);
  CHECK(plan["programme"] == "mine");
  CHECK(plan["duration_s"].get<double>() > 10.0);
  CHECK(plan["reachable"].is_boolean());
  CHECK(plan["min_arm_distance_mm"].is_number());
  CHECK(plan["zones_touched"].is_array());
  REQUIRE(plan["paths"].size() == 5);
  std::vector<std::string> arms;
  for (const json& path : plan["paths"]) {
    CHECK(path["peak_n"].get<double>() <= path["cap_n"].get<double>());
    CHECK(path["points"].size() > 10);
    arms.push_back(path["arm"]);
  }
  CHECK(std::count(arms.begin(), arms.end(), "left") > 0);
  CHECK(std::count(arms.begin(), arms.end(), "right") > 0);
  const std::string picture = tuina::read_file(folder / "plan.svg").value_or("");
  CHECK(picture.starts_with("<svg"));
  for (const char* said : {"BL47 L", "GV4", "Pressing", "Rubbing", "data:image/png;base64,"}) {
    CAPTURE(said);
    CHECK(picture.find(said) != std::string::npos);
  }
}

TEST_CASE("plan refuses what it cannot use, says where, and leaves no file") {
  const Folder folder;
  write_phantom(folder);
  const std::string scan = folder / "scan.ply";
  const std::string points = folder / "acupoints.json";
  const std::string bad = folder.with(
      "bad.toml", "name = \"bad\"\n[[part]]\ntechnique = \"press\"\npoints = [\"BL74\"]\n");
  const auto fails = [&](const std::vector<std::string>& arguments, int exit_code,
                         const char* says) {
    auto all = arguments;
    all.insert(all.begin(), "plan");
    all.insert(all.end(), {"--json", "--out", folder / "none.json"});
    const auto outcome = run_tuina(all);
    CAPTURE(outcome.err);
    CHECK(outcome.exit_code == exit_code);
    CHECK(outcome.out.empty());
    CHECK(outcome.err.find(says) != std::string::npos);
    CHECK_FALSE(std::filesystem::exists(folder / "none.json"));
  };
  fails({}, 1, "required");
  fails({scan, points, "--programme", "relaks"}, 2, "is `relax` meant?");
  fails({scan, points, "--programme", bad}, 2,
        "bad.toml:4: the point `BL74` is unknown; is `BL47` meant?");
  fails({scan, folder / "absent.json"}, 2, "absent.json");
  fails({folder / "absent.ply", points}, 2, "absent.ply");
  fails({scan, folder.with("empty.json", "{}")}, 2,
        "empty.json: is no answer of `tuina map`: acupoints is missing");
  fails({scan, folder.with("half.json", "{\"acupoints\": {")}, 2,
        "half.json:1: is no answer of `tuina map`: what stands there is not JSON");
}
