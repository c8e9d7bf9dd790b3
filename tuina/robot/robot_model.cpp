// SPDX-License-Identifier: Apache-2.0
#include "tuina/robot/robot_model.hpp"

#include <filesystem>
#include <utility>

#include "tuina/core/io/file.hpp"
#include "tuina/core/io/near_miss.hpp"
#include "tuina/robot/table/robot_table.hpp"
#include "tuina/robot/wheeled_body.hpp"

namespace tuina::robot {
namespace {

/// Upright directions as they lie in `base`: prone, the robot looks down.
Matrix3 base_from_upright(BodyPosture position) {
  if (position == BodyPosture::sitting) return Matrix3::Identity();
  return Eigen::AngleAxisd(90_deg, Vector3::UnitY()).toRotationMatrix();
}

/// base x is couch minus y, base y is couch x: the left arm faces the person's left in both
/// positions.
Transform base_from_couch_at(const Vector3& midway_in_couch) {
  Transform base_from_couch = Transform::Identity();
  base_from_couch.linear() << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  base_from_couch.translation() = -base_from_couch.linear() * midway_in_couch;
  return base_from_couch;
}

RobotMount on_linear_base(const Mounting& mounting, BodyPosture position) {
  RobotMount mount{.base_from_couch = base_from_couch_at(mounting.midway_in_couch),
                   .min_rail_m = mounting.min_rail_m,
                   .max_rail_m = mounting.max_rail_m,
                   .ready_elbow_outward_m = mounting.ready_elbow_outward_m,
                   .ready_near_rad = mounting.ready_near_rad};
  const Matrix3 facing = base_from_upright(position);
  mount.ready_from_shoulder = facing * mounting.ready_from_shoulder;
  mount.ahead_in_base = facing.col(0);
  for (const Arm arm : both_arms) {
    Transform& shoulder = mount.base_from_shoulder[arm];
    shoulder.linear() = facing * mounting.upright_from_shoulder[arm];
    shoulder.translation() =
        Vector3(0.0, (arm == Arm::left ? 0.5 : -0.5) * mounting.shoulders_apart_m, 0.0);
  }
  mount.obstacles.push_back(couch_of(position, mount.base_from_couch));
  for (const BodyBox& box : mounting.body) {
    Obstacle part{.kind = Surrounding::body, .edges_m = box.edges_m, .rides = box.rides};
    Vector3 middle = box.middle_in_base;
    if (box.spans_rail) {
      part.edges_m.x() = mount.max_rail_m - mount.min_rail_m + box.edges_m.x();
      middle.x() = 0.5 * (mount.max_rail_m + mount.min_rail_m) + middle.x();
    }
    part.base_from_box.translation() = middle;
    mount.obstacles.push_back(part);
  }
  return mount;
}

/// Everything of the wheeled body at zero but its waist, bent forward.
std::vector<double> bent(const Description& robot, double pitch_rad) {
  std::vector<double> q(robot.parts.size(), 0.0);
  for (std::size_t i = 0; i < q.size(); ++i) {
    if (robot.parts[i].name == "waist_pitch") q[i] = pitch_rad;
  }
  return q;
}

/// How the wheeled body's floor frame lies in the session's base, whose origin is between the
/// shoulders: turned round where it faces the person's feet.
Transform base_from_floor(const RobotMount& on_floor, bool turned) {
  const Vector3 middle = 0.5 * (on_floor.base_from_shoulder[Arm::left].translation() +
                                on_floor.base_from_shoulder[Arm::right].translation());
  Transform pose = Transform::Identity();
  if (turned) pose.linear() = Vector3(-1.0, -1.0, 1.0).asDiagonal();
  return pose * Eigen::Translation3d(-middle);
}

RobotMount on_wheels(const RobotModel& model, BodyPosture position, bool head_at_plus_y) {
  const Mounting& mounting = model.mounting(position);
  const bool sits = position == BodyPosture::sitting;
  const bool turned = !sits && !head_at_plus_y;  // it faces the couch's plus y
  const Description robot =
      wheeled_robot({.of = {model.arm, model.arm}}, mounting.upright_from_shoulder);
  const std::vector<double> q = bent(robot, mounting.waist_pitch_rad);
  const RobotMount on_floor = mount_in(robot, q);
  const Transform from_floor = base_from_floor(on_floor, turned);
  const double height_m = -from_floor.translation().z() - mounting.couch_height_m;

  // Prone, the waist stays 20 mm clear of the end of the bed, which the head is near to.
  constexpr double end_of_bed_m = 850_mm, half_waist_m = 110_mm, gap_m = 20_mm;
  const double leaning_m = on_floor.base_from_shoulder[Arm::left].translation().x();
  const double head_y = end_of_bed_m + half_waist_m + gap_m - leaning_m;
  RobotMount mount{.base_from_couch = base_from_couch_at({0.0,
                                                          sits ? mounting.behind_person_m
                                                          : head_at_plus_y ? head_y
                                                                           : -head_y,
                                                          height_m}),
                   .min_rail_m = mounting.min_rail_m,
                   .max_rail_m = mounting.max_rail_m,
                   .ready_elbow_outward_m = mounting.ready_elbow_outward_m,
                   .ready_near_rad = mounting.ready_near_rad};
  for (const Arm arm : both_arms) {
    const Arm its = turned ? other(arm) : arm;
    mount.base_from_shoulder[arm] = from_floor * on_floor.base_from_shoulder[its];
  }
  mount.rail_axis_in_base = from_floor.linear() * Vector3::UnitX();
  mount.ready_from_shoulder = from_floor.linear() * mounting.ready_from_shoulder;
  mount.ahead_in_base = base_from_upright(position).col(0);

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
  return mount;
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

/// The shipped robot that tests and comparisons know by name.
const RobotModel& thesis() {
  static const RobotModel model = load_robot("thesis").value();
  return model;
}

}  // namespace

ArmTable thesis_arm() {
  return thesis().arm;
}

RobotMount mount_for(BodyPosture position) {
  return place_robot(thesis(), position).mount;
}

Obstacle couch_of(BodyPosture position, const Transform& base_from_couch) {
  constexpr double thick_m = 80_mm;
  const bool sits = position == BodyPosture::sitting;
  Obstacle couch{.edges_m =
                     sits ? Vector3(500_mm, 500_mm, thick_m) : Vector3(760_mm, 2000_mm, thick_m)};
  couch.base_from_box =
      base_from_couch * Eigen::Translation3d(0.0, sits ? -20_mm : 0_mm, -0.5 * thick_m);
  return couch;
}

Result<RobotModel> load_robot(std::string_view name_or_file) {
  std::vector<std::string> names;
  for (const ShippedRobot& shipped : shipped_robots()) {
    if (shipped.name == name_or_file) {
      return parse_robot(shipped.toml, fmt::format("robot {}", shipped.name));
    }
    names.emplace_back(shipped.name);
  }
  const bool looks_like_file = name_or_file.find_first_of("./") != std::string_view::npos;
  if (!looks_like_file && !std::filesystem::exists(name_or_file)) {
    return fail(Fault::usage, "no robot is called `{}`; {}", name_or_file,
                suggestion(name_or_file, names));
  }
  constexpr std::size_t max_bytes = 1 << 20;
  const auto text = read_file(std::filesystem::path(name_or_file), max_bytes);
  if (!text) return tl::unexpected(text.error());
  return parse_robot(*text, name_or_file);
}

RobotPlacement place_robot(const RobotModel& model, BodyPosture position, bool head_at_plus_y) {
  const Mounting& mounting = model.mounting(position);
  return {.carrier = model.carrier,
          .arm = model.arm,
          .mount = model.carrier == Carrier::wheeled_body
                       ? on_wheels(model, position, head_at_plus_y)
                       : on_linear_base(mounting, position),
          .waist_pitch_rad = mounting.waist_pitch_rad,
          .torso_from_shoulder = mounting.upright_from_shoulder};
}

WholeRobot whole_of(const RobotPlacement& placement, const PerArm<ArmTable>& arms) {
  WholeRobot whole;
  const bool on_wheels = placement.carrier == Carrier::wheeled_body;
  if (on_wheels) {
    const bool turned = placement.mount.rail_axis_in_base.x() < 0.0;
    whole.description =
        wheeled_robot(turned ? PerArm<ArmTable>{.of = {arms[Arm::right], arms[Arm::left]}} : arms,
                      placement.torso_from_shoulder);
    const std::vector<double> q = bent(whole.description, placement.waist_pitch_rad);
    const Transform from_floor = base_from_floor(mount_in(whole.description, q), turned);
    if (turned) swap_sides(whole.description);
    whole.rail = "base_x";
    Part& root = whole.description.parts.front();
    root.parent_from_part = from_floor * root.parent_from_part;
    whole.q = q;
  } else {
    whole.description = describe(placement.mount, arms);
    whole.rail = "rail";
    whole.q.assign(whole.description.parts.size(), 0.0);
  }
  // Chair, bed and gantry stand in the world; they are seen, and kept away from by distance: a
  // collision is not simulated, because the session stops 25 mm before one.
  Part around{.name = "surroundings", .motion = Part::Motion::fixed};
  for (const Obstacle& obstacle : placement.mount.obstacles) {
    if (obstacle.kind == Surrounding::body && on_wheels) continue;  // has it in its description
    (obstacle.rides ? whole.description.parts.front() : around).solids.push_back(box_of(obstacle));
  }
  whole.description.parts.push_back(std::move(around));
  whole.q.push_back(0.0);
  return whole;
}

}  // namespace tuina::robot
