// SPDX-License-Identifier: Apache-2.0
#include "tuina/robot/table/robot_table.hpp"

#include <algorithm>
#include <set>

#include "tuina/core/decompositions.hpp"
#include "tuina/core/io/toml_reader.hpp"

namespace tuina::robot {
namespace {

using Words = TomlTable::Words;
constexpr double max_length_mm = 3000.0, max_moment_kg_m2 = 100.0;

/// What keeps a reader short: the value where it is sound, else nothing happens, because the fault
/// is collected already.
template <typename T, typename Given>
void take(T& into, const std::optional<Given>& given) {
  if (given) into = *given;
}
void take_mm(double& into_m, const std::optional<double>& given) {
  if (given) into_m = from_mm(*given);
}
void take_deg(double& into_rad, const std::optional<double>& given) {
  if (given) into_rad = from_deg(*given);
}
void take_mm(Vector3& into_m, const std::optional<std::vector<double>>& given) {
  if (!given) return;
  for (int i = 0; i < 3; ++i) into_m[i] = from_mm((*given)[static_cast<std::size_t>(i)]);
}

bool plain_name(const std::string& name) {
  const auto plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '-';
  };
  return !name.empty() && name.size() <= 60 && std::all_of(name.begin(), name.end(), plain);
}

/// The turn whose x and z axes are given; nothing where one is absent or they are no right angle.
std::optional<Matrix3> turn_of(const TomlTable& table, const std::string& x_key,
                               const std::string& z_key) {
  const auto x = table.numbers(x_key, 3, 1.0), z = table.numbers(z_key, 3, 1.0);
  if (!x || !z) return std::nullopt;
  Vector3 along_x((*x)[0], (*x)[1], (*x)[2]), along_z((*z)[0], (*z)[1], (*z)[2]);
  constexpr double close = 1e-4;
  if (std::abs(along_x.norm() - 1.0) > close || std::abs(along_z.norm() - 1.0) > close ||
      std::abs(along_x.dot(along_z)) > close) {
    table.reject(x_key,
                 fmt::format("{} and {} are not two unit vectors at a right angle", x_key, z_key));
    return std::nullopt;
  }
  // What is exact already stays as it is, so that a table written and read again is the same.
  constexpr double exact = 1e-12;
  if (std::abs(along_z.norm() - 1.0) > exact) along_z.normalize();
  if (std::abs(along_x.dot(along_z)) > exact) along_x -= along_x.dot(along_z) * along_z;
  if (std::abs(along_x.norm() - 1.0) > exact) along_x.normalize();
  Matrix3 turn;
  turn << along_x, along_z.cross(along_x), along_z;
  return turn;
}

/// A solid's moments of inertia are positive, and none is larger than the other two together.
bool is_of_a_solid(const Link& link) {
  const auto& [xx, yy, zz] = link.inertia_kg_m2;
  const auto& [xy, xz, yz] = link.inertia_products_kg_m2;
  Matrix3 tensor;
  tensor << xx, xy, xz, xy, yy, yz, xz, yz, zz;
  const Vector3 moments = principal_axes(tensor).moments;
  return moments[0] > 0.0 && moments[0] + moments[1] >= moments[2] * (1.0 - 1e-9);
}

Link read_link(const TomlTable& table) {
  table.only({"inertia_products_kg_m2", "gear_nm_per_rad"},
             {"name", "offset_deg", "d_mm", "a_mm", "alpha_deg", "limits_deg", "torque_limit_nm",
              "speed_limit_rad_per_s", "mass_kg", "com_m", "inertia_kg_m2", "rotor_inertia_kg_m2",
              "coulomb_nm", "viscous_nm_s_per_rad", "radius_mm"},
             "a link");
  Link link;
  take(link.name, table.text("name"));
  if (table.has("name") && !plain_name(link.name)) {
    table.wrong("name", "is not 1 to 60 letters, digits, - or _");
  }
  take_deg(link.offset_rad, table.number("offset_deg", -360.0, 360.0));
  take_mm(link.d_m, table.number("d_mm", -max_length_mm, max_length_mm));
  take_mm(link.a_m, table.number("a_mm", -max_length_mm, max_length_mm));
  take_deg(link.alpha_rad, table.number("alpha_deg", -360.0, 360.0));
  if (const auto limits = table.numbers("limits_deg", 2, 720.0)) {
    link.min_rad = from_deg((*limits)[0]);
    link.max_rad = from_deg((*limits)[1]);
    if (!(link.max_rad - link.min_rad >= 10_deg)) {
      table.reject("limits_deg", fmt::format("limits_deg = [{}, {}] are not two angles in order, "
                                             "10 degrees or more apart",
                                             (*limits)[0], (*limits)[1]));
    }
  }
  take(link.torque_limit_nm, table.number("torque_limit_nm", 0.1, 2000.0));
  take(link.speed_limit_rad_per_s, table.number("speed_limit_rad_per_s", 0.1, 20.0));
  take(link.mass_kg, table.number("mass_kg", 1e-3, 100.0));
  if (const auto com = table.numbers("com_m", 3, 2.0))
    std::copy(com->begin(), com->end(), link.com_in_joint.begin());
  const auto moments = table.numbers("inertia_kg_m2", 3, max_moment_kg_m2);
  if (moments) std::copy(moments->begin(), moments->end(), link.inertia_kg_m2.begin());
  if (const auto products = table.numbers("inertia_products_kg_m2", 3, max_moment_kg_m2))
    std::copy(products->begin(), products->end(), link.inertia_products_kg_m2.begin());
  if (moments && !is_of_a_solid(link)) {
    table.reject("inertia_kg_m2", fmt::format("inertia_kg_m2 = [{}, {}, {}] is that of no solid: "
                                              "its moments are not positive, or one exceeds the "
                                              "sum of the others",
                                              (*moments)[0], (*moments)[1], (*moments)[2]));
  }
  constexpr double min_rotor_kg_m2 = 1e-3;
  const auto rotor = table.number("rotor_inertia_kg_m2", 0.0, 10.0);
  take(link.rotor_inertia_kg_m2, rotor);
  if (rotor && *rotor < min_rotor_kg_m2) {
    table.reject("rotor_inertia_kg_m2",
                 fmt::format("rotor_inertia_kg_m2 = {} is no drive's, and a massage would press "
                             "too hard: the inertia of the motor times its gear ratio squared, {} "
                             "to 10",
                             *rotor, min_rotor_kg_m2));
  }
  if (table.has("gear_nm_per_rad"))
    take(link.gear_nm_per_rad, table.number("gear_nm_per_rad", 10.0, 1e7));
  take(link.coulomb_nm, table.number("coulomb_nm", 0.0, 100.0));
  take(link.viscous_nm_s_per_rad, table.number("viscous_nm_s_per_rad", 0.0, 100.0));
  take_mm(link.radius_m, table.number("radius_mm", 5.0, 300.0));
  return link;
}

void read_tool(const TomlTable& table, ArmTable& arm) {
  table.only({"x", "z"}, {"radius_mm", "mass_kg"}, "a tool");
  take_mm(arm.tool_radius_m, table.number("radius_mm", 5.0, 60.0));
  take(arm.tool_mass_kg, table.number("mass_kg", 0.01, 2.0));
  if (table.has("x") != table.has("z")) {
    table.reject(table.has("x") ? "x" : "z", "x and z of the tool are given both or not at all");
  }
  take(arm.end_from_tool_turn, turn_of(table, "x", "z"));
}

void read_arm(const TomlTable& root, ArmTable& arm) {
  if (const auto tool = root.table("tool")) read_tool(*tool, arm);
  if (!root.has("link")) return;
  const auto links = root.tables("link");
  if (links.size() != 6 && links.size() != 7) {
    root.reject("link", fmt::format("[[link]]: {} tables, 6 or 7 needed", links.size()));
    return;
  }
  arm.joints = static_cast<int>(links.size());
  std::set<std::string> names;
  for (std::size_t i = 0; i < links.size(); ++i) {
    arm.links[i] = read_link(links[i]);
    if (!names.insert(arm.links[i].name).second) links[i].wrong("name", "is there twice");
  }
  if (arm.links[links.size() - 1].mass_kg < arm.tool_mass_kg) {
    links.back().wrong(
        "mass_kg", fmt::format("is less than the tool's {} kg, which it holds", arm.tool_mass_kg));
  }
}

BodyBox read_box(const TomlTable& table) {
  table.only({"rides", "spans_rail"}, {"middle_mm", "edges_mm"}, "a box of the body");
  BodyBox box;
  take_mm(box.middle_in_base, table.numbers("middle_mm", 3, max_length_mm));
  take_mm(box.edges_m, table.numbers("edges_mm", 3, max_length_mm));
  if (table.has("edges_mm") && !(box.edges_m.minCoeff() > 0.0)) {
    table.reject("edges_mm", "edges_mm are not three lengths above zero");
  }
  take(box.rides, table.flag("rides"));
  take(box.spans_rail, table.flag("spans_rail"));
  return box;
}

Mounting read_mounting(const TomlTable& table, Carrier carrier, BodyPosture position, int joints) {
  Words needed = {"left_shoulder_x", "left_shoulder_z", "rail_mm", "ready_mm"};
  Words known = {"right_shoulder_x", "right_shoulder_z", "ready_elbow_outward_mm",
                 "ready_near_deg"};
  if (carrier == Carrier::linear_base) {
    needed.insert(needed.end(), {"midway_in_couch_mm", "shoulders_apart_mm"});
    known.emplace_back("body");
  } else {
    needed.insert(needed.end(), {"couch_height_mm", "waist_pitch_deg"});
    if (position == BodyPosture::sitting) needed.emplace_back("behind_person_mm");
  }
  table.only(known, needed, fmt::format("[{}] on a {}", name_of(position), name_of(carrier)));

  Mounting mounting;
  if (const auto turn = turn_of(table, "left_shoulder_x", "left_shoulder_z"))
    mounting.upright_from_shoulder = {.of = {*turn, *turn}};
  if (table.has("right_shoulder_x") != table.has("right_shoulder_z")) {
    table.reject("", "right_shoulder_x and right_shoulder_z are given both or not at all");
  }
  take(mounting.upright_from_shoulder[Arm::right],
       turn_of(table, "right_shoulder_x", "right_shoulder_z"));
  take_mm(mounting.shoulders_apart_m, table.number("shoulders_apart_mm", 100.0, 2000.0));
  take_mm(mounting.midway_in_couch, table.numbers("midway_in_couch_mm", 3, max_length_mm));
  if (const auto rail = table.numbers("rail_mm", 2, max_length_mm)) {
    mounting.min_rail_m = from_mm((*rail)[0]);
    mounting.max_rail_m = from_mm((*rail)[1]);
    if (!(mounting.min_rail_m <= 0.0 && mounting.max_rail_m >= 0.0)) {
      table.reject("rail_mm", fmt::format("rail_mm = [{}, {}] does not hold zero, where base is",
                                          (*rail)[0], (*rail)[1]));
    }
  }
  take_mm(mounting.ready_from_shoulder, table.numbers("ready_mm", 3, max_length_mm));
  take_mm(mounting.ready_elbow_outward_m, table.number("ready_elbow_outward_mm", 0.0, 2000.0));
  if (joints > 0) {
    const auto near = table.numbers("ready_near_deg", static_cast<std::size_t>(joints), 720.0);
    if (near) {
      mounting.ready_near_rad.resize(joints);
      for (int i = 0; i < joints; ++i)
        mounting.ready_near_rad[i] = from_deg((*near)[static_cast<std::size_t>(i)]);
    }
  }
  if (table.has("body") && table.tables("body").empty()) {
    table.wrong("body", fmt::format("is not a list of boxes, [[{}.body]]", name_of(position)));
  }
  for (const TomlTable& box : table.tables("body")) mounting.body.push_back(read_box(box));
  take_mm(mounting.couch_height_m, table.number("couch_height_mm", 100.0, 1500.0));
  take_deg(mounting.waist_pitch_rad, table.number("waist_pitch_deg", -80.0, 80.0));
  take_mm(mounting.behind_person_m, table.number("behind_person_mm", 100.0, 1500.0));
  return mounting;
}

}  // namespace

