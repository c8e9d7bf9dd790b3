// SPDX-License-Identifier: Apache-2.0
#include "apps/cli/press_file.hpp"

#include <cmath>

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
    const std::size_t line = row + 2;
    if (!record.empty() && !(time_s > record.back().time_s)) {
      return fail(Fault::bad_input, "{}:{}: time_s goes from {} to {}, it must grow", path, line,
                  record.back().time_s, time_s);
    }
    if (std::abs(position_mm) > 1000.0 || std::abs(force_n) > 10000.0) {
      return fail(Fault::bad_input,
                  "{}:{}: {} mm and {} N are no press; up to 1000 mm and 10000 N can be", path,
                  line, position_mm, force_n);
    }
    record.push_back({time_s, {.depth_m = from_mm(position_mm), .force_n = force_n}});
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

tissue::SensorNoise PressFile::told(tissue::SensorNoise noise) const {
  if (std::isfinite(force_noise_n)) noise.force_n = force_noise_n;
  if (std::isfinite(position_noise_mm)) noise.position_m = from_mm(position_noise_mm);
  return noise;
}

tissue::SensorNoise PressFile::noise_of(std::span<const tissue::TimedPress> record) const {
  return told(tissue::estimate_noise(record));
}

}  // namespace tuina::app
