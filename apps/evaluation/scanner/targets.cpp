// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "apps/evaluation/scanner/proof.hpp"
#include "tuina/core/units.hpp"

namespace tuina::app {
namespace {

struct Wanted {
  double depth_m, clean_mm, speckled_mm;
};
constexpr Wanted of_walls[] = {{0.65, 0.3, 0.6}, {1.0, 0.5, 1.0}, {1.75, 1.7, 2.2}};

void add_walls(const std::vector<WallTrial>& walls, bool speckled, std::vector<Target>& targets) {
  for (const Wanted& wanted : of_walls) {
    for (const WallTrial& wall : walls) {
      if (wall.depth_m != wanted.depth_m) continue;
      targets.push_back(
          {.name = fmt::format("wall at {} m{}, mm", wanted.depth_m, speckled ? ", speckle" : ""),
           .wanted = speckled ? wanted.speckled_mm : wanted.clean_mm,
           .measured = to_mm(wall.ours.rms_m)});
    }
  }
}

}  // namespace

std::vector<Target> targets_of(const ScannerProof& proof) {
  std::vector<Target> targets;
  add_walls(proof.walls, false, targets);
  add_walls(proof.speckled_walls, true, targets);
  const auto of_back = [&](const char* key, const std::string& name, double wanted, auto value,
                           bool at_least = false) {
    const auto found = proof.backs.find(key);
    if (found == proof.backs.end()) return;
    targets.push_back(
        {.name = name, .wanted = wanted, .measured = value(found->second), .at_least = at_least});
  };
  const auto rms = [](const BackTrial& back) { return to_mm(back.rms_m); };
  const auto outliers = [](const BackTrial& back) { return 100.0 * back.outlier_share; };
  const auto seen = [](const BackTrial& back) { return 100.0 * back.seen_share; };
  of_back("noise_only", "back at 1.1 m, mm", 0.6, rms);
  of_back("noise_only", "back, seen of what laser and camera see, %", 99.0, seen, true);
  of_back("noise_only", "back, outliers beyond 5 mm, %", 0.05, outliers);
  of_back("speckle", "back with speckle, mm", 1.1, rms);
  of_back("room_light_60_dark_frames", "back in room light, dark frames, mm", 0.8, rms);
  of_back("room_light_60", "back in room light, mm", 1.0, rms);
  of_back("room_light_60", "back in room light, outliers, %", 1.0, outliers);
  of_back("saturated", "back, clipped, mm", 0.6, rms);
  for (const char* tone : {"light", "medium", "dark"}) {
    const std::string key = fmt::format("skin_{}", tone);
    of_back(key.c_str(), fmt::format("{} skin that scatters, mm", tone), 0.6, rms);
    of_back(key.c_str(), fmt::format("{} skin that scatters, bias, mm", tone), 0.3,
            [](const BackTrial& back) { return std::abs(to_mm(back.bias_m)); });
  }
  if (proof.worst_latency_s) {
    targets.push_back({.name = "latency, worst scanner, ms",
                       .wanted = 3.0,
                       .measured = 1e3 * *proof.worst_latency_s});
  }
  return targets;
}

}  // namespace tuina::app
