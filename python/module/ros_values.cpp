// SPDX-License-Identifier: Apache-2.0
#include "python/module/ros_values.hpp"

#include <cstring>

#include "tuina/telemetry/mcap/cdr.hpp"
#include "tuina/telemetry/mcap/ros_markers.hpp"

namespace tuina::python {
namespace {

namespace ros = telemetry::ros;

/// Turns a message into a dict by the list of its fields.
class DictWriter {
 public:
  template <typename T>
  void operator()(const char* name, const T& value) {
    dict[name] = of(value);
  }
  py::dict dict;

 private:
  template <typename T>
  static py::object of(const T& value) {
    DictWriter inside;
    T::fields(inside, value);
    return inside.dict;
  }
  template <ros::Number T>
  static py::object of(const T& value) {
    return py::cast(value);
  }
  static py::object of(const std::string& text) { return py::str(text); }
  template <ros::Number T>
  static py::object of(const std::vector<T>& numbers) {
    return py::array_t<T>(static_cast<py::ssize_t>(numbers.size()), numbers.data());
  }
  template <typename T>
  static py::object of(const std::vector<T>& items) {
    py::list list;
    for (const T& item : items) list.append(of(item));
    return list;
  }
};

/// Columns of numbers that grow row by row; each becomes an array of rows of one shape.
class Columns {
 public:
  void add(const char* name, std::initializer_list<double> numbers) {
    auto& column = find(name);
    column.insert(column.end(), numbers);
  }
  void add(const char* name, const std::vector<double>& numbers) {
    auto& column = find(name);
    column.insert(column.end(), numbers.begin(), numbers.end());
  }
  void add(const char* name, const ros::Vector3& v) { add(name, {v.x, v.y, v.z}); }
  void add(const char* name, const ros::Point& p) { add(name, {p.x, p.y, p.z}); }
  void add(const char* name, const ros::Quaternion& q) { add(name, {q.x, q.y, q.z, q.w}); }
  /// `parts`: how many of its kind each message has; `numbers`: of each.
  void into(py::dict& dict, const char* name, std::vector<std::size_t> shape) {
    auto& column = find(name);
    std::vector<py::ssize_t> sizes(shape.begin(), shape.end());
    // The array takes the memory over.
    auto* kept = new std::vector<double>(std::move(column));
    const py::capsule owner(kept, [](void* old) { delete static_cast<std::vector<double>*>(old); });
    dict[name] = py::array_t<double>(sizes, kept->data(), owner);
  }

