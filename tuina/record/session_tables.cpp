// SPDX-License-Identifier: Apache-2.0
#include "tuina/record/session_tables.hpp"

#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "tuina/core/io/file.hpp"
#include "tuina/core/io/text_lines.hpp"
#include "tuina/core/units.hpp"

namespace tuina::record {
namespace {

double as_it_is(double value) {
  return value;
}

/// How a column states a number: digits behind the point, and the way to its unit and back.
struct Stated {
  int digits;
  double (*in_file)(double) = as_it_is;
  double (*in_si)(double) = as_it_is;
};
constexpr Stated mm(int digits) {
  return {digits, to_mm, from_mm};
}

// The columns of each table, once: for its header, its rows and for reading them again.

constexpr auto trace_columns = [](auto& visit, auto& row) {
  visit("time_s", row.time_s, Stated{3});
  visit("arm", row.arm);
  visit("technique", row.technique);
  visit("target_n", row.target_n, Stated{4});
  visit.maybe("true_force_n", row.true_force_n, Stated{4});
  visit("measured_force_n", row.measured_force_n, Stated{4});
  visit.maybe("depth_mm", row.depth_m, mm(4));
  visit("x_m", row.tool_in_couch.x(), Stated{5});
  visit("y_m", row.tool_in_couch.y(), Stated{5});
  visit("z_m", row.tool_in_couch.z(), Stated{5});
};

constexpr auto joint_columns = [](auto& visit, auto& row) {
  visit("time_s", row.time_s, Stated{3});
  visit("rail_mm", row.rail_m, mm(2));
  for (const Arm arm : both_arms) {
    const auto name = [&](const char* what, Eigen::Index j, const char* unit) {
      return fmt::format("{}_{}{}_{}", name_of(arm), what, j + 1, unit);
    };
    for (Eigen::Index j = 0; j < row.q_rad[arm].size(); ++j)
      visit(name("q", j, "deg"), row.q_rad[arm][j], Stated{4, to_deg, from_deg});
    for (Eigen::Index j = 0; j < row.torque_nm[arm].size(); ++j)
      visit(name("torque", j, "nm"), row.torque_nm[arm][j], Stated{3});
  }
};

constexpr auto distance_columns = [](auto& visit, auto& row) {
  visit("time_s", row.time_s, Stated{3});
  visit("arm_to_arm_mm", row.apart_m, mm(2));
  visit.maybe("arm_to_person_mm", row.to_person_m, mm(2));
  visit("arm_to_couch_mm", row.to_couch_m, mm(2));
  visit("arm_to_body_mm", row.to_body_m, mm(2));
};

constexpr const char* no_technique = "none";

/// Header and cells of one row; `maybe` leaves the cell of what is not known empty.
struct RowWriter {
  void operator()(std::string_view name, double value, Stated stated) {
    add(name, fmt::format("{:.{}f}", stated.in_file(value), stated.digits));
  }
  void maybe(std::string_view name, double value, Stated stated) {
    if (std::isfinite(value)) return (*this)(name, value, stated);
    add(name, "");
  }
  void operator()(std::string_view name, Arm arm) { add(name, name_of(arm)); }
  void operator()(std::string_view name, std::optional<Technique> technique) {
    add(name, technique ? name_of(*technique) : no_technique);
  }
  void add(std::string_view name, std::string_view cell) {
    const char* comma = header.empty() ? "" : ",";
    header.append(comma).append(name);
    cells.append(comma).append(cell);
  }
  std::string header, cells;
};

/// Takes the cells of one line one after the other.
class RowReader {
 public:
  explicit RowReader(std::string_view line) : rest_(line) {}
  void operator()(std::string_view, double& value, Stated stated) {
    const auto number = to_number<double>(next());
    good_ = good_ && number.has_value();
    value = stated.in_si(number.value_or(0.0));
  }
  /// An empty cell leaves the value as it is.
  void maybe(std::string_view name, double& value, Stated stated) {
    if (!rest_.starts_with(',')) return (*this)(name, value, stated);
    (void)next();
  }
  void operator()(std::string_view, Arm& arm) {
    const std::string_view cell = next();
    if (cell == name_of(Arm::right)) arm = Arm::right;
    good_ = good_ && cell == name_of(arm);
  }
  void operator()(std::string_view, std::optional<Technique>& technique) {
    const std::string_view cell = next();
    technique = parse_technique(cell);
    good_ = good_ && (technique || cell == no_technique);
  }
  [[nodiscard]] bool all_read() const { return good_ && !more_; }

