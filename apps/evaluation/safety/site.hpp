// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tuina/core/result.hpp"
#include "tuina/robot/arm_model.hpp"
#include "tuina/safety/limits.hpp"
#include "tuina/safety/zone_field.hpp"
#include "tuina/sim/person/tissue_map.hpp"
#include "tuina/sim/world.hpp"

namespace tuina::app {

/// One place on the back of one simulated person, one arm that treats it, and how that arm stands.
struct Site {
  std::string name;  ///< "sitting medium, hard, left arm"
  std::string spot;  ///< "hard"
  BodyPosture position = BodyPosture::sitting;
  sim::BodyType body_type = sim::BodyType::medium;
  Arm arm = Arm::left;
  Vector3 at_in_couch = Vector3::Zero();       ///< on the true skin
  Vector3 normal_in_couch = Vector3::UnitY();  ///< unit, out of the body
  Vector3 along_in_couch = Vector3::UnitZ();   ///< unit, along the skin towards the head
  TangentTissue tissue;                        ///< under the whole of the skin below
  TangentTissue bone;                          ///< of this person
  Mesh skin_in_couch;                          ///< around the place
  safety::Zone zone = safety::Zone::denied;
  safety::ZoneField field;  ///< what the guard knows of this person
  double force_n = 0.0;     ///< 2 N less than the zone bears, or what a plan gives a heavy arm
  robot::RobotMount mount;
  double rail_m = 0.0;
  JointVector above_rad, aside_rad;  ///< tool 25 mm above the place; 60 mm above and 100 mm aside
  PerArm<JointVector> ready_rad;
  double apparent_mass_kg = 0.0;  ///< that a push along the normal feels
  sim::WorldOptions world;        ///< how unkind person, arm and wrist are there

  /// Tip of the tool over the place, in couch coordinates.
  [[nodiscard]] Vector3 above_in_couch(double height_m) const {
    return at_in_couch + height_m * normal_in_couch;
  }
};

/// Where the table of cells presses: bone, hard and soft tissue, and two low places where the arm
/// is folded and heavy. On three builds who sit and three who lie, for both arms, planned as a
/// session plans them.
[[nodiscard]] Result<std::vector<Site>> make_sites(std::uint64_t seed,
                                                   const sim::WorldOptions& world);

}  // namespace tuina::app
