// SPDX-License-Identifier: Apache-2.0
#include "tuina/robot/description.hpp"

#include <fmt/format.h>

namespace tuina::robot {
namespace {

std::string vector_text(const Vector3& v) {
  return fmt::format("{} {} {}", v.x(), v.y(), v.z());
}

std::string pose_text(const Transform& pose) {
  const Eigen::Quaterniond turn(pose.linear());
  return fmt::format(R"(pos="{}" quat="{} {} {} {}")", vector_text(pose.translation()), turn.w(),
                     turn.x(), turn.y(), turn.z());
}

/// From DH frame i (at the end of the link) to the joint frame i of the same link: [thesis] (2.2)
/// without the turn about z, which the joint makes.
Transform joint_from_end(const Link& link) {
  return Eigen::Translation3d(link.a_m, 0.0, link.d_m) *
         Transform(Eigen::AngleAxisd(link.alpha_rad, Vector3::UnitX()));
}

void add_arm(std::string& xml, std::string& motors, const ArmTable& table, const char* side,
             const Transform& base_from_shoulder) {
  Transform parent_from_here = base_from_shoulder;
  for (int i = 0; i < table.joints; ++i) {
    const Link& link = table.links[static_cast<std::size_t>(i)];
    const std::string name = fmt::format("{}_{}", side, link.name);
    parent_from_here = parent_from_here * Eigen::AngleAxisd(link.offset_rad, Vector3::UnitZ());
    xml += fmt::format(R"(<body name="{}" {}>)", name, pose_text(parent_from_here));
    xml += fmt::format(
        R"(<joint name="{}" type="hinge" axis="0 0 1" range="{} {}" armature="{}" frictionloss="{}" damping="{}"/>)",
        name, link.lowest_rad, link.highest_rad, link.rotor_inertia_kg_m2, link.coulomb_nm,
        link.viscous_nm_s_per_rad);
    xml +=
        fmt::format(R"(<inertial pos="{} {} {}" mass="{}" diaginertia="{} {} {}"/>)",
                    link.com_in_joint[0], link.com_in_joint[1], link.com_in_joint[2], link.mass_kg,
                    link.inertia_kg_m2[0], link.inertia_kg_m2[1], link.inertia_kg_m2[2]);
    motors += fmt::format(R"(<motor name="{}" joint="{}" ctrllimited="true" ctrlrange="{} {}"/>)",
                          name, name, -link.torque_limit_nm, link.torque_limit_nm);
    const Transform end = joint_from_end(link);
    const Vector3 to_end = end.translation();
    if (to_end.norm() > link.radius_m) {
      xml += fmt::format(R"(<geom type="capsule" size="{}" fromto="0 0 0 {}"/>)", link.radius_m,
                         vector_text(to_end * (1.0 - link.radius_m / to_end.norm())));
    }
    parent_from_here = end;
  }
  xml += fmt::format(R"(<site name="{}_tool" {}/>)", side, pose_text(parent_from_here));
  xml += fmt::format(R"(<geom type="sphere" size="{}" {}/>)", table.tool_radius_m,
                     pose_text(parent_from_here));
  for (int i = 0; i < table.joints; ++i) xml += "</body>";
  xml += '\n';
}

}  // namespace

std::string to_mjcf(const RobotMount& mount, const PerArm<ArmTable>& tables, double timestep_s,
                    double column_kg) {
  std::string motors;
  std::string xml = fmt::format(
      R"(<mujoco model="tuina">
<compiler angle="radian" inertiafromgeom="false" boundmass="0" boundinertia="0"/>
<option timestep="{}" gravity="0 0 {}" integrator="Euler"><flag contact="disable"/></option>
<default><joint limited="true"/><geom contype="0" conaffinity="0" mass="0"/></default>
<worldbody>
<body name="rail"><joint name="rail" type="slide" axis="{}" range="{} {}"/>
<inertial pos="0 0 0" mass="{}" diaginertia="1 1 1"/>
)",
      timestep_s, -gravity_m_per_s2, vector_text(mount.rail_axis_in_base), mount.lowest_rail_m,
      mount.highest_rail_m, column_kg);
  for (const Arm arm : both_arms) {
    add_arm(xml, motors, tables[arm], name_of(arm), mount.base_from_shoulder[arm]);
  }
  xml += "</body>\n</worldbody>\n<actuator>";
  xml += R"(<motor name="rail" joint="rail"/>)" + motors + "</actuator>\n</mujoco>\n";
  return xml;
}

}  // namespace tuina::robot
