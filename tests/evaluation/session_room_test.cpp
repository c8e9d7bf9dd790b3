// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <algorithm>

#include "apps/simulated/session_order.hpp"
#include "tuina/robot/arm_table.hpp"
#include "tuina/session/realism.hpp"

using namespace tuina;

namespace {

/// True if the session of such a world takes all gears of its arms for rigid.
bool believed_rigid(const char* realism, const char* arms) {
  session::Config config;
  config.simulation.realism = realism;
  session::set_realism(config.simulation);
  config.simulation.arms = arms;
  const auto room = app::make_room({.position = BodyPosture::prone}, config, {.quiet = true});
  REQUIRE(room);
  return std::ranges::all_of(room->order.robot.arm.links, [](const robot::Link& link) {
    return robot::likely_gear_nm_per_rad(link) >= robot::rigid_gear_nm_per_rad;
  });
}

}  // namespace

TEST_CASE("depths are put right for gears that give way, and for no others") {
  CHECK_FALSE(believed_rigid("usual", "torque"));
  CHECK(believed_rigid("ideal", "torque"));
  CHECK(believed_rigid("usual", "position_500"));  // gears within the maker's loop
}
