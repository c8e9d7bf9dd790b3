// SPDX-License-Identifier: Apache-2.0
#include "tuina/robot/robot_model.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "tuina/core/random.hpp"
#include "tuina/robot/arm_model.hpp"
#include "tuina/robot/clearance.hpp"
#include "tuina/robot/inverse_kinematics.hpp"
#include "tuina/robot/ready_posture.hpp"

using namespace tuina;
using namespace tuina::robot;

namespace {

struct Place {
  const char* robot;
  BodyPosture position;
  bool head_at_plus_y;
};
constexpr std::array places = {
    Place{"thesis", BodyPosture::sitting, false},    Place{"thesis", BodyPosture::prone, false},
    Place{"successor", BodyPosture::sitting, false}, Place{"successor", BodyPosture::prone, false},
    Place{"successor", BodyPosture::prone, true},    Place{"panda", BodyPosture::sitting, false},
    Place{"panda", BodyPosture::prone, false},       Place{"ur", BodyPosture::sitting, false},
    Place{"ur", BodyPosture::prone, false}};

RobotPlacement placed(const Place& place) {
  return place_robot(load_robot(place.robot).value(), place.position, place.head_at_plus_y);
}

}  // namespace

TEST_CASE(
    "each arm's model and the whole robot put the tool in the same place, base moved or not") {
  Random random = make_random(7, "placement");
  for (const Place& place : places) {
    const RobotPlacement placement = placed(place);
    CAPTURE(place.robot);
    CAPTURE(name_of(place.position));
    CAPTURE(place.head_at_plus_y);
    WholeRobot whole = whole_of(placement, {.of = {placement.arm, placement.arm}});
    const auto models = both_models(placement.arm, placement.mount);
    const double rail_m = 0.5 * placement.mount.min_rail_m;
    PerArm<JointVector> q_rad;
    for (const Arm arm : both_arms) {
      q_rad[arm] = JointVector(placement.arm.joints);
      for (double& q : q_rad[arm]) q = uniform(random, -1.0, 1.0);
    }
    for (std::size_t i = 0; i < whole.q.size(); ++i) {
      const std::string& name = whole.description.parts[i].name;
      if (name == whole.rail) whole.q[i] = rail_m;
      for (const Arm arm : both_arms) {
        for (int k = 0; k < placement.arm.joints; ++k) {
          const std::string& link = placement.arm.links[static_cast<std::size_t>(k)].name;
          if (name == std::string(name_of(arm)) + "_" + link) whole.q[i] = q_rad[arm][k];
        }
      }
    }
    const auto poses = base_from_parts(whole.description, whole.q);
    int compared = 0;
    for (const Marker& marker : whole.description.markers) {
      for (const Arm arm : both_arms) {
        if (marker.name != std::string(name_of(arm)) + "_tool") continue;
        const Transform tool =
            poses[static_cast<std::size_t>(marker.part)] * marker.part_from_marker;
        const Transform same = models[arm].base_from_tool(q_rad[arm], rail_m);
        CHECK((tool.matrix() - same.matrix()).cwiseAbs().maxCoeff() < 1e-10);
        ++compared;
      }
    }
    CHECK(compared == 2);
  }
}

TEST_CASE("every robot waits with both arms in their ranges, clear of couch, body and each other") {
  for (const Place& place : places) {
    const RobotPlacement placement = placed(place);
    CAPTURE(place.robot);
    CAPTURE(name_of(place.position));
    CAPTURE(place.head_at_plus_y);
    const auto models = both_models(placement.arm, placement.mount);
    const auto ready = ready_posture(placement.arm, placement.mount);
    const ReadyRoom room = ready_room(models, placement.mount, ready, 0.0);
    for (const Arm arm : both_arms) {
      CHECK(limit_room_rad(placement.arm, ready[arm]) > 0.0);
      CHECK(room.off_m[arm] < 1e-3);
    }
    CAPTURE(room.nearest());
    CHECK(room.min_m() > 60e-3);
    // The arm that the session calls the left is on the side of the couch's positive x.
    const Transform couch_from_base = placement.mount.base_from_couch.inverse();
    CHECK((couch_from_base * models[Arm::left].shoulder_in_base(0.0)).x() > 0.1);
  }
}

TEST_CASE("the successor's body stands clear of chair and bed wherever its base goes") {
  for (const Place& place : places) {
    if (std::string(place.robot) != "successor") continue;
    const RobotMount mount = placed(place).mount;
    const Obstacle& couch = mount.obstacles.front();
    REQUIRE(couch.kind == Surrounding::couch);
    int parts = 0;
    for (const Obstacle& part : mount.obstacles) {
      if (part.kind != Surrounding::body) continue;
      ++parts;
      for (const double rail_m : {mount.min_rail_m, 0.0, mount.max_rail_m}) {
        double nearest_m = 1.0;
        constexpr int steps = 6;
        for (int i = 0; i <= steps * steps * steps + 3 * steps * steps + 3 * steps; ++i) {
          const int n = steps + 1;
          const Vector3 share(i % n, i / n % n, i / (n * n));
          const Vector3 at =
              part.base_from_box *
                  Vector3((share / steps - Vector3::Constant(0.5)).cwiseProduct(part.edges_m)) +
              rail_m * mount.rail_axis_in_base;
          const Vector3 in_couch = couch.base_from_box.inverse() * at;
          nearest_m =
              std::min(nearest_m, segment_to_box_m(in_couch, in_couch, 0.5 * couch.edges_m));
        }
        CHECK(nearest_m > 15e-3);
      }
    }
    CHECK(parts >= 5);
  }
}
