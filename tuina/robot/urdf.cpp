// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>

#include "tuina/robot/description.hpp"

namespace tuina::robot {
namespace {

std::string words(const Vector3& v) {
  return fmt::format("{} {} {}", v.x(), v.y(), v.z());
}

/// Turns about the fixed axes x, y, z, as URDF wants them.
Vector3 roll_pitch_yaw(const Matrix3& r) {
  const double across = std::hypot(r(0, 0), r(1, 0));
  if (across < 1e-9) {  // pitch straight up or down: yaw is as good as roll
    return {std::atan2(-r(1, 2), r(1, 1)), std::atan2(-r(2, 0), across), 0.0};
  }
  return {std::atan2(r(2, 1), r(2, 2)), std::atan2(-r(2, 0), across), std::atan2(r(1, 0), r(0, 0))};
}

std::string origin(const Transform& pose) {
  return fmt::format(R"(<origin xyz="{}" rpy="{}"/>)", words(pose.translation()),
                     words(roll_pitch_yaw(pose.linear())));
}

std::string visual(const Transform& pose, const std::string& geometry) {
  return fmt::format("  <visual>{}<geometry>{}</geometry><material name=\"shell\"/></visual>\n",
                     origin(pose), geometry);
}

std::string visuals(const Solid& solid) {
  const auto sphere = [&](double along_m) {
    const Transform at = solid.part_from_solid * Eigen::Translation3d(0.0, 0.0, along_m);
    return visual(at, fmt::format(R"(<sphere radius="{}"/>)", solid.radius_m));
  };
  const auto cylinder = [&] {
    return visual(solid.part_from_solid, fmt::format(R"(<cylinder radius="{}" length="{}"/>)",
                                                     solid.radius_m, solid.length_m));
  };
  switch (solid.shape) {
    case Solid::Shape::capsule:
      return cylinder() + sphere(0.5 * solid.length_m) + sphere(-0.5 * solid.length_m);
    case Solid::Shape::cylinder:
      return cylinder();
    case Solid::Shape::sphere:
      return sphere(0.0);
    case Solid::Shape::box:
      return visual(solid.part_from_solid,
                    fmt::format(R"(<box size="{}"/>)", words(solid.edges_m)));
  }
  return "";
}

std::string link(const Part& part) {
  std::string xml = fmt::format("<link name=\"{}\">\n", part.name);
  if (part.mass_kg > 0.0) {
    xml += fmt::format(
        "  <inertial><origin xyz=\"{} {} {}\" rpy=\"0 0 0\"/><mass value=\"{}\"/>"
        "<inertia ixx=\"{}\" ixy=\"{}\" ixz=\"{}\" iyy=\"{}\" iyz=\"{}\" izz=\"{}\"/></inertial>\n",
        part.com[0], part.com[1], part.com[2], part.mass_kg, part.inertia_kg_m2[0],
        part.inertia_products_kg_m2[0], part.inertia_products_kg_m2[1], part.inertia_kg_m2[1],
        part.inertia_products_kg_m2[2], part.inertia_kg_m2[2]);
  }
  for (const Solid& solid : part.solids) xml += visuals(solid);
  return xml + "</link>\n";
}

std::string joint(const Description& robot, const Part& part) {
  const char* type = part.motion == Part::Motion::fixed   ? "fixed"
                     : part.motion == Part::Motion::slide ? "prismatic"
                     : part.limited                       ? "revolute"
                                                          : "continuous";
  const std::string parent =
      part.parent < 0 ? "base" : robot.parts[static_cast<std::size_t>(part.parent)].name;
  std::string xml = fmt::format(
      "<joint name=\"{0}_joint\" type=\"{1}\">\n  {2}<parent link=\"{3}\"/><child link=\"{0}\"/>",
      part.name, type, origin(part.parent_from_part), parent);
  if (part.motion != Part::Motion::fixed) {
    xml += fmt::format("<axis xyz=\"{}\"/>\n  ", words(part.axis));
    const std::string range =
        part.limited ? fmt::format(R"(lower="{}" upper="{}" )", part.lowest, part.highest) : "";
    xml += fmt::format("<limit {}effort=\"{}\" velocity=\"{}\"/>", range, part.effort_limit,
                       part.speed_limit);
    xml += fmt::format("<dynamics damping=\"{}\" friction=\"{}\"/>", part.viscous, part.coulomb);
  }
  return xml + "\n</joint>\n";
}

}  // namespace

std::string to_urdf(const Description& robot) {
  std::string xml = fmt::format(
      "<?xml version=\"1.0\"?>\n<robot name=\"{}\">\n<material name=\"shell\"><color rgba=\"0.80 "
      "0.80 0.78 1\"/></material>\n<link name=\"base\"/>\n",
      robot.name);
  for (const Part& part : robot.parts) xml += link(part) + joint(robot, part);
  for (const Marker& marker : robot.markers) {
    xml += fmt::format(
        "<link name=\"{0}\"/>\n<joint name=\"{0}_joint\" type=\"fixed\">\n  {1}<parent "
        "link=\"{2}\"/><child link=\"{0}\"/>\n</joint>\n",
        marker.name, origin(marker.part_from_marker),
        robot.parts[static_cast<std::size_t>(marker.part)].name);
  }
  return xml + "</robot>\n";
}

}  // namespace tuina::robot
