// SPDX-License-Identifier: Apache-2.0
// Strokes hand over hand, as both arms truly do them.
#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "tests/whole/command.hpp"
#include "tuina/core/io/csv.hpp"

using nlohmann::json;
using tuina::test::Folder;
using tuina::test::run_tuina;

TEST_CASE("hand over hand, one of the hands presses all the time, and the arms stay apart") {
  const Folder folder;
  const std::string programme =
      folder.with("hands.toml",
                  "name = \"hands\"\n[[part]]\ntechnique = \"stroke\"\nforce_n = 12\n"
                  "points = [\"SI11\", \"BL47\", \"BL50\"]\nhand_over_hand = true\nrepeats = 2\n");
  const std::string out = folder / "out";
  const auto done = run_tuina({"massage", "--person", "phantom:slim", "--programme", programme,
                               "--json", "--quiet", "--out", out});
  REQUIRE_MESSAGE(done.exit_code == 0, done.err);
  const json session = json::parse(done.out);
  CHECK(session["stops"].empty());
  CHECK(session["massage"]["min_arm_distance_mm"] >= 60.0);
  REQUIRE(session["massage"]["performed"].size() == 2);

  // Both arms have a row at every time: the hand that presses more, and the other.
  const auto trace =
      tuina::read_csv(std::filesystem::path(out) / "trace.csv", {"time_s", "true_force_n"});
  REQUIRE_MESSAGE(trace.has_value(), trace.error().message);
  std::map<double, std::pair<double, double>> force_n;
  for (std::size_t i = 0; i < trace->rows(); ++i) {
    auto& [stronger, weaker] = force_n.try_emplace(trace->columns[0][i], 0.0, 1e9).first->second;
    stronger = std::max(stronger, trace->columns[1][i]);
    weaker = std::min(weaker, trace->columns[1][i]);
  }
  const auto strokes = [](const auto& at) { return at.second.first > 11.0; };
  const auto first = std::find_if(force_n.begin(), force_n.end(), strokes);
  const auto last = std::find_if(force_n.rbegin(), force_n.rend(), strokes).base();
  REQUIRE(first != last);
  CHECK(std::prev(last)->first - first->first > 10.0);
  // Two hands change over three times; at none of them does the person feel a gap.
  double min_n = 1e9;
  int changes = 0;
  bool both = false;
  for (auto at = first; at != last; ++at) {
    const auto& [stronger, weaker] = at->second;
    min_n = std::min(min_n, stronger);
    const bool both_now = weaker > (both ? 6.0 : 9.0);
    changes += both_now && !both;
    both = both_now;
  }
  CHECK(min_n > 10.0);
  CHECK(changes == 3);
}
