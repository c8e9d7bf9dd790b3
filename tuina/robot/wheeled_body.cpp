// SPDX-License-Identifier: Apache-2.0
#include "tuina/robot/wheeled_body.hpp"

namespace tuina::robot {
namespace {

constexpr double wheel_radius_m = 100_mm, half_track_m = 250_mm, half_wheelbase_m = 220_mm;
constexpr double deck_m = 300_mm;   // height of the base's upper face above the floor
constexpr double torso_m = 500_mm;  // length from the waist to the line between the shoulders
constexpr double half_shoulders_m = 165_mm;

using Motion = Part::Motion;
using Shape = Solid::Shape;

Transform at(double x, double y, double z) {
  return Transform(Eigen::Translation3d(x, y, z));
}

/// Mass properties of a box.
std::array<double, 3> box_inertia(double mass_kg, const Vector3& edges_m) {
  const Vector3 s = edges_m.cwiseProduct(edges_m) * mass_kg / 12.0;
  return {s.y() + s.z(), s.x() + s.z(), s.x() + s.y()};
}

Part boxed(const char* name, int parent, const Transform& parent_from_part, const Vector3& axis,
           double range_rad, double mass_kg, const Vector3& edges_m, double lifted_m) {
  return {
      .name = name,
      .parent = parent,
      .parent_from_part = parent_from_part,
      .axis = axis,
      .lowest = -range_rad,
      .highest = range_rad,
      .mass_kg = mass_kg,
      .com = {0.0, 0.0, lifted_m},
      .inertia_kg_m2 = box_inertia(mass_kg, edges_m),
      .solids = {
          {.shape = Shape::box, .part_from_solid = at(0.0, 0.0, lifted_m), .edges_m = edges_m}}};
}

void with_drive(Part& part, double effort, double speed, double rotor_kg_m2, double coulomb) {
  part.effort_limit = effort;
  part.speed_limit = speed;
  part.rotor_inertia_kg_m2 = rotor_kg_m2;
  part.coulomb = coulomb;
  part.viscous = 0.1 * coulomb;
}

int put(Description& robot, Part part) {
  robot.parts.push_back(std::move(part));
  return static_cast<int>(robot.parts.size()) - 1;
}

// The place of the base on the floor has no motors of its own: the wheels move it.
int add_base(Description& robot) {
  Part sliding{.name = "base_x",
               .motion = Motion::slide,
               .axis = Vector3::UnitX(),
               .lowest = -5.0,
               .highest = 5.0,
               .speed_limit = 0.5,
               .mass_kg = 0.1,
               .inertia_kg_m2 = {1e-3, 1e-3, 1e-3}};
  const int x = put(robot, sliding);
  sliding.name = "base_y";
  sliding.parent = x;
  sliding.axis = Vector3::UnitY();
  const int y = put(robot, sliding);
  const Vector3 edges_m(560_mm, 420_mm, 200_mm);
  Part body = boxed("base_yaw", y, Transform::Identity(), Vector3::UnitZ(), 0.0, 60.0, edges_m,
                    deck_m - 0.5 * edges_m.z());
  body.limited = false;
  body.speed_limit = 1.0;
  const int base = put(robot, std::move(body));
  constexpr std::array names = {"wheel_front_left", "wheel_front_right", "wheel_rear_left",
                                "wheel_rear_right"};
  constexpr double width_m = 60_mm, mass_kg = 2.5, r = wheel_radius_m;
  constexpr double across = mass_kg * (3.0 * r * r + width_m * width_m) / 12.0;
  for (std::size_t i = 0; i < names.size(); ++i) {
    Part wheel{.name = names[i],
               .parent = base,
               .parent_from_part = at(i < 2 ? half_wheelbase_m : -half_wheelbase_m,
                                      i % 2 == 0 ? half_track_m : -half_track_m, r),
               .axis = Vector3::UnitY(),
               .limited = false,
               .mass_kg = mass_kg,
               .inertia_kg_m2 = {across, mass_kg * r * r / 2.0, across}};
    wheel.solids.push_back(
        {.shape = Shape::cylinder,
         .part_from_solid = Transform(Eigen::AngleAxisd(90_deg, Vector3::UnitX())),
         .radius_m = r,
         .length_m = width_m});
    with_drive(wheel, 20.0, 10.0, 0.02, 0.5);
    put(robot, std::move(wheel));
  }
  return base;
}

int add_waist(Description& robot, int base) {
  Part yaw = boxed("waist_yaw", base, at(0.0, 0.0, deck_m), Vector3::UnitZ(), 120_deg, 8.0,
                   Vector3(220_mm, 220_mm, 400_mm), 200_mm);
  with_drive(yaw, 200.0, 1.5, 0.4, 4.0);
  const int turned = put(robot, std::move(yaw));
  Part pitch = boxed("waist_pitch", turned, at(0.0, 0.0, 450_mm), Vector3::UnitY(), 80_deg, 6.0,
                     Vector3(140_mm, 180_mm, 140_mm), 0.0);
  with_drive(pitch, 300.0, 1.5, 0.6, 4.0);
  const int bent = put(robot, std::move(pitch));
  Part roll = boxed("waist_roll", bent, Transform::Identity(), Vector3::UnitX(), 30_deg, 14.0,
                    Vector3(160_mm, 240_mm, 380_mm), 280_mm);
  with_drive(roll, 300.0, 1.5, 0.6, 4.0);
  return put(robot, std::move(roll));
}

void add_head(Description& robot, int torso) {
  Part pan = boxed("head_pan", torso, at(0.0, 0.0, torso_m + 80_mm), Vector3::UnitZ(), 90_deg, 0.6,
                   Vector3(60_mm, 60_mm, 60_mm), 0.0);
  with_drive(pan, 5.0, 3.0, 0.01, 0.1);
  const int panned = put(robot, std::move(pan));
  Part tilt = boxed("head_tilt", panned, at(0.0, 0.0, 60_mm), Vector3::UnitY(), 45_deg, 1.2,
                    Vector3(120_mm, 160_mm, 120_mm), 60_mm);
  with_drive(tilt, 5.0, 3.0, 0.01, 0.1);
  put(robot, std::move(tilt));
}

}  // namespace

Description wheeled_robot(const PerArm<ArmTable>& arms,
                          const PerArm<Matrix3>& torso_from_shoulder) {
  Description robot{.name = "tuina_successor", .parts = {}, .markers = {}};
  const int torso = add_waist(robot, add_base(robot));
  add_head(robot, torso);
  for (const Arm arm : both_arms) {
    Transform shoulder = at(0.0, arm == Arm::left ? half_shoulders_m : -half_shoulders_m, torso_m);
    shoulder.linear() = torso_from_shoulder[arm];
    robot.markers.push_back({std::string(name_of(arm)) + "_shoulder", torso, shoulder});
    add_arm(robot, arms[arm], name_of(arm), torso, shoulder);
  }
  return robot;
}

RobotMount mount_in(const Description& robot, const std::vector<double>& q) {
  const std::vector<Transform> poses = base_from_parts(robot, q);
  RobotMount mount;
  for (const Marker& marker : robot.markers) {
    for (const Arm arm : both_arms) {
      if (marker.name != std::string(name_of(arm)) + "_shoulder") continue;
      mount.base_from_shoulder[arm] =
          poses[static_cast<std::size_t>(marker.part)] * marker.part_from_marker;
    }
  }
  return mount;
}

}  // namespace tuina::robot
