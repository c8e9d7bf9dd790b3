// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

// What users include: one header for each room.
#include "tuina/body.hpp"
#include "tuina/calibration.hpp"
#include "tuina/control.hpp"
#include "tuina/core.hpp"
#include "tuina/hardware.hpp"
#include "tuina/history.hpp"
#include "tuina/link.hpp"
#include "tuina/massage.hpp"
#include "tuina/motion.hpp"
#include "tuina/record.hpp"
#include "tuina/robot.hpp"
#include "tuina/ros2.hpp"
#include "tuina/safety.hpp"
#include "tuina/scanner.hpp"
#include "tuina/session.hpp"
#include "tuina/sim.hpp"
#include "tuina/telemetry.hpp"
#include "tuina/tissue.hpp"

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
