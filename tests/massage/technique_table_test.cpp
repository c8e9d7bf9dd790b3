// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <filesystem>
#include <regex>
#include <set>
#include <tuple>

#include "tuina/core/io/file.hpp"
#include "tuina/core/technique.hpp"

using namespace tuina;

TEST_CASE("a technique is found by its name, and no two share a name or a colour") {
  std::set<std::string> names;
  std::set<std::tuple<int, int, int>> colours;
  for (const TechniqueRow& row : technique_table) {
    CHECK(parse_technique(row.name) == row.technique);
    CHECK(row.usual_force_n > row.overshoot_n);
    names.insert(row.name);
    colours.emplace(row.colour.red, row.colour.green, row.colour.blue);
  }
  CHECK(names.size() == technique_table.size());
  CHECK(colours.size() == technique_table.size());
  CHECK(technique_names().size() == technique_table.size());
  CHECK_FALSE(parse_technique("pres").has_value());
}

TEST_CASE("no source but the table lists the techniques") {
  const std::regex listed("(Technique::[a-z]+,\\s*){2}Technique::[a-z]+");
  const std::filesystem::path root = TUINA_SOURCE_DIR;
  int seen = 0;
  for (const char* folder : {"tuina", "apps"}) {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(root / folder)) {
      const std::string extension = entry.path().extension().string();
      if (extension != ".cpp" && extension != ".hpp") continue;
      if (entry.path().filename() == "technique.hpp") continue;
      const auto text = read_file(entry.path());
      REQUIRE(text.has_value());
      CAPTURE(entry.path().string());
      std::size_t named = 0;
      for (const std::string& name : technique_names())
        named += text->find('"' + name + '"') != std::string::npos;
      CHECK(named <= 1);
      CHECK_FALSE(std::regex_search(*text, listed));
      ++seen;
    }
  }
  CHECK(seen > 100);
}
