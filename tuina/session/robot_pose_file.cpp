// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <toml++/toml.h>
#include <cmath>

#include "tuina/core/csv.hpp"
#include "tuina/core/file.hpp"
#include "tuina/core/near_miss.hpp"
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

/// Reads three finite numbers below a limit, and says what is wrong otherwise.
class PoseReader {
 public:
  PoseReader(const toml::table& file, std::string_view name) : file_(file), name_(name) {}

  void only(const toml::table& table, const std::vector<std::string>& known) {
    for (const auto& [key, node] : table) {
      if (std::find(known.begin(), known.end(), key.str()) != known.end()) continue;
      refuse(node, fmt::format("`{}` is unknown; {}", key.str(), suggestion(key.str(), known)));
    }
  }
  const toml::table* section(const char* key) {
    const toml::table* table = file_[key].as_table();
    if (table == nullptr) refuse(file_, fmt::format("the table [{}] is missing", key));
    return table;
  }
  Vector3 vector(const toml::table& table, const char* key, double limit) {
    Vector3 numbers = Vector3::Zero();
    const toml::array* list = table[key].as_array();
    bool good = list != nullptr && list->size() == 3;
    for (std::size_t i = 0; good && i < 3; ++i) {
      const auto number = (*list)[i].value<double>();
      good = number && std::isfinite(*number) && std::abs(*number) <= limit;
      if (good) numbers(static_cast<Eigen::Index>(i)) = *number;
    }
    if (!good) {
      const toml::node* node = table.get(key);
      refuse(node != nullptr ? *node : table,
             fmt::format("{} needs three numbers from {} to {}", key, -limit, limit));
    }
    return numbers;
  }
  void refuse(const toml::node& node, const std::string& why) {
    faults_.push_back(fmt::format("{}:{}: {}", name_, node.source().begin.line, why));
  }
  [[nodiscard]] const std::vector<std::string>& faults() const { return faults_; }

 private:
  const toml::table& file_;
  std::string_view name_;
  std::vector<std::string> faults_;
};

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
      if (q_rad < link.lowest_rad - 1_deg || q_rad > link.highest_rad + 1_deg) {
        return refuse(fmt::format("q{}_deg is {:.1f}; this joint goes from {:.0f} to {:.0f}", j + 1,
                                  at(2 + j), to_deg(link.lowest_rad), to_deg(link.highest_rad)));
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
      "[robot]\nposition = \"{}\"  # of the people for whom it stands so\n\n"
      "[base_from_couch]  # X_in_base = R X_in_couch + translation; R turns about the vector by "
      "its length\n"
      "rotation_vector_rad = {}\ntranslation_m = {}\n",
      name_of(robot.position), list(turn_rad), list(place_m));
}

Result<PlacedRobot> parse_robot_pose(std::string_view text, std::string_view name) {
  try {
    const toml::table file = toml::parse(text, std::string(name));
    PoseReader read(file, name);
    PlacedRobot robot;
    read.only(file, {"robot", "base_from_couch"});
    if (const toml::table* section = read.section("robot")) {
      read.only(*section, {"position"});
      const auto position = (*section)["position"].value_or<std::string>("");
      if (position == name_of(Position::prone)) {
        robot.position = Position::prone;
      } else if (position != name_of(Position::sitting)) {
        read.refuse(*section, "position needs \"sitting\" or \"prone\"");
      }
    }
    if (const toml::table* pose = read.section("base_from_couch")) {
      read.only(*pose, {"rotation_vector_rad", "translation_m"});
      const Vector3 turn_rad = read.vector(*pose, "rotation_vector_rad", 2.0 * pi);
      if (turn_rad.norm() > 0.0) {
        robot.base_from_couch.linear() =
            Eigen::AngleAxisd(turn_rad.norm(), turn_rad.normalized()).toRotationMatrix();
      }
      robot.base_from_couch.translation() = read.vector(*pose, "translation_m", 100.0);
    }
    if (!read.faults().empty()) {
      return fail(Fault::bad_input, "{}", fmt::join(read.faults(), "\n"));
    }
    return robot;
  } catch (const toml::parse_error& error) {
    return fail(Fault::bad_input, "{}:{}: {}", name, error.source().begin.line,
                error.description());
  }
}

Result<PlacedRobot> read_robot_pose(const std::filesystem::path& file) {
  constexpr std::size_t largest_bytes = 1 << 20;
  const auto text = read_file(file, largest_bytes);
  if (!text) return tl::unexpected(text.error());
  return parse_robot_pose(*text, file.string());
}

}  // namespace tuina::session
