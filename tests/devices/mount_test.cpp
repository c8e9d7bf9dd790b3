// SPDX-License-Identifier: Apache-2.0
// The scanner's mount as files for a printer.
#include <doctest/doctest.h>

#include <array>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/whole/command.hpp"
#include "tuina/core/geometry.hpp"
#include "tuina/core/io/file.hpp"

using nlohmann::json;
using tuina::Vector3;
using tuina::test::Folder;
using tuina::test::run_tuina;

namespace {

using Corner = std::array<double, 3>;

struct Solid {
  int triangles = 0;
  int open_edges = 0;  ///< that do not lie between just two triangles, one each way
  double volume_mm3 = 0.0;
};

Solid solid_of(const std::string& stl) {
  std::istringstream words(stl);
  std::vector<Corner> corners;
  for (std::string word; words >> word;) {
    if (word != "vertex") continue;
    Corner& corner = corners.emplace_back();
    words >> corner[0] >> corner[1] >> corner[2];
  }
  Solid solid{.triangles = static_cast<int>(corners.size() / 3)};
  std::map<std::pair<Corner, Corner>, int> edges;
  const auto at = [&](std::size_t i) { return Vector3(corners[i].data()); };
  for (std::size_t i = 0; i + 2 < corners.size(); i += 3) {
    for (std::size_t k = 0; k < 3; ++k) ++edges[{corners[i + k], corners[i + (k + 1) % 3]}];
    solid.volume_mm3 += at(i).dot(at(i + 1).cross(at(i + 2))) / 6.0;
  }
  for (const auto& [edge, times] : edges) {
    const auto back = edges.find({edge.second, edge.first});
    solid.open_edges += times == 1 && back != edges.end() && back->second == 1 ? 0 : 1;
  }
  return solid;
}

std::string text_of(const std::string& file) {
  return tuina::read_file(file, 1 << 24).value_or("");
}

}  // namespace

TEST_CASE("the parts of the mount are closed solids of the volume that is told") {
  const Folder folder;
  const std::vector<std::vector<std::string>> mounts = {
      {}, {"--laser-mm", "12", "--baseline-mm", "150", "--lean-deg", "25", "--thickness-mm", "4"}};
  for (const auto& options : mounts) {
    std::vector<std::string> words = {"export",  "mount", "--json",
                                      "--quiet", "--out", folder / "mount"};
    words.insert(words.end(), options.begin(), options.end());
    const auto made = run_tuina(words);
    REQUIRE_MESSAGE(made.exit_code == 0, made.err);
    const json told = json::parse(made.out);
    REQUIRE(told.size() == 3);
    for (const auto& [name, part] : told.items()) {
      CAPTURE(name);
      const Solid solid = solid_of(text_of(folder / ("mount/" + name + ".stl")));
      CHECK(solid.triangles > 50);
      CHECK(solid.open_edges == 0);
      CHECK(solid.volume_mm3 == doctest::Approx(part["volume_mm3"].get<double>()).epsilon(1e-6));
      const std::string step = text_of(folder / ("mount/" + name + ".step"));
      CHECK(step.starts_with("ISO-10303-21;"));
      CHECK(step.find("FACETED_BREP('" + name) != std::string::npos);
    }
    const bool usual = options.empty();
    CHECK(told["bar"]["width_mm"].get<double>() == doctest::Approx(usual ? 260.0 : 210.0));
  }
}

TEST_CASE("a mount that cannot be is refused") {
  CHECK(run_tuina({"export", "mount"}).exit_code == 1);
  CHECK(run_tuina({"export", "mount", "--out", "x", "--lean-deg", "80"}).exit_code == 1);
  CHECK(run_tuina({"export", "mount", "--out", "/dev/null/mount"}).exit_code == 2);
  const Folder folder;
  const auto deep = run_tuina({"export", "mount", "--json", "--out", folder / "a/mount"});
  CHECK(deep.exit_code == 2);
  CHECK(deep.out.empty());
  CHECK_MESSAGE(deep.err.find("a/mount: the folder cannot be made: No such file or directory") !=
                    std::string::npos,
                deep.err);
  CHECK_FALSE(std::filesystem::exists(folder / "a"));
}
