// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tuina/robot/arm_table.hpp"
#include "tuina/robot/mount.hpp"

namespace tuina::robot {

/// What a part looks like, its middle at the origin, long along z.
struct Solid {
  /// Form of the solid.
  enum class Shape : std::uint8_t { capsule, cylinder, sphere, box } shape = Shape::capsule;
  Transform part_from_solid = Transform::Identity();
  double radius_m = 0.0;
  double length_m = 0.0;              ///< straight stretch of a capsule or cylinder
  Vector3 edges_m = Vector3::Zero();  ///< lengths of a box
};

/// One body of a robot and the joint that carries it. Mass properties are in the part's own frame,
/// which is the joint's.
struct Part {
  /// How a part moves on the one that carries it.
  enum class Motion : std::uint8_t { fixed, hinge, slide };

  std::string name;
  int parent = -1;  ///< its place in the list, before this one; -1: the `base` frame
  Transform parent_from_part = Transform::Identity();  ///< joint at zero
  Motion motion = Motion::hinge;
  Vector3 axis = Vector3::UnitZ();
  bool limited = true;
  double lowest = 0.0, highest = 0.0;  ///< rad or m
  double effort_limit = 0.0;           ///< Nm or N; 0: no drive limit is known
  double speed_limit = 0.0;
  double rotor_inertia_kg_m2 = 0.0;
  double coulomb = 0.0, viscous = 0.0;  ///< Nm, Nm s/rad
  double mass_kg = 0.0;
  std::array<double, 3> com = {};
  std::array<double, 3> inertia_kg_m2 = {};           ///< xx, yy, zz about the centre of mass
  std::array<double, 3> inertia_products_kg_m2 = {};  ///< xy, xz, yz
  std::vector<Solid> solids = {};
};

/// A named place on a part.
struct Marker {
  std::string name;
  int part = 0;
  Transform part_from_marker = Transform::Identity();
};

/// A whole robot as a list of parts, parents first, in the `base` frame. MJCF and URDF are written
/// from it, so they cannot drift apart.
struct Description {
  std::string name;
  std::vector<Part> parts;
  std::vector<Marker> markers;
};

/// Adds an arm to a description; `parent_from_shoulder` is DH frame 0. Parts `left_elbow`, ..., and
/// a marker `left_tool` at the centre of the sphere, turned as the tool frame.
void add_arm(Description& robot, const ArmTable& table, const std::string& side, int parent,
             const Transform& parent_from_shoulder);

/// Two arms on a linear base that moves along the mount's axis. `column_kg` is what rides on it
/// besides the arms.
[[nodiscard]] Description describe(const RobotMount& mount, const PerArm<ArmTable>& tables,
                                   double column_kg = 60.0);

/// Where each part is when the joints are at `q`, one value a part (that of a fixed one is not
/// looked at).
[[nodiscard]] std::vector<Transform> base_from_parts(const Description& robot,
                                                     const std::vector<double>& q);

/// For MuJoCo: joints named as their parts, motors of the same names in newton metres (slides:
/// newtons), markers as sites. Collisions are off: what the arms touch is the caller's.
[[nodiscard]] std::string to_mjcf(const Description& robot, double timestep_s);
/// The same for two arms on a mount, whose column has a mass of `column_kg`.
[[nodiscard]] inline std::string to_mjcf(const RobotMount& mount, const PerArm<ArmTable>& tables,
                                         double timestep_s, double column_kg = 60.0) {
  return to_mjcf(describe(mount, tables, column_kg), timestep_s);
}

/// For ROS: one root link `base`, capsules as a cylinder with two spheres, markers as links of
/// their own behind a fixed joint. URDF has no place for the inertia of rotors.
[[nodiscard]] std::string to_urdf(const Description& robot);

}  // namespace tuina::robot
