// SPDX-License-Identifier: Apache-2.0
#include "tuina/record/record_tables.hpp"

#include <fmt/format.h>

#include <cctype>
#include <map>
#include <nlohmann/json.hpp>

#include "tuina/core/io/file.hpp"
#include "tuina/record/session_folder.hpp"
#include "tuina/telemetry/mcap/cdr.hpp"
#include "tuina/telemetry/mcap/ros_messages.hpp"

namespace tuina::record {
namespace {

namespace mcap = telemetry::mcap;
namespace ros = telemetry::ros;

using Json = nlohmann::ordered_json;

/// Cells of one row with the names of their columns.
struct Cells {
  std::vector<std::string> columns;
  std::string row;

  void add(std::string column, std::string_view cell) {
    if (!columns.empty()) row += ',';
    columns.push_back(std::move(column));
    row += cell;
  }
  void number(std::string column, double value) {
    add(std::move(column), fmt::format("{}", value));
  }
  void text(std::string column, const std::string& value) {
    if (value.find_first_of(",\"\r\n") == std::string::npos) {
      add(std::move(column), value);
      return;
    }
    std::string quoted = "\"";
    for (const char letter : value) quoted.append(letter == '"' ? 2 : 1, letter);
    add(std::move(column), quoted + "\"");
  }
};

bool cells_of_joints(const ros::JointState& joints, Cells& cells) {
  struct Part {
    const std::vector<double>& values;
    const char *turning, *sliding;  ///< units of its two kinds of joints
  };
  const Part parts[] = {{joints.position, "rad", "m"},
                        {joints.velocity, "rad_per_s", "m_per_s"},
                        {joints.effort, "nm", "n"}};
  for (const Part& part : parts) {
    if (part.values.size() != joints.name.size()) return false;
    for (std::size_t i = 0; i < joints.name.size(); ++i) {
      // A robot has one joint that slides, the linear base below both arms.
      const bool slides = joints.name[i].starts_with("rail");
      cells.number(fmt::format("{}_{}", joints.name[i], slides ? part.sliding : part.turning),
                   part.values[i]);
    }
  }
  return true;
}

bool cells_of_tools(const ros::MultiDOFJointState& tools, Cells& cells) {
  const std::size_t count = tools.joint_names.size();
  if (tools.transforms.size() != count || tools.wrench.size() != count) return false;
  for (std::size_t i = 0; i < count; ++i) {
    const std::string& name = tools.joint_names[i];
    const auto three = [&](const char* what, const ros::Vector3& v, const char* unit) {
      cells.number(fmt::format("{}_{}x_{}", name, what, unit), v.x);
      cells.number(fmt::format("{}_{}y_{}", name, what, unit), v.y);
      cells.number(fmt::format("{}_{}z_{}", name, what, unit), v.z);
    };
    three("in_base_", tools.transforms[i].translation, "m");
    const ros::Quaternion& q = tools.transforms[i].rotation;
    const std::pair<const char*, double> turns[] = {{"x", q.x}, {"y", q.y}, {"z", q.z}, {"w", q.w}};
    for (const auto& [axis, value] : turns)
      cells.number(fmt::format("{}_base_from_tool_q{}", name, axis), value);
    three("force_in_tool_", tools.wrench[i].force, "n");
    three("torque_in_tool_", tools.wrench[i].torque, "nm");
  }
  return true;
}

void cells_of_json(const Json& event, const std::string& before, Cells& cells) {
  for (const auto& [key, value] : event.items()) {
    if (value.is_object()) {
      cells_of_json(value, before + key + ".", cells);
    } else if (value.is_string()) {
      cells.text(before + key, value.get<std::string>());
    } else {
      cells.text(before + key, value.is_null() ? "" : value.dump());
    }
  }
}

/// False where the message is not what the channel says.
bool cells_of(const std::string& schema, const mcap::Message& message, Cells& cells) {
  constexpr double s_per_ns = 1e-9;
  if (schema == "sensor_msgs/msg/JointState") {
    const auto joints = ros::from_cdr<ros::JointState>(message.data);
    cells.number("time_s", s_per_ns * static_cast<double>(message.log_time_ns));
    return joints && cells_of_joints(*joints, cells);
  }
  if (schema == "sensor_msgs/msg/MultiDOFJointState") {
    const auto tools = ros::from_cdr<ros::MultiDOFJointState>(message.data);
    cells.number("time_s", s_per_ns * static_cast<double>(message.log_time_ns));
    return tools && cells_of_tools(*tools, cells);
  }
  const Json event = Json::parse(message.data, nullptr, false);
  if (!event.is_object()) return false;
  // Some events know their time themselves.
  if (!event.contains("time_s"))
    cells.number("time_s", s_per_ns * static_cast<double>(message.log_time_ns));
  cells_of_json(event, "", cells);
  return true;
}

/// `/left/wrench` is left_wrench.csv.
std::string file_of(const std::string& topic) {
  std::string name;
  for (const char letter : topic) {
    const bool plain = std::isalnum(static_cast<unsigned char>(letter)) != 0 || letter == '_';
    if (plain) name += letter;
    if (!plain && !name.empty()) name += '_';
  }
  return name + ".csv";
}

/// The tables while the record is read.
class Tables {
 public:
  explicit Tables(const std::filesystem::path& folder) : folder_(folder) {}

