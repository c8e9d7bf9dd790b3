// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <nlohmann/json.hpp>

#include "apps/tuina/verbs.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/robot/inverse_kinematics.hpp"
#include "tuina/robot/ready_posture.hpp"
#include "tuina/robot/robot_model.hpp"
#include "tuina/robot/table/read_urdf.hpp"
#include "tuina/robot/table/robot_table.hpp"

namespace tuina::app {
namespace {

using nlohmann::ordered_json;

ordered_json json_of(const robot::Link& link) {
  return {{"name", link.name},
          {"offset_deg", to_deg(link.offset_rad)},
          {"d_mm", to_mm(link.d_m)},
          {"a_mm", to_mm(link.a_m)},
          {"alpha_deg", to_deg(link.alpha_rad)},
          {"limits_deg", {to_deg(link.min_rad), to_deg(link.max_rad)}},
          {"torque_limit_nm", link.torque_limit_nm},
          {"speed_limit_rad_per_s", link.speed_limit_rad_per_s},
          {"mass_kg", link.mass_kg},
          {"com_m", link.com_in_joint},
          {"inertia_kg_m2", link.inertia_kg_m2},
          {"inertia_products_kg_m2", link.inertia_products_kg_m2},
          {"rotor_inertia_kg_m2", link.rotor_inertia_kg_m2},
          {"gear_nm_per_rad", link.gear_nm_per_rad},
          {"coulomb_nm", link.coulomb_nm},
          {"viscous_nm_s_per_rad", link.viscous_nm_s_per_rad},
          {"radius_mm", to_mm(link.radius_m)}};
}

/// How the arms wait before a person: whether they can at all is the first thing to know of a
/// mounting.
ordered_json waiting(const robot::RobotModel& model, BodyPosture position, std::string& text) {
  const robot::RobotPlacement there = robot::place_robot(model, position);
  const auto arms = robot::both_models(there.arm, there.mount);
  const auto ready = robot::ready_posture(there.arm, there.mount);
  const robot::ReadyRoom room = robot::ready_room(arms, there.mount, ready, 0.0);
  ordered_json json = {{"rail_mm", {to_mm(there.mount.min_rail_m), to_mm(there.mount.max_rail_m)}},
                       {"between_arms_mm", to_mm(room.between_arms_m)}};
  for (const Arm arm : both_arms) {
    std::vector<double> ready_deg;
    for (const double q : ready[arm]) ready_deg.push_back(to_deg(q));
    const auto clear = [&](robot::Surrounding what) -> ordered_json {
      const double distance_m = room.clear[arm][what];
      return std::isfinite(distance_m) ? ordered_json(to_mm(distance_m)) : ordered_json();
    };
    json["ready"][name_of(arm)] = {
        {"q_deg", ready_deg},
        {"off_mm", to_mm(room.off_m[arm])},
        {"limit_room_deg", to_deg(robot::limit_room_rad(there.arm, ready[arm]))},
        {"to_couch_mm", clear(robot::Surrounding::couch)},
        {"to_body_mm", clear(robot::Surrounding::body)}};
    text += fmt::format(
        "{}, {} arm ready {:.0f} mm from where it should be{}, {:.0f} deg from the "
        "nearest joint end\n",
        name_of(position), name_of(arm), to_mm(room.off_m[arm]),
        room.off_m[arm] > robot::max_ready_off_m ? ": its mount does not suit this arm" : "",
        to_deg(robot::limit_room_rad(there.arm, ready[arm])));
  }
  text +=
      fmt::format("{}, what is nearest to arms that wait: {}\n", name_of(position), room.nearest());
  return json;
}

class RobotShow final : public Verb {
 public:
  [[nodiscard]] const char* name() const override { return "robot show"; }
  [[nodiscard]] const char* summary() const override {
    return "the table of a robot: links, limits, reach, how its arms wait for a person";
  }
  [[nodiscard]] const char* example() const override { return "tuina robot show panda"; }
  void describe(Options& options) override {
    options.add("robot", robot_, "a TOML file, or one of " + shipped_robot_names()).required();
  }
  [[nodiscard]] Result<Answer> run(const CommonOptions&) override {
    const auto model = robot::load_robot(robot_);
    if (!model) return tl::unexpected(model.error());
    const robot::ArmTable& arm = model->arm;
    std::string text = fmt::format("{}: {}\n{:<18}{:>9}{:>9}{:>9}{:>9}{:>18}{:>9}{:>9}{:>8}\n",
                                   model->name, model->about, "link", "offset,deg", "d,mm", "a,mm",
                                   "alpha", "limits,deg", "Nm", "rad/s", "kg");
    ordered_json links = ordered_json::array();
    double reach_m = 0.0, mass_kg = 0.0;
    for (int i = 0; i < arm.joints; ++i) {
      const robot::Link& link = arm.links[static_cast<std::size_t>(i)];
      links.push_back(json_of(link));
      reach_m += std::hypot(link.d_m, link.a_m);
      mass_kg += link.mass_kg;
      text += fmt::format(
          "{:<18}{:>9.1f}{:>9.1f}{:>9.1f}{:>9.1f}{:>18}{:>9.1f}{:>9.2f}{:>8.2f}\n", link.name,
          to_deg(link.offset_rad), to_mm(link.d_m), to_mm(link.a_m), to_deg(link.alpha_rad),
          fmt::format("{:.0f} to {:.0f}", to_deg(link.min_rad), to_deg(link.max_rad)),
          link.torque_limit_nm, link.speed_limit_rad_per_s, link.mass_kg);
    }
    text += fmt::format(
        "links of {:.0f} mm in all to the middle of the tool, {:.1f} kg an arm, on a {}\n",
        to_mm(reach_m), mass_kg, robot::name_of(model->carrier));
    ordered_json json = {{"name", model->name},
                         {"about", model->about},
                         {"carrier", robot::name_of(model->carrier)},
                         {"joints", arm.joints},
                         {"reach_mm", to_mm(reach_m)},
                         {"mass_kg", mass_kg},
                         {"tool_radius_mm", to_mm(arm.tool_radius_m)},
                         {"tool_mass_kg", arm.tool_mass_kg},
                         {"links", links}};
    for (const BodyPosture position : {BodyPosture::sitting, BodyPosture::prone})
      json[name_of(position)] = waiting(*model, position, text);
    text.pop_back();
    return Answer{.json = json.dump(2), .text = text};
  }

