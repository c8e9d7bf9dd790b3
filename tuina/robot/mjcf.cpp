// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "tuina/robot/description.hpp"

namespace tuina::robot {
namespace {

std::string text(const Vector3& v) {
  return fmt::format("{} {} {}", v.x(), v.y(), v.z());
}

std::string text(const std::array<double, 3>& v) {
  return fmt::format("{} {} {}", v[0], v[1], v[2]);
}

std::string pose_text(const Transform& pose) {
  const Eigen::Quaterniond turn(pose.linear());
  return fmt::format(R"(pos="{}" quat="{} {} {} {}")", text(pose.translation()), turn.w(), turn.x(),
                     turn.y(), turn.z());
}

std::string geom(const Solid& solid) {
  constexpr std::array shapes = {"capsule", "cylinder", "sphere", "box"};
  std::string size = fmt::format("{} {}", solid.radius_m, 0.5 * solid.length_m);
  if (solid.shape == Solid::Shape::sphere) size = fmt::format("{}", solid.radius_m);
  if (solid.shape == Solid::Shape::box) size = text(Vector3(0.5 * solid.edges_m));
  return fmt::format(R"(<geom type="{}" size="{}" {}/>)",
                     shapes[static_cast<std::size_t>(solid.shape)], size,
                     pose_text(solid.part_from_solid));
}

std::string joint(const Part& part) {
  if (part.motion == Part::Motion::fixed) return "";
  const char* type = part.motion == Part::Motion::slide ? "slide" : "hinge";
  // MuJoCo knows no empty range: a base that has no way to go is held by its drive alone.
  const std::string limits = part.limited && part.lowest < part.highest
                                 ? fmt::format(R"(range="{} {}")", part.lowest, part.highest)
                                 : std::string(R"(limited="false")");
  return fmt::format(
      R"(<joint name="{}" type="{}" axis="{}" {} armature="{}" frictionloss="{}" damping="{}"/>)",
      part.name, type, text(part.axis), limits, part.rotor_inertia_kg_m2, part.coulomb,
      part.viscous);
}

std::string motor(const Part& part) {
  if (part.motion == Part::Motion::fixed) return "";
  const std::string limits = part.effort_limit > 0.0
                                 ? fmt::format(R"( ctrllimited="true" ctrlrange="{} {}")",
                                               -part.effort_limit, part.effort_limit)
                                 : "";
  return fmt::format(R"(<motor name="{0}" joint="{0}"{1}/>)", part.name, limits);
}

std::string body(const Description& robot, std::size_t index) {
  const Part& part = robot.parts[index];
  std::string xml =
      fmt::format(R"(<body name="{}" {}>)", part.name, pose_text(part.parent_from_part));
  xml += joint(part);
  const auto& products = part.inertia_products_kg_m2;
  const std::string inertia =
      products == std::array<double, 3>{}
          ? fmt::format(R"(diaginertia="{}")", text(part.inertia_kg_m2))
          : fmt::format(R"(fullinertia="{} {}")", text(part.inertia_kg_m2), text(products));
  xml +=
      fmt::format("<inertial pos=\"{}\" mass=\"{}\" {}/>\n", text(part.com), part.mass_kg, inertia);
  for (const Solid& solid : part.solids) xml += geom(solid);
  for (const Marker& marker : robot.markers) {
    if (marker.part != static_cast<int>(index)) continue;
    xml += fmt::format(R"(<site name="{}" {}/>)", marker.name, pose_text(marker.part_from_marker));
  }
  for (std::size_t child = index + 1; child < robot.parts.size(); ++child) {
    if (robot.parts[child].parent == static_cast<int>(index)) xml += body(robot, child);
  }
  return xml + "</body>\n";
}

}  // namespace

std::string to_mjcf(const Description& robot, double timestep_s) {
  std::string xml = fmt::format(
      R"(<mujoco model="{}">
<compiler angle="radian" inertiafromgeom="false" boundmass="0" boundinertia="0"/>
<option timestep="{}" gravity="0 0 {}" integrator="Euler"><flag contact="disable"/></option>
<default><joint limited="true"/><geom contype="0" conaffinity="0" mass="0"/></default>
<worldbody>
)",
      robot.name, timestep_s, -gravity_m_per_s2);
  std::string motors;
  for (std::size_t i = 0; i < robot.parts.size(); ++i) {
    if (robot.parts[i].parent < 0) xml += body(robot, i);
    motors += motor(robot.parts[i]);
  }
  return xml + "</worldbody>\n<actuator>" + motors + "</actuator>\n</mujoco>\n";
}

}  // namespace tuina::robot
