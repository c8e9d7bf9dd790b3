// SPDX-License-Identifier: Apache-2.0
#include "tuina/robot/standing.hpp"

#include <utility>

#include "tuina/robot/successor.hpp"

namespace tuina::robot {
namespace {

constexpr double seat_m = 620_mm, bed_m = 420_mm;  // over the floor

/// Everything of the successor at zero but its waist, bent forward.
std::vector<double> bent(const Description& robot, double pitch_rad) {
  std::vector<double> q(robot.parts.size(), 0.0);
  for (std::size_t i = 0; i < q.size(); ++i) {
    if (robot.parts[i].name == "waist_pitch") q[i] = pitch_rad;
  }
  return q;
}

/// How the successor's floor frame lies in the session's base, whose origin is between the
/// shoulders: turned round where it faces the person's feet.
Transform base_from_floor(const RobotMount& on_floor, bool turned) {
  const Vector3 middle = 0.5 * (on_floor.base_from_shoulder[Arm::left].translation() +
                                on_floor.base_from_shoulder[Arm::right].translation());
  Transform pose = Transform::Identity();
  if (turned) pose.linear() = Vector3(-1.0, -1.0, 1.0).asDiagonal();
  return pose * Eigen::Translation3d(-middle);
}

Standing stand_successor(Position position, bool head_at_plus_y) {
  const bool sits = position == Position::sitting;
  const bool turned = !sits && !head_at_plus_y;  // it faces the couch's plus y
  Standing standing{.kind = Kind::successor,
                    .arm = successor_arm(),
                    .mount = mount_for(position),
                    .waist_pitch_rad = sits ? 40_deg : 57_deg};
  const Description robot = successor_robot();
  const std::vector<double> q = bent(robot, standing.waist_pitch_rad);
  const RobotMount on_floor = mount_in(robot, q);
  const Transform from_floor = base_from_floor(on_floor, turned);
  const double height_m = -from_floor.translation().z() - (sits ? seat_m : bed_m);

  RobotMount& mount = standing.mount;
  // Prone, the waist stays 20 mm clear of the end of the bed, which the head is near to.
  constexpr double end_of_bed_m = 850_mm, half_waist_m = 110_mm, gap_m = 20_mm;
  const double leaning_m = on_floor.base_from_shoulder[Arm::left].translation().x();
  const double head_y = end_of_bed_m + half_waist_m + gap_m - leaning_m;
  const Vector3 midway_in_couch(0.0, sits ? 450_mm : head_at_plus_y ? head_y : -head_y, height_m);
  mount.base_from_couch.translation() = -(mount.base_from_couch.linear() * midway_in_couch);
  for (const Arm arm : both_arms) {
    const Arm its = turned ? (arm == Arm::left ? Arm::right : Arm::left) : arm;
    mount.base_from_shoulder[arm] = from_floor * on_floor.base_from_shoulder[its];
  }
  mount.rail_axis_in_base = from_floor.linear() * Vector3::UnitX();
  mount.min_rail_m = -300_mm;
  mount.max_rail_m = sits ? 300_mm : 0.0;
  if (!sits)
    mount.ready_from_shoulder = 250_mm * mount.rail_axis_in_base - 150_mm * Vector3::UnitZ();

  mount.obstacles = {couch_of(position, mount.base_from_couch)};
  if (!sits) {
    // It lies so that the head is near its end.
    const Vector3 aside(0.0, head_at_plus_y ? -150_mm : 150_mm, 0.0);
    mount.obstacles.front().base_from_box.translation() += mount.base_from_couch.linear() * aside;
  }
  const std::vector<Transform> poses = base_from_parts(robot, q);
  for (std::size_t i = 0; i < robot.parts.size(); ++i) {
    for (const Solid& solid : robot.parts[i].solids) {
      if (solid.shape != Solid::Shape::box) continue;
      mount.obstacles.push_back({.kind = Surrounding::body,
                                 .base_from_box = from_floor * poses[i] * solid.part_from_solid,
                                 .edges_m = solid.edges_m,
                                 .rides = true});
    }
  }
  return standing;
}

/// Turned round, the robot's own right arm is the one on the side of the couch's positive x, which
/// the session calls the left.
void swap_sides(Description& robot) {
  const auto swap = [](std::string& name) {
    for (const auto& [side, other] : {std::pair("left_", "right_"), std::pair("right_", "left_")}) {
      if (!name.starts_with(side)) continue;
      name = other + name.substr(std::string_view(side).size());
      return;
    }
  };
  for (Part& part : robot.parts) swap(part.name);
  for (Marker& marker : robot.markers) swap(marker.name);
}

Solid box_of(const Obstacle& obstacle) {
  return {.shape = Solid::Shape::box,
          .part_from_solid = obstacle.base_from_box,
          .edges_m = obstacle.edges_m};
}

}  // namespace

std::optional<Kind> parse_kind(std::string_view name) {
  for (const Kind kind : {Kind::thesis, Kind::successor}) {
    if (name == name_of(kind)) return kind;
  }
  return std::nullopt;
}

Standing stand(Kind kind, Position position, bool head_at_plus_y) {
  if (kind == Kind::successor) return stand_successor(position, head_at_plus_y);
  return {.arm = thesis_arm(), .mount = mount_for(position)};
}

WholeRobot whole_of(const Standing& standing, const PerArm<ArmTable>& arms) {
  WholeRobot whole;
  const bool successor = standing.kind == Kind::successor;
  if (successor) {
    const bool turned = standing.mount.rail_axis_in_base.x() < 0.0;
    whole.description = successor_robot(
        turned ? PerArm<ArmTable>{.of = {arms[Arm::right], arms[Arm::left]}} : arms);
    const std::vector<double> q = bent(whole.description, standing.waist_pitch_rad);
    const Transform from_floor = base_from_floor(mount_in(whole.description, q), turned);
    if (turned) swap_sides(whole.description);
    whole.rail = "base_x";
    Part& root = whole.description.parts.front();
    root.parent_from_part = from_floor * root.parent_from_part;
    whole.q = q;
  } else {
    whole.description = describe(standing.mount, arms);
    whole.rail = "rail";
    whole.q.assign(whole.description.parts.size(), 0.0);
  }
  // Chair, bed and gantry stand in the world; they are seen, and kept away from by distance: a
  // collision is not simulated, because the session stops 25 mm before one.
  Part around{.name = "surroundings", .motion = Part::Motion::fixed};
  for (const Obstacle& obstacle : standing.mount.obstacles) {
    if (obstacle.kind == Surrounding::body && successor) continue;  // has it in its description
    (obstacle.rides ? whole.description.parts.front() : around).solids.push_back(box_of(obstacle));
  }
  whole.description.parts.push_back(std::move(around));
  whole.q.push_back(0.0);
  return whole;
}

}  // namespace tuina::robot
