// SPDX-License-Identifier: Apache-2.0
#include "tuina/robot/table/read_urdf.hpp"

#include <tinyxml2.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <vector>

#include "tuina/core/io/text_lines.hpp"
#include "tuina/core/units.hpp"
#include "tuina/robot/table/urdf_rows.hpp"

namespace tuina::robot {
namespace {

using tinyxml2::XMLElement;

/// What stands in one file; the first thing that is wrong is kept.
struct Reader {
  std::string name;
  std::optional<Error> fault = {};

  template <typename... Args>
  void reject(const XMLElement& at, fmt::format_string<Args...> format, Args&&... args) {
    if (fault) return;
    fault = Error{Fault::bad_input, fmt::format("{}:{}: <{}>: {}", name, at.GetLineNum(), at.Name(),
                                                fmt::format(format, std::forward<Args>(args)...))};
  }

  /// So many finite numbers of an attribute, separated by blanks.
  std::vector<double> numbers(const XMLElement& at, const char* key, std::size_t count) {
    const char* text = at.Attribute(key);
    std::vector<double> all;
    std::string spaced = text != nullptr ? text : "";
    std::replace_if(
        spaced.begin(), spaced.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
    std::string_view rest = spaced;
    for (auto word = take_word(rest); !word.empty(); word = take_word(rest)) {
      const auto value = to_number<double>(word);
      if (!value || !(std::abs(*value) < 1e6)) {
        all.clear();
        break;
      }
      all.push_back(*value);
    }
    if (all.size() != count) {
      reject(at, "{} = \"{}\" is not {} number{} below a million", key, spaced, count,
             count == 1 ? "" : "s");
      all.assign(count, 0.0);
    }
    return all;
  }
  double number(const XMLElement& at, const char* key) { return numbers(at, key, 1)[0]; }
  Vector3 three(const XMLElement& at, const char* key, const Vector3& absent) {
    if (at.Attribute(key) == nullptr) return absent;
    const auto all = numbers(at, key, 3);
    return {all[0], all[1], all[2]};
  }

  /// The <origin> of an element; the identity where it has none.
  Transform origin(const XMLElement& of) {
    const XMLElement* at = of.FirstChildElement("origin");
    if (at == nullptr) return Transform::Identity();
    for (const auto* given = at->FirstAttribute(); given != nullptr; given = given->Next())
      if (given->Name() != std::string_view("xyz") && given->Name() != std::string_view("rpy"))
        reject(*at, "{} = \"{}\" is not read; give the place by xyz and the turn by rpy",
               given->Name(), given->Value());
    const Vector3 xyz = three(*at, "xyz", Vector3::Zero()),
                  rpy = three(*at, "rpy", Vector3::Zero());
    return Eigen::Translation3d(xyz) * Eigen::AngleAxisd(rpy.z(), Vector3::UnitZ()) *
           Eigen::AngleAxisd(rpy.y(), Vector3::UnitY()) *
           Eigen::AngleAxisd(rpy.x(), Vector3::UnitX());
  }
};

const XMLElement* find(const XMLElement& robot, const char* element, const char* child,
                       const char* attribute, const std::string& value) {
  for (const XMLElement* at = robot.FirstChildElement(element); at != nullptr;
       at = at->NextSiblingElement(element)) {
    const XMLElement* holder = child != nullptr ? at->FirstChildElement(child) : at;
    const char* given = holder != nullptr ? holder->Attribute(attribute) : nullptr;
    if (given != nullptr && value == given) return at;
  }
  return nullptr;
}

void add_mass(Reader& reader, const XMLElement& link, const Transform& base_from_link,
              CarriedMass& mass) {
  const XMLElement* inertial = link.FirstChildElement("inertial");
  if (inertial == nullptr) return;
  const XMLElement* weight = inertial->FirstChildElement("mass");
  const XMLElement* tensor = inertial->FirstChildElement("inertia");
  if (weight == nullptr || tensor == nullptr) {
    reader.reject(*inertial, "<mass> and <inertia> are both needed");
    return;
  }
  const Transform pose = base_from_link * reader.origin(*inertial);
  const double xx = reader.number(*tensor, "ixx"), yy = reader.number(*tensor, "iyy"),
               zz = reader.number(*tensor, "izz"), xy = reader.number(*tensor, "ixy"),
               xz = reader.number(*tensor, "ixz"), yz = reader.number(*tensor, "iyz");
  Matrix3 inertia;
  inertia << xx, xy, xz, xy, yy, yz, xz, yz, zz;
  mass.add(reader.number(*weight, "value"), pose.translation(),
           pose.linear() * inertia * pose.linear().transpose());
}

const char* link_of(const XMLElement& joint, const char* side) {
  const XMLElement* at = joint.FirstChildElement(side);
  const char* name = at != nullptr ? at->Attribute("link") : nullptr;
  return name != nullptr ? name : "";
}

/// Adds the masses of what hangs from a link of the chain, as a hand or a sensor beside the tip.
/// What moves there, as fingers, is small and counts where it stands at zero.
void add_hanging(Reader& reader, const XMLElement& robot, const XMLElement& link,
                 const Transform& base_from_link, std::set<const XMLElement*>& taken,
                 CarriedMass& mass) {
  const char* name = link.Attribute("name");
  for (const XMLElement* joint = robot.FirstChildElement("joint"); joint != nullptr;
       joint = joint->NextSiblingElement("joint")) {
    if (name == nullptr || link_of(*joint, "parent") != std::string_view(name)) continue;
    const XMLElement* hangs = find(robot, "link", nullptr, "name", link_of(*joint, "child"));
    if (hangs == nullptr || !taken.insert(hangs).second) continue;
    const Transform base_from_branch = base_from_link * reader.origin(*joint);
    add_mass(reader, *hangs, base_from_branch, mass);
    add_hanging(reader, robot, *hangs, base_from_branch, taken, mass);
  }
}

/// Direction in which a joint turns, in its own frame; x where none is given.
Vector3 axis_of(Reader& reader, const XMLElement& joint) {
  const XMLElement* axis = joint.FirstChildElement("axis");
  if (axis == nullptr) return Vector3::UnitX();
  const Vector3 along = reader.three(*axis, "xyz", Vector3::UnitX());
  if (along.norm() > 1e-6) return along.normalized();
  reader.reject(*axis, "xyz = \"{}\" is no direction", axis->Attribute("xyz"));
  return Vector3::UnitX();
}

/// The joints of the chain with what they carry, and the pose of the tip at zero.
std::vector<TurningJoint> read_chain(Reader& reader, const XMLElement& robot,
                                     const std::vector<const XMLElement*>& joints, Transform& tip) {
  std::vector<TurningJoint> chain;
  std::set<const XMLElement*> taken;  // links whose mass is somewhere, or is the base's
  for (const XMLElement* joint : joints) {
    for (const char* side : {"parent", "child"})
      taken.insert(find(robot, "link", nullptr, "name", link_of(*joint, side)));
  }
  tip = Transform::Identity();
  for (const XMLElement* joint : joints) {
    tip = tip * reader.origin(*joint);
    const char* given = joint->Attribute("type");
    const std::string type = given != nullptr ? given : "";
    if (type == "revolute" || type == "continuous") {
      TurningJoint turning;
      const char* name = joint->Attribute("name");
      turning.link.name = name != nullptr ? name : fmt::format("joint{}", chain.size() + 1);
      if (joint->FirstChildElement("mimic") != nullptr)
        reader.reject(*joint,
                      "{}: <mimic>: it follows another joint, and one of an arm has a drive",
                      turning.link.name);
      turning.at = tip.translation();
      turning.axis = tip.linear() * axis_of(reader, *joint);
      const XMLElement* limit = joint->FirstChildElement("limit");
      if (limit == nullptr) {
        reader.reject(
            *joint,
            "{}: <limit> is missing: effort and velocity of its drive, a continuous joint's too",
            turning.link.name);
      } else {
        turning.link.torque_limit_nm = reader.number(*limit, "effort");
        turning.link.speed_limit_rad_per_s = reader.number(*limit, "velocity");
        if (type == "revolute") {
          turning.link.min_rad = reader.number(*limit, "lower");
          turning.link.max_rad = reader.number(*limit, "upper");
        }
      }
      if (const XMLElement* dynamics = joint->FirstChildElement("dynamics")) {
        if (dynamics->Attribute("damping") != nullptr)
          turning.link.viscous_nm_s_per_rad = reader.number(*dynamics, "damping");
        if (dynamics->Attribute("friction") != nullptr)
          turning.link.coulomb_nm = reader.number(*dynamics, "friction");
      }
      chain.push_back(std::move(turning));
    } else if (type != "fixed") {
      reader.reject(*joint, "type = \"{}\": an arm has revolute, continuous and fixed joints only",
                    type);
    }
    const char* link_name = link_of(*joint, "child");
    const XMLElement* link = find(robot, "link", nullptr, "name", link_name);
    if (link == nullptr) {
      reader.reject(*joint, "there is no link called `{}`", link_name);
    } else if (!chain.empty()) {
      add_mass(reader, *link, tip, chain.back().mass);
      // What is mounted beyond the tip gives way to the sphere.
      if (joint != joints.back()) add_hanging(reader, robot, *link, tip, taken, chain.back().mass);
    }
  }
  return chain;
}

/// Axes that are nearly parallel, as 3.14 for pi leaves them, meet their common normal far from the
/// arm, and no table takes such rows. Says which joints they are; empty where all is well.
std::string far_normal(const ArmTable& table) {
  constexpr double max_length_m = 3.0;  // as of a table
  for (int i = 0; i + 1 < table.joints; ++i) {
    const Link& link = table.links[static_cast<std::size_t>(i)];
    const double far_m = std::max(std::abs(link.d_m), std::abs(link.a_m));
    if (far_m <= max_length_m) continue;
    return fmt::format(
        "joints {} and {} are {:.4f} degrees from parallel, and their common normal lies {:.0f} m "
        "away: give the angles of parallel axes with more digits, as 3.14159265 for pi",
        i + 1, i + 2, to_deg(std::asin(std::abs(std::sin(link.alpha_rad)))), far_m);
  }
  return {};
}

}  // namespace

Result<UrdfArm> read_urdf(std::string_view text, std::string_view name,
                          const std::string& base_link, const std::string& tip_link) {
  if (text.find_first_not_of(" \t\r\n") == std::string_view::npos)
    return fail(Fault::bad_input, "{}: is empty; a URDF begins with <robot>", name);
  tinyxml2::XMLDocument document;
  if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS) {
    return fail(Fault::bad_input, "{}:{}: is not XML: an element does not end or is misspelled",
                name, document.ErrorLineNum());
  }
  const XMLElement* robot = document.FirstChildElement("robot");
  if (robot == nullptr) return fail(Fault::bad_input, "{}: has no element <robot>", name);
  for (const std::string& link : {base_link, tip_link}) {
    if (find(*robot, "link", nullptr, "name", link) == nullptr)
      return fail(Fault::bad_input, "{}:{}: <robot>: there is no link called `{}`", name,
                  robot->GetLineNum(), link);
  }
  std::vector<const XMLElement*> joints;
  constexpr std::size_t max_joints_of_a_chain = 100;
  for (std::string link = tip_link; link != base_link;) {
    const XMLElement* joint = find(*robot, "joint", "child", "link", link);
    const XMLElement* parent = joint != nullptr ? joint->FirstChildElement("parent") : nullptr;
    const char* above = parent != nullptr ? parent->Attribute("link") : nullptr;
    if (above == nullptr || joints.size() == max_joints_of_a_chain) {
      return fail(Fault::bad_input, "{}:{}: <link>: no joints lead from `{}` down to `{}`", name,
                  find(*robot, "link", nullptr, "name", tip_link)->GetLineNum(), base_link,
                  tip_link);
    }
    joints.push_back(joint);
    link = above;
  }
  std::reverse(joints.begin(), joints.end());
  Reader reader{.name = std::string(name)};
  Transform tip;
  std::vector<TurningJoint> chain = read_chain(reader, *robot, joints, tip);
  if (reader.fault) return tl::unexpected(*reader.fault);
  if (chain.size() != 6 && chain.size() != 7) {
    return fail(Fault::bad_input,
                "{}:{}: <robot>: {} turning joints lead from `{}` to `{}`, 6 or 7 needed", name,
                robot->GetLineNum(), chain.size(), base_link, tip_link);
  }
  UrdfArm arm = arm_of(std::move(chain), tip);
  if (const std::string far = far_normal(arm.table); !far.empty())
    return fail(Fault::bad_input, "{}:{}: <robot>: {}", name, robot->GetLineNum(), far);
  const char* called = robot->Attribute("name");
  arm.robot = called != nullptr ? called : "";
  return arm;
}

}  // namespace tuina::robot
