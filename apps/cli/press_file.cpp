// SPDX-License-Identifier: Apache-2.0
#include "apps/cli/press_file.hpp"

#include "apps/cli/command_line.hpp"
#include "tuina/core/io/csv.hpp"
#include "tuina/core/units.hpp"

namespace tuina::app {

Result<std::vector<tissue::TimedPress>> read_presses(const std::string& path, bool force_may_lack) {
  const auto table =
      read_csv(path, {"time_s", "position_mm", "force_n"}, force_may_lack ? "force_n" : "");
  if (!table) return tl::unexpected(table.error());
  std::vector<tissue::TimedPress> record;
  record.reserve(table->rows());
  for (std::size_t row = 0; row < table->rows(); ++row) {
    const double time_s = table->columns[0][row], position_mm = table->columns[1][row],
                 force_n = table->columns[2][row];
    const tissue::TimedPress read{time_s, {.depth_m = from_mm(position_mm), .force_n = force_n}};
    const std::string fault = fault_of(read, record.empty() ? nullptr : &record.back());
    if (!fault.empty()) return fail(Fault::bad_input, "{}:{}: {}", path, row + 2, fault);
    record.push_back(read);
  }
  if (!force_may_lack) {
    if (const std::string fault = tissue::fault_of(record); !fault.empty())
      return fail(Fault::bad_input, "{}: {}", path, fault);
  }
  return record;
}

void PressFile::describe(Options& options) {
  options.add("file", path, "CSV with the columns time_s, position_mm, force_n").required();
  options
      .add("--force-noise-n", force_noise_n,
           "standard deviation of a force sample; else read from the record")
      .between(1e-6, 1000.0);
  options
      .add("--position-noise-mm", position_noise_mm,
           "standard deviation of a position sample; else read from the record")
      .between(1e-6, 100.0);
}

}  // namespace tuina::app
