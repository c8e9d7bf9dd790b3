// SPDX-License-Identifier: Apache-2.0
// A taught motion that is stopped. The request to end stays for the life of a program.
#include "apps/simulated/play_motion.hpp"

#include <doctest/doctest.h>

#include <csignal>

#include "apps/cli/asked_to_end.hpp"
#include "apps/simulated/teaching.hpp"

using namespace tuina;

TEST_CASE("a motion that is stopped stands still where it was") {
  const app::CommonOptions quiet{.quiet = true};
  const session::Config config;
  const auto taught = app::record_by_hand({}, config, quiet);
  REQUIRE_MESSAGE(taught.has_value(), taught.error().message);
  const auto way_m = [](const app::PlayedMotion& played) {
    double max_m = 0.0;
    for (const app::TeachRow& row : played.truth)
      max_m = std::max(max_m, (row.tool_in_couch - played.truth.front().tool_in_couch).norm());
    return max_m;
  };
  // The loop goes on for 1.5 s, of which the motion would have one.
  const session::TaughtMotion& motion = taught->motion;
  REQUIRE((motion.at(1.0).q_rad - motion.at(0.0).q_rad).norm() > 0.05);
  app::end_when_asked();
  std::raise(SIGINT);
  const auto stopped = app::play_motion(motion, "phantom:medium", config, quiet, "");
  REQUIRE_MESSAGE(stopped.has_value(), stopped.error().message);
  CHECK(stopped->stop == "asked to stop");
  MESSAGE("the tool moved by ", 1e3 * way_m(*stopped), " mm");
  CHECK(way_m(*stopped) < 2e-3);
}