 private:
  std::vector<double>& find(const char* name) {
    for (auto& [known, column] : columns_)
      if (std::strcmp(known, name) == 0) return column;
    return columns_.emplace_back(name, std::vector<double>{}).second;
  }
  std::vector<std::pair<const char*, std::vector<double>>> columns_;
};

using Bad = std::optional<std::size_t>;
using Texts = std::vector<std::string>;

/// Reads each message, and gives it to `each`, which says whether it fits those before.
template <typename Message, typename Each>
Bad for_each(const Texts& messages, const Each& each) {
  for (std::size_t i = 0; i < messages.size(); ++i) {
    const auto message = ros::from_cdr<Message>(messages[i]);
    if (!message || !each(*message)) return i;
  }
  return std::nullopt;
}

Bad joints_of(const Texts& messages, py::dict& dict) {
  Columns columns;
  Texts names;
  const Bad bad = for_each<ros::JointState>(messages, [&](const ros::JointState& joints) {
    if (names.empty()) names = joints.name;
    columns.add("position", joints.position);
    columns.add("velocity", joints.velocity);
    columns.add("effort", joints.effort);
    const std::size_t count = names.size();
    return joints.name == names && joints.position.size() == count &&
           joints.velocity.size() == count && joints.effort.size() == count;
  });
  if (bad) return bad;
  dict["name"] = names;
  for (const char* name : {"position", "velocity", "effort"})
    columns.into(dict, name, {messages.size(), names.size()});
  return bad;
}

Bad tools_of(const Texts& messages, py::dict& dict) {
  Columns columns;
  Texts names;
  const Bad bad = for_each<ros::MultiDOFJointState>(messages, [&](const auto& tools) {
    if (names.empty()) names = tools.joint_names;
    const std::size_t count = names.size();
    if (tools.joint_names != names || tools.transforms.size() != count ||
        tools.wrench.size() != count)
      return false;
    for (std::size_t i = 0; i < count; ++i) {
      columns.add("at_in_base", tools.transforms[i].translation);
      columns.add("base_from_tool_xyzw", tools.transforms[i].rotation);
      columns.add("force_in_tool_n", tools.wrench[i].force);
      columns.add("torque_in_tool_nm", tools.wrench[i].torque);
    }
    return true;
  });
  if (bad) return bad;
  dict["name"] = names;
  for (const char* name : {"at_in_base", "force_in_tool_n", "torque_in_tool_nm"})
    columns.into(dict, name, {messages.size(), names.size(), 3});
  columns.into(dict, "base_from_tool_xyzw", {messages.size(), names.size(), 4});
  return bad;
}

Bad poses_of(const Texts& messages, py::dict& dict) {
  Columns columns;
  const Bad bad = for_each<ros::PoseStamped>(messages, [&](const ros::PoseStamped& stamped) {
    columns.add("at_in_base", stamped.pose.position);
    columns.add("base_from_tool_xyzw", stamped.pose.orientation);
    return true;
  });
  if (bad) return bad;
  columns.into(dict, "at_in_base", {messages.size(), 3});
  columns.into(dict, "base_from_tool_xyzw", {messages.size(), 4});
  return bad;
}

Bad wrenches_of(const Texts& messages, py::dict& dict) {
  Columns columns;
  const Bad bad = for_each<ros::WrenchStamped>(messages, [&](const ros::WrenchStamped& stamped) {
    columns.add("force_in_tool_n", stamped.wrench.force);
    columns.add("torque_in_tool_nm", stamped.wrench.torque);
    return true;
  });
  if (bad) return bad;
  for (const char* name : {"force_in_tool_n", "torque_in_tool_nm"})
    columns.into(dict, name, {messages.size(), 3});
  return bad;
}

/// x, y, z of a cloud whose points begin with three floats, as those of a record do.
bool add_points(const ros::PointCloud2& cloud, py::dict& dict) {
  const std::size_t count = std::size_t{cloud.width} * cloud.height;
  const auto& fields = cloud.point_fields;
  constexpr std::uint8_t float32 = 7;
  const char* axes[] = {"x", "y", "z"};
  if (fields.size() < 3 || cloud.is_bigendian) return false;
  for (std::size_t i = 0; i < 3; ++i) {
    if (fields[i].name != axes[i] || fields[i].datatype != float32 || fields[i].count != 1 ||
        fields[i].offset + sizeof(float) > cloud.point_step)
      return false;
  }
  if (cloud.data.size() != count * cloud.point_step) return false;
  py::array_t<float> points(std::vector<py::ssize_t>{static_cast<py::ssize_t>(count), 3});
  float* out = points.mutable_data();
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      std::memcpy(out++, cloud.data.data() + i * cloud.point_step + fields[axis].offset,
                  sizeof(float));
    }
  }
  dict["points"] = points;
  return true;
}

template <typename Message>
Bad dicts_of(const Texts& messages, const std::vector<double>& time_s, py::list& list) {
  return for_each<Message>(messages, [&](const Message& message) {
    DictWriter writer;
    Message::fields(writer, message);
    writer.dict["time_s"] = time_s[list.size()];
    bool fits = true;
    if constexpr (std::is_same_v<Message, ros::PointCloud2>)
      fits = add_points(message, writer.dict);
    list.append(writer.dict);
    return fits;
  });
}

}  // namespace

Bad columns_of(const std::string& schema, const std::vector<double>& time_s, const Texts& messages,
               py::object& values) {
  using Rows = Bad (*)(const Texts&, py::dict&);
  constexpr std::pair<const char*, Rows> rows[] = {
      {"sensor_msgs/msg/JointState", &joints_of},
      {"sensor_msgs/msg/MultiDOFJointState", &tools_of},
      {"geometry_msgs/msg/PoseStamped", &poses_of},
      {"geometry_msgs/msg/WrenchStamped", &wrenches_of}};
  for (const auto& [name, read] : rows) {
    if (schema != name) continue;
    py::dict dict;
    dict["time_s"] = py::array_t<double>(static_cast<py::ssize_t>(time_s.size()), time_s.data());
    const Bad bad = read(messages, dict);
    values = dict;
    return bad;
  }
  using Lists = Bad (*)(const Texts&, const std::vector<double>&, py::list&);
  constexpr std::pair<const char*, Lists> lists[] = {
      {"sensor_msgs/msg/PointCloud2", &dicts_of<ros::PointCloud2>},
      {"tf2_msgs/msg/TFMessage", &dicts_of<ros::TFMessage>},
      {"visualization_msgs/msg/MarkerArray", &dicts_of<ros::MarkerArray>},
      {"std_msgs/msg/String", &dicts_of<ros::String>}};
  py::list list;
  for (const auto& [name, read] : lists) {
    if (schema != name) continue;
    const Bad bad = read(messages, time_s, list);
    values = list;
    return bad;
  }
  for (const std::string& message : messages) list.append(py::bytes(message));
  values = list;
  return std::nullopt;
}

}  // namespace tuina::python
