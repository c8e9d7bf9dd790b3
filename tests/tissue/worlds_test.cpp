// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include "apps/evaluation/tissue/world_trials.hpp"

using namespace tuina;
using namespace tuina::app;

namespace {

WorldResult tried(const std::string& name) {
  for (const sim::TissueWorld& world : sim::tissue_worlds()) {
    if (world.name == name) return run_world(world, 2, 4242, 1);
  }
  FAIL("no such world: " << name);
  return {};
}

}  // namespace

TEST_CASE("the next press on tissue that relaxes, creeps or has layers is foretold to 5 per cent") {
  for (const std::string name : {"control", "qlv30", "fung", "layered", "hunt_crossley"}) {
    CAPTURE(name);
    const WorldResult result = tried(name);
    CHECK(result.p90_error < 0.05);
    CHECK(result.coverage > 0.85);
    CHECK(result.converged_share > 0.85);
    CHECK(result.wrong_share == 0.0);
  }
}

TEST_CASE("the tangent law without memory is far off where the other is not") {
  const WorldResult result = tried("qlv30");
  CHECK(result.tangent_p90_error > 4.0 * result.p90_error);
}

TEST_CASE("a person who tenses at whim is not called known") {
  const WorldResult result = tried("guarding");
  CHECK(result.coverage > 0.7);
  CHECK(result.converged_share < 0.4);
}