 private:
  std::string robot_;
};

class RobotImport final : public Verb {
 public:
  [[nodiscard]] const char* name() const override { return "robot import"; }
  [[nodiscard]] const char* summary() const override {
    return "the table of an arm from a URDF file, mounted as the thesis' until you mount it";
  }
  [[nodiscard]] const char* example() const override {
    return "tuina robot import arm.urdf --base base_link --tip tool0 --out mine.toml\n"
           "  tuina robot show mine.toml";
  }
  void describe(Options& options) override {
    options.add("file", file_, "URDF").required();
    options.add("--base", base_, "the link that is mounted").required();
    options
        .add("--tip", tip_, "the link whose origin is the sphere's centre and whose x points out")
        .required();
    options.add("--out", out_, "the table, as TOML").required();
  }
  [[nodiscard]] Result<Answer> run(const CommonOptions&) override {
    constexpr std::size_t max_bytes = 16 << 20;
    std::error_code fault;
    if (std::filesystem::exists(out_, fault)) {
      return fail(Fault::usage, "--out {}: is there, and may have been mended by hand since", out_);
    }
    const auto text = read_file(file_, max_bytes);
    if (!text) return tl::unexpected(text.error());
    const auto read = robot::read_urdf(*text, file_, base_, tip_);
    if (!read) return tl::unexpected(read.error());
    auto model = robot::load_robot("thesis");
    if (!model) return tl::unexpected(model.error());
    model->name = std::filesystem::path(out_).stem().string();
    model->about = fmt::format("{} to {} of {}", base_, tip_,
                               std::filesystem::path(file_).filename().string());
    model->arm = read->table;
    for (robot::Mounting& mounting : model->mountings) {
      for (const Arm arm : both_arms)
        mounting.upright_from_shoulder[arm] = read->link_from_shoulder.linear();
    }
    // What URDF does not hold is named as it would be refused.
    std::string missing;
    const std::string table = robot::to_toml(*model);
    if (const auto again = robot::parse_robot(table, out_); !again)
      missing = "\nto be mended by hand:\n" + again.error().message;
    if (const auto written = write_file(out_, table); !written)
      return tl::unexpected(written.error());
    const std::string note = read->note.empty() ? "" : read->note + "\n";
    return Answer{
        .json = ordered_json{{"robot", model->name},
                             {"joints", model->arm.joints},
                             {"complete", missing.empty()}}
                    .dump(2),
        .text = fmt::format("{}: {} joints; rotors, radii and how it is mounted are yours "
                            "to write\n{}now: tuina robot show {}{}",
                            out_, model->arm.joints, note, out_, missing)};
  }

 private:
  std::string file_, base_, tip_, out_;
};

}  // namespace

std::unique_ptr<Verb> make_robot_show() {
  return std::make_unique<RobotShow>();
}

std::unique_ptr<Verb> make_robot_import() {
  return std::make_unique<RobotImport>();
}

}  // namespace tuina::app
