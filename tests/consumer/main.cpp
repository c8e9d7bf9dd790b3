// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include "tuina/core/io/surface_file.hpp"
#include "tuina/session/config.hpp"

int main() {
  const auto config = tuina::session::parse_config("[scan]\nsweep_s = 5.0\n", "inline");
  if (!config) {
    std::fprintf(stderr, "%s\n", config.error().message.c_str());
    return 1;
  }
  const tuina::Mesh triangle{.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
                             .triangles = {{0, 1, 2}}};
  const auto again = tuina::parse_surface(tuina::to_ply(triangle), "triangle");
  std::printf("a sweep of %.1f s, %zu points\n", config->scan.sweep_s,
              again ? again->cloud.size() : 0);
  return again && again->cloud.size() == 3 ? 0 : 1;
}
