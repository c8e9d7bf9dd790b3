// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "tuina/core/io/text_lines.hpp"
#include "tuina/robot/table/robot_table.hpp"

namespace tuina::robot {
namespace {

/// The shortest number of degrees or millimetres that is read as exactly this value, if one is.
template <typename Convert>
std::string shown(double value, double converted, Convert read) {
  const double round = std::round(converted * 1e9) / 1e9;
  if (read(round) == value) return fmt::format("{}", round + 0.0);  // never "-0"
  for (const double toward : {-1e300, 1e300}) {
    double near = converted;
    for (int i = 0; i < 4; ++i, near = std::nextafter(near, toward)) {
      if (read(near) == value) return fmt::format("{}", near);
    }
  }
  return fmt::format("{}", converted);
}
std::string deg(double rad) {
  return shown(rad, to_deg(rad), from_deg);
}
std::string mm(double m) {
  return shown(m, to_mm(m), from_mm);
}
std::string mm(const Vector3& m) {
  return fmt::format("[{}, {}, {}]", mm(m.x()), mm(m.y()), mm(m.z()));
}
template <typename Three>
std::string three(const Three& v) {
  return fmt::format("[{}, {}, {}]", v[0] + 0.0, v[1] + 0.0, v[2] + 0.0);
}
/// A column of a rotation, whose numbers rounding may have left a little beyond one.
std::string axis(const Vector3& column) {
  return three(Vector3(column.cwiseMax(-1.0).cwiseMin(1.0)));
}

std::string text_of(const Link& link) {
  std::string text = fmt::format(
      "\n[[link]]\nname = {}\noffset_deg = {}\nd_mm = {}\na_mm = {}\nalpha_deg = {}\n"
      "limits_deg = [{}, {}]\ntorque_limit_nm = {}\nspeed_limit_rad_per_s = {}\nmass_kg = {}\n"
      "com_m = {}\ninertia_kg_m2 = {}\n",
      toml_string(link.name), deg(link.offset_rad), mm(link.d_m), mm(link.a_m), deg(link.alpha_rad),
      deg(link.min_rad), deg(link.max_rad), link.torque_limit_nm, link.speed_limit_rad_per_s,
      link.mass_kg, three(link.com_in_joint), three(link.inertia_kg_m2));
  if (link.inertia_products_kg_m2 != std::array<double, 3>{})
    text += fmt::format("inertia_products_kg_m2 = {}\n", three(link.inertia_products_kg_m2));
  text += fmt::format("rotor_inertia_kg_m2 = {}\n", link.rotor_inertia_kg_m2 + 0.0);
  if (link.gear_nm_per_rad > 0.0)
    text += fmt::format("gear_nm_per_rad = {}\n", link.gear_nm_per_rad);
  return text + fmt::format(
                    "coulomb_nm = {}\nviscous_nm_s_per_rad = {}\n"
                    "radius_mm = {}\n",
                    link.coulomb_nm + 0.0, link.viscous_nm_s_per_rad + 0.0, mm(link.radius_m));
}

std::string text_of(const Mounting& mounting, Carrier carrier, BodyPosture position) {
  const Matrix3& left = mounting.upright_from_shoulder[Arm::left];
  const Matrix3& right = mounting.upright_from_shoulder[Arm::right];
  std::string text = fmt::format("\n[{}]\nleft_shoulder_x = {}\nleft_shoulder_z = {}\n",
                                 name_of(position), axis(left.col(0)), axis(left.col(2)));
  if (right != left)
    text += fmt::format("right_shoulder_x = {}\nright_shoulder_z = {}\n", axis(right.col(0)),
                        axis(right.col(2)));
  if (carrier == Carrier::linear_base) {
    text += fmt::format("shoulders_apart_mm = {}\nmidway_in_couch_mm = {}\n",
                        mm(mounting.shoulders_apart_m), mm(mounting.midway_in_couch));
  } else {
    text += fmt::format("couch_height_mm = {}\nwaist_pitch_deg = {}\n", mm(mounting.couch_height_m),
                        deg(mounting.waist_pitch_rad));
    if (position == BodyPosture::sitting)
      text += fmt::format("behind_person_mm = {}\n", mm(mounting.behind_person_m));
  }
  text += fmt::format("rail_mm = [{}, {}]\nready_mm = {}\nready_elbow_outward_mm = {}\n",
                      mm(mounting.min_rail_m), mm(mounting.max_rail_m),
                      mm(mounting.ready_from_shoulder), mm(mounting.ready_elbow_outward_m));
  if (mounting.ready_near_rad.size() > 0) {
    std::string angles;
    for (const double near : mounting.ready_near_rad)
      angles += (angles.empty() ? "" : ", ") + deg(near);
    text += fmt::format("ready_near_deg = [{}]\n", angles);
  }
  for (const BodyBox& box : mounting.body) {
    text += fmt::format(
        "\n[[{}.body]]\nmiddle_mm = {}\nedges_mm = {}\nrides = {}\n"
        "spans_rail = {}\n",
        name_of(position), mm(box.middle_in_base), mm(box.edges_m), box.rides, box.spans_rail);
  }
  return text;
}

}  // namespace

std::string to_toml(const RobotModel& model) {
  const ArmTable& arm = model.arm;
  std::string text = fmt::format(
      "name = {}\nabout = {}\ncarrier = \"{}\"\n\n[tool]\nradius_mm = {}\nmass_kg = {}\n",
      toml_string(model.name), toml_string(model.about), name_of(model.carrier),
      mm(arm.tool_radius_m), arm.tool_mass_kg);
  if (!arm.end_from_tool_turn.isIdentity(0.0)) {
    text += fmt::format("x = {}\nz = {}\n", axis(arm.end_from_tool_turn.col(0)),
                        axis(arm.end_from_tool_turn.col(2)));
  }
  for (int i = 0; i < arm.joints; ++i) text += text_of(arm.links[static_cast<std::size_t>(i)]);
  for (const BodyPosture position : {BodyPosture::sitting, BodyPosture::prone})
    text += text_of(model.mounting(position), model.carrier, position);
  return text;
}

}  // namespace tuina::robot
