// SPDX-License-Identifier: Apache-2.0
#include "apps/simulated/session_tables.hpp"

#include <fmt/format.h>

#include <optional>

#include "tuina/core/io/csv.hpp"
#include "tuina/core/io/file.hpp"
#include "tuina/core/io/text_lines.hpp"
#include "tuina/core/units.hpp"

namespace tuina::app {
namespace {

constexpr const char* trace_header =
    "time_s,arm,technique,target_n,true_force_n,measured_force_n,depth_mm,x_m,y_m,z_m";

/// The cells of one line, taken one after the other.
class Cells {
 public:
  explicit Cells(std::string_view line) : rest_(line) {}
  std::string_view word() {
    const std::size_t comma = rest_.find(',');
    const std::string_view cell = rest_.substr(0, comma);
    more_ = comma != std::string_view::npos;
    rest_ = more_ ? rest_.substr(comma + 1) : std::string_view();
    return cell;
  }
  double number() {
    const auto value = to_number<double>(word());
    good_ = good_ && value.has_value();
    return value.value_or(0.0);
  }
  void spoil() { good_ = false; }
  [[nodiscard]] bool all_read() const { return good_ && !more_; }

 private:
  std::string_view rest_;
  bool more_ = true, good_ = true;
};

std::optional<telemetry::TraceRow> row_of(std::string_view line) {
  Cells cells(line);
  telemetry::TraceRow row;
  row.time_s = cells.number();
  const std::string_view arm = cells.word(), technique = cells.word();
  if (arm == name_of(Arm::right)) row.arm = Arm::right;
  if (arm != name_of(row.arm)) cells.spoil();
  row.technique = parse_technique(technique);
  if (!row.technique && technique != "none") cells.spoil();
  row.target_n = cells.number();
  row.true_force_n = cells.number();
  row.measured_force_n = cells.number();
  row.depth_m = from_mm(cells.number());
  for (int axis = 0; axis < 3; ++axis) row.tool_in_couch[axis] = cells.number();
  return cells.all_read() ? std::optional(row) : std::nullopt;
}

std::string angle_name(Arm arm, int joint) {
  return fmt::format("{}_q{}_deg", name_of(arm), joint);
}

}  // namespace

std::string csv_of(const std::vector<telemetry::TraceRow>& trace) {
  std::string text = fmt::format("{}\n", trace_header);
  text.reserve(90 * trace.size());
  for (const telemetry::TraceRow& row : trace) {
    fmt::format_to(std::back_inserter(text),
                   "{:.3f},{},{},{:.4f},{:.4f},{:.4f},{:.4f},{:.5f},{:.5f},{:.5f}\n", row.time_s,
                   name_of(row.arm), row.technique ? name_of(*row.technique) : "none", row.target_n,
                   row.true_force_n, row.measured_force_n, to_mm(row.depth_m),
                   row.tool_in_couch.x(), row.tool_in_couch.y(), row.tool_in_couch.z());
  }
  return text;
}

std::string csv_of(const std::vector<JointRow>& joints) {
  std::string text = "time_s,rail_mm";
  const auto count = joints.empty() ? 0 : joints.front().q_rad[Arm::left].size();
  for (const Arm arm : both_arms) {
    for (const char* what : {"q{}_deg", "torque{}_nm"}) {
      for (int j = 1; j <= count; ++j) {
        text += fmt::format(",{}_{}", name_of(arm), fmt::format(fmt::runtime(what), j));
      }
    }
  }
  text += "\n";
  const auto out = std::back_inserter(text);
  for (const JointRow& row : joints) {
    fmt::format_to(out, "{:.3f},{:.2f}", row.time_s, to_mm(row.rail_m));
    for (const Arm arm : both_arms) {
      for (const double q : row.q_rad[arm]) fmt::format_to(out, ",{:.4f}", to_deg(q));
      for (const double torque : row.torque_nm[arm]) fmt::format_to(out, ",{:.3f}", torque);
    }
    text += "\n";
  }
  return text;
}

std::string csv_of(const std::vector<telemetry::ArmDistance>& distances) {
  std::string text = "time_s,arm_to_arm_mm,arm_to_person_mm,arm_to_couch_mm,arm_to_body_mm\n";
  for (const telemetry::ArmDistance& row : distances) {
    text += fmt::format("{:.3f},{:.2f},{:.2f},{:.2f},{:.2f}\n", row.time_s, to_mm(row.apart_m),
                        to_mm(row.to_person_m), to_mm(row.to_couch_m), to_mm(row.to_body_m));
  }
  return text;
}

Result<std::vector<telemetry::TraceRow>> read_trace(const std::filesystem::path& file) {
  constexpr std::size_t max_bytes = std::size_t{1} << 29;
  const auto text = read_file(file, max_bytes);
  if (!text) return tl::unexpected(text.error());
  std::vector<telemetry::TraceRow> rows;
  std::string_view rest = *text;
  for (int line = 1; !rest.empty(); ++line) {
    const std::size_t end = rest.find('\n');
    std::string_view words = rest.substr(0, end);
    if (words.ends_with('\r')) words.remove_suffix(1);
    rest = end == std::string_view::npos ? std::string_view() : rest.substr(end + 1);
    if (line == 1) {
      if (words == trace_header) continue;
      return fail(Fault::bad_input, "{}:1: no trace of a session: the header is not `{}`",
                  file.string(), trace_header);
    }
    const auto row = row_of(words);
    if (!row) {
      return fail(Fault::bad_input, "{}:{}: `{}` is not a row of {}", file.string(), line,
                  words.substr(0, 100), trace_header);
    }
    rows.push_back(*row);
  }
  return rows;
}

Result<std::vector<JointRow>> read_joints(const std::filesystem::path& file) {
  const auto text = read_file(file);
  if (!text) return tl::unexpected(text.error());
  const std::string header = text->substr(0, text->find('\n'));
  std::vector<std::string> wanted = {"time_s", "rail_mm"};
  int joints = 0;
  while (joints < max_joints &&
         header.find(angle_name(Arm::left, joints + 1)) != std::string::npos) {
    ++joints;
  }
  for (const Arm arm : both_arms) {
    for (int j = 1; j <= joints; ++j) wanted.push_back(angle_name(arm, j));
  }
  const auto table = parse_csv(*text, file.string(), wanted);
  if (!table) return tl::unexpected(table.error());
  std::vector<JointRow> rows(table->rows());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows[i].time_s = table->columns[0][i];
    rows[i].rail_m = from_mm(table->columns[1][i]);
    std::size_t column = 2;
    for (const Arm arm : both_arms) {
      rows[i].q_rad[arm] = JointVector(joints);
      for (int j = 0; j < joints; ++j) rows[i].q_rad[arm][j] = 1_deg * table->columns[column++][i];
    }
  }
  return rows;
}

Result<std::vector<telemetry::ArmDistance>> read_distances(const std::filesystem::path& file) {
  const auto table = read_csv(
      file, {"time_s", "arm_to_arm_mm", "arm_to_person_mm", "arm_to_couch_mm", "arm_to_body_mm"});
  if (!table) return tl::unexpected(table.error());
  std::vector<telemetry::ArmDistance> rows;
  for (std::size_t i = 0; i < table->rows(); ++i) {
    const auto metres = [&](std::size_t column) { return from_mm(table->columns[column][i]); };
    rows.push_back({.time_s = table->columns[0][i],
                    .apart_m = metres(1),
                    .to_person_m = metres(2),
                    .to_couch_m = metres(3),
                    .to_body_m = metres(4)});
  }
  return rows;
}

}  // namespace tuina::app
