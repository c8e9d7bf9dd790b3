// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "tuina/core/io/csv.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/core/io/text_lines.hpp"
#include "tuina/core/io/toml_reader.hpp"
#include "tuina/session/robot_pose.hpp"

namespace tuina::session {
namespace {

std::vector<std::string> columns_of(const robot::ArmTable& table) {
  std::vector<std::string> columns = {"arm", "rail_mm"};
  for (int i = 1; i <= table.joints; ++i) columns.push_back(fmt::format("q{}_deg", i));
  for (const char* last : {"x_mm", "y_mm", "z_mm", "normal_x", "normal_y", "normal_z"}) {
    columns.emplace_back(last);
  }
  return columns;
}

Vector3 vector_of(const TomlTable& table, const char* key, double limit) {
  const auto numbers = table.numbers(key, 3, limit);
  return numbers ? Vector3((*numbers)[0], (*numbers)[1], (*numbers)[2]) : Vector3::Zero();
}

}  // namespace

Result<std::vector<robot::Touch>> read_touches(const std::filesystem::path& file,
                                               const robot::ArmTable& table) {
  const auto csv = read_csv(file, columns_of(table));
  if (!csv) return tl::unexpected(csv.error());
  std::vector<robot::Touch> touches(csv->rows());
  for (std::size_t row = 0; row < touches.size(); ++row) {
    const auto at = [&](std::size_t column) { return csv->columns[column][row]; };
    const auto vector_at = [&](std::size_t column) {
      return Vector3(at(column), at(column + 1), at(column + 2));
    };
    const auto refuse = [&](const std::string& why) {
      return fail(Fault::bad_input, "{}:{}: {}", file.string(), row + 2, why);
    };
    robot::Touch& touch = touches[row];
    if (at(0) != 0.0 && at(0) != 1.0) {
      return refuse(fmt::format("arm is {}; 0 is the left one, 1 the right one", at(0)));
    }
    touch.arm = at(0) == 0.0 ? Arm::left : Arm::right;
    touch.rail_m = from_mm(at(1));
    touch.q_rad.resize(table.joints);
    const auto joints = static_cast<std::size_t>(table.joints);
    for (std::size_t j = 0; j < joints; ++j) {
      const robot::Link& link = table.links[j];
      const double q_rad = from_deg(at(2 + j));
      if (q_rad < link.min_rad - 1_deg || q_rad > link.max_rad + 1_deg) {
        return refuse(fmt::format("q{}_deg is {:.1f}; this joint goes from {:.0f} to {:.0f}", j + 1,
                                  at(2 + j), to_deg(link.min_rad), to_deg(link.max_rad)));
      }
      touch.q_rad(static_cast<Eigen::Index>(j)) = q_rad;
    }
    touch.spot_in_couch = 1e-3 * vector_at(2 + joints);
    touch.normal_in_couch = vector_at(5 + joints);
    if (std::abs(touch.normal_in_couch.norm() - 1.0) > 0.01) {
      return refuse(
          fmt::format("the normal is {:.3f} long; it must be 1", touch.normal_in_couch.norm()));
    }
    touch.normal_in_couch.normalize();
  }
  return touches;
}

std::string to_csv(std::span<const robot::Touch> touches) {
  robot::ArmTable table;
  table.joints = touches.empty() ? 0 : static_cast<int>(touches.front().q_rad.size());
  std::string text = fmt::format("{}\n", fmt::join(columns_of(table), ","));
  for (const robot::Touch& touch : touches) {
    text += fmt::format("{},{}", touch.arm == Arm::left ? 0 : 1, to_mm(touch.rail_m));
    for (const double q : touch.q_rad) text += fmt::format(",{:.4f}", to_deg(q));
    for (const double x : touch.spot_in_couch) text += fmt::format(",{:.2f}", to_mm(x));
    for (const double x : touch.normal_in_couch) text += fmt::format(",{:.5f}", x);
    text += "\n";
  }
  return text;
}

std::string to_toml(const PlacedRobot& robot) {
  const Eigen::AngleAxisd turn(robot.base_from_couch.linear());
  const Vector3 turn_rad = turn.angle() * turn.axis();
  const Vector3 place_m = robot.base_from_couch.translation();
  const auto list = [](const Vector3& v) {
    return fmt::format("[{:.17g}, {:.17g}, {:.17g}]", v.x(), v.y(), v.z());
  };
  return fmt::format(
      "[robot]\nname = {}\nposition = \"{}\"  # of the people for whom it stands so\n\n"
      "[base_from_couch]  # X_in_base = R X_in_couch + translation; R turns about the vector by "
      "its length\n"
      "rotation_vector_rad = {}\ntranslation_m = {}\n",
      toml_string(robot.robot), name_of(robot.position), list(turn_rad), list(place_m));
}

Result<PlacedRobot> parse_robot_pose(std::string_view text, std::string_view name) {
  PlacedRobot robot;
  const auto read = read_toml(text, name, Fault::bad_input, [&](const TomlTable& root) {
    root.only({}, {"robot", "base_from_couch"});
    if (const auto section = root.table("robot")) {
      section->only({"name"}, {"position"});
      robot.robot = section->text("name").value_or(robot.robot);
      const auto position =
          section->word("position", {name_of(BodyPosture::sitting), name_of(BodyPosture::prone)});
      robot.position = position == 1U ? BodyPosture::prone : BodyPosture::sitting;
    }
    if (const auto pose = root.table("base_from_couch")) {
      pose->only({}, {"rotation_vector_rad", "translation_m"});
      const Vector3 turn_rad = vector_of(*pose, "rotation_vector_rad", 2.0 * pi);
      if (turn_rad.norm() > 0.0) {
        robot.base_from_couch.linear() =
            Eigen::AngleAxisd(turn_rad.norm(), turn_rad.normalized()).toRotationMatrix();
      }
      robot.base_from_couch.translation() = vector_of(*pose, "translation_m", 100.0);
    }
  });
  if (!read) return tl::unexpected(read.error());
  return robot;
}

Result<PlacedRobot> read_robot_pose(const std::filesystem::path& file) {
  constexpr std::size_t max_bytes = 1 << 20;
  const auto text = read_file(file, max_bytes);
  if (!text) return tl::unexpected(text.error());
  return parse_robot_pose(*text, file.string());
}

}  // namespace tuina::session