  void take(const mcap::Contents& record, const mcap::Message& message) {
    if (!state_) return;
    const mcap::Channel& channel = record.channels.at(message.channel_id);
    const auto schema = record.schemas.find(channel.schema_id);
    const std::string name = schema == record.schemas.end() ? "" : schema->second.name;
    const bool table = channel.message_encoding == "json" || name == "sensor_msgs/msg/JointState" ||
                       name == "sensor_msgs/msg/MultiDOFJointState";
    if (!table) return;
    Cells cells;
    if (!cells_of(name, message, cells)) {
      state_ = fail(Fault::bad_input, "{}: the message at {:.3f} s is not what the channel says",
                    channel.topic, 1e-9 * static_cast<double>(message.log_time_ns));
      return;
    }
    put(message.channel_id, channel.topic, cells);
  }

  Result<RecordTables> finish(const mcap::Contents& record) {
    RecordTables all{.lost = record.lost};
    for (auto& [channel, table] : tables_) {
      flush(table);
      if (state_) state_ = table.file.finish();
      if (!state_) return tl::unexpected(state_.error());
      all.made.push_back({table.name, table.rows});
    }
    for (const auto& [id, channel] : record.channels)
      if (!tables_.contains(id)) all.left_out.push_back(channel.topic);
    return all;
  }

 private:
  struct Table {
    FileWriter file;
    std::string name;
    std::vector<std::string> columns;
    std::string text;  ///< rows that are not in the file yet
    std::uint64_t rows = 0;
  };

  void put(std::uint16_t channel, const std::string& topic, const Cells& cells) {
    auto found = tables_.find(channel);
    if (found == tables_.end()) {
      const std::string name = file_of(topic);
      auto file = FileWriter::open(folder_ / name);
      if (!file) {
        state_ = tl::unexpected(file.error());
        return;
      }
      found =
          tables_
              .emplace(channel, Table{.file = std::move(*file),
                                      .name = name,
                                      .columns = cells.columns,
                                      .text = fmt::format("{}\n", fmt::join(cells.columns, ","))})
              .first;
    }
    Table& table = found->second;
    if (table.columns != cells.columns) {
      state_ = fail(Fault::bad_input, "{}: row {} has other columns than those before", topic,
                    table.rows + 1);
      return;
    }
    table.text.append(cells.row).append("\n");
    ++table.rows;
    constexpr std::size_t max_waiting_bytes = std::size_t{1} << 20;
    if (table.text.size() > max_waiting_bytes) flush(table);
  }

  void flush(Table& table) {
    if (state_) state_ = table.file.append(table.text);
    table.text.clear();
  }

  std::filesystem::path folder_;
  std::map<std::uint16_t, Table> tables_;
  Result<void> state_ = {};
};

}  // namespace

Result<RecordTables> write_tables(const std::filesystem::path& mcap,
                                  const std::filesystem::path& folder) {
  Tables tables(folder);
  const auto record = read_record_file(
      mcap, [&](const telemetry::mcap::Contents& contents,
                const telemetry::mcap::Message& message) { tables.take(contents, message); });
  if (!record) return tl::unexpected(record.error());
  auto all = tables.finish(record->contents);
  if (!all) return fail(all.error().fault, "{}: {}", mcap.string(), all.error().message);
  return all;
}

}  // namespace tuina::record