 private:
  std::string_view next() {
    const std::size_t comma = rest_.find(',');
    const std::string_view cell = rest_.substr(0, comma);
    more_ = comma != std::string_view::npos;
    rest_ = more_ ? rest_.substr(comma + 1) : std::string_view();
    return cell;
  }
  std::string_view rest_;
  bool more_ = true, good_ = true;
};

template <typename Row, typename Columns>
RowWriter written(const Row& row, const Columns& columns) {
  RowWriter writer;
  columns(writer, row);
  return writer;
}

template <typename Row, typename Columns>
std::string table_of(const std::vector<Row>& rows, const Columns& columns) {
  std::string text = written(rows.empty() ? Row() : rows.front(), columns).header + "\n";
  for (const Row& row : rows) text += written(row, columns).cells + "\n";
  return text;
}

/// The rows of a table that has the columns of the row that `like` makes of its first line.
template <typename Like, typename Columns>
auto read_rows(const std::filesystem::path& file, const Like& like_of, const Columns& columns)
    -> Result<std::vector<decltype(like_of(""))>> {
  constexpr std::size_t max_bytes = std::size_t{1} << 29;
  const auto read = read_file(file, max_bytes);
  if (!read) return tl::unexpected(read.error());
  std::string_view text = *read;
  const auto like = like_of(text.substr(0, text.find('\n')));
  const std::string header = written(like, columns).header;
  std::vector<decltype(like_of(""))> rows;
  for (int line = 1; line == 1 || !text.empty(); ++line) {
    const std::size_t end = text.find('\n');
    std::string_view words = text.substr(0, end);
    if (words.ends_with('\r')) words.remove_suffix(1);
    text = end == std::string_view::npos ? std::string_view() : text.substr(end + 1);
    if (line == 1) {
      if (words == header) continue;
      return fail(Fault::bad_input, "{}:1: no {} of a session: the header is not `{}`",
                  file.string(), file.stem().string(), header);
    }
    RowReader cells(words);
    columns(cells, rows.emplace_back(like));
    if (!cells.all_read()) {
      return fail(Fault::bad_input, "{}:{}: `{}` is not a row of {}", file.string(), line,
                  words.substr(0, 100), header);
    }
  }
  return rows;
}

}  // namespace

std::string csv_of(const std::vector<telemetry::TraceRow>& trace) {
  return table_of(trace, trace_columns);
}
std::string csv_of(const std::vector<JointRow>& joints) {
  return table_of(joints, joint_columns);
}
std::string csv_of(const std::vector<telemetry::ArmDistance>& distances) {
  return table_of(distances, distance_columns);
}

Result<std::vector<telemetry::TraceRow>> read_trace(const std::filesystem::path& file) {
  return read_rows(
      file, [](std::string_view) { return telemetry::TraceRow(); }, trace_columns);
}

Result<std::vector<JointRow>> read_joints(const std::filesystem::path& file) {
  // Arms have as many joints as the header names.
  const auto like = [](std::string_view header) {
    int joints = 0;
    while (joints < max_joints &&
           header.find(fmt::format("left_q{}_deg", joints + 1)) != std::string_view::npos)
      ++joints;
    JointRow row;
    for (const Arm arm : both_arms) row.q_rad[arm] = row.torque_nm[arm] = JointVector(joints);
    return row;
  };
  return read_rows(file, like, joint_columns);
}

Result<std::vector<telemetry::ArmDistance>> read_distances(const std::filesystem::path& file) {
  return read_rows(
      file, [](std::string_view) { return telemetry::ArmDistance(); }, distance_columns);
}

}  // namespace tuina::record