Result<RobotModel> parse_robot(std::string_view text, std::string_view name) {
  RobotModel model;
  const auto read = read_toml(text, name, Fault::config, [&](const TomlTable& root) {
    root.only({"about"}, {"name", "carrier", "tool", "link", "sitting", "prone"}, "a robot");
    take(model.name, root.text("name"));
    if (root.has("name") && !plain_name(model.name))
      root.wrong("name", "is not 1 to 60 letters, digits, - or _");
    take(model.about, root.text("about"));
    const auto quotes = [](char c) {
      return c == '"' || c == '\\' || (c >= 0 && c < ' ') || c == 127;
    };
    if (std::any_of(model.about.begin(), model.about.end(), quotes))
      root.reject("about", "about is not one line without quotes and backslashes");
    if (const auto carrier = root.word("carrier", {"linear_base", "wheeled_body"}))
      model.carrier = static_cast<Carrier>(*carrier);
    read_arm(root, model.arm);
    for (const BodyPosture position : {BodyPosture::sitting, BodyPosture::prone}) {
      if (const auto table = root.table(name_of(position))) {
        model.mountings[static_cast<std::size_t>(position)] =
            read_mounting(*table, model.carrier, position, model.arm.joints);
      }
    }
  });
  if (!read) return tl::unexpected(read.error());
  return model;
}

}  // namespace tuina::robot
