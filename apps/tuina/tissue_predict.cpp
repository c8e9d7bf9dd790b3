// SPDX-License-Identifier: Apache-2.0
#include "apps/tuina/tissue_predict.hpp"

#include <algorithm>
#include <cmath>

#include "apps/cli/press_file.hpp"

namespace tuina::app {
namespace {

/// A position without its noise, and its speed.
struct Motion {
  double position_m = 0.0, speed_m_per_s = 0.0;
};

/// The straight line through the positions around a row: positions are known beforehand, forces are
/// not.
Motion motion_at(const std::vector<tissue::TimedPress>& rows, std::size_t row) {
  constexpr double reach_s = 12e-3;  // in which no press bends by more than 0.01 mm
  const double time_s = rows[row].time_s;
  std::size_t first = row, last = row;
  while (first > 0 && time_s - rows[first - 1].time_s < reach_s) --first;
  while (last + 1 < rows.size() && rows[last + 1].time_s - time_s < reach_s) ++last;
  // At either end the line would lean on one side only.
  const std::size_t reach = std::min(row - first, last - row);
  if (reach == 0) {
    const std::size_t a = row > 0 ? row - 1 : row, b = std::min(row + 1, rows.size() - 1);
    const double dt_s = rows[b].time_s - rows[a].time_s;
    const double way_m = rows[b].press.depth_m - rows[a].press.depth_m;
    return {rows[row].press.depth_m, dt_s > 0.0 ? way_m / dt_s : 0.0};
  }
  double n = 0.0, t = 0.0, x = 0.0, tt = 0.0, tx = 0.0;
  for (std::size_t i = row - reach; i <= row + reach; ++i) {
    const double at_s = rows[i].time_s - time_s, at_m = rows[i].press.depth_m;
    n += 1.0, t += at_s, x += at_m, tt += at_s * at_s, tx += at_s * at_m;
  }
  const double speed = (n * tx - t * x) / (n * tt - t * t);
  return {(x - speed * t) / n, speed};
}

}  // namespace

Result<std::string> predict_forces(tissue::CreepEstimator estimator, double begin_s, double end_s,
                                   const std::string& next_file) {
  const auto rows = read_presses(next_file, true);
  if (!rows) return tl::unexpected(rows.error());
  const double first_s = rows->front().time_s;
  if (first_s > begin_s && first_s <= end_s) {
    return fail(Fault::bad_input,
                "{}:2: time_s {} lies within the record, which ends at {}; a next press begins "
                "later, or on a clock of its own from {} or earlier",
                next_file, first_s, end_s, begin_s);
  }
  if (std::none_of(rows->begin(), rows->end(),
                   [](const auto& row) { return std::isnan(row.press.force_n); })) {
    return fail(Fault::bad_input,
                "{}: every row has a force_n; leave it empty where it is to be predicted",
                next_file);
  }
  // On a clock of its own the press is so much later that the tissue has forgotten the record.
  const double rested_s = 5.0 * tissue::memory_s.back();
  const double later_s = first_s > end_s ? 0.0 : end_s - first_s + rested_s;

  std::string csv = "time_s,force_n,force_low_n,force_high_n\n";
  tissue::CreepEstimator::Outlook outlook;
  bool told = false;
  for (std::size_t i = 0; i < rows->size(); ++i) {
    const auto& [time_s, press] = (*rows)[i];
    if (!std::isnan(press.force_n)) {
      estimator.update(time_s + later_s, press);
      told = false;
      continue;
    }
    if (!told) {
      estimator.settle();
      outlook = estimator.outlook();
      told = true;
    }
    const Motion motion = motion_at(*rows, i);
    const auto band =
        estimator.foretell(outlook, time_s + later_s, motion.position_m, motion.speed_m_per_s);
    fmt::format_to(std::back_inserter(csv), "{},{:.6g},{:.6g},{:.6g}\n", time_s, band.force_n,
                   band.low_n, band.high_n);
  }
  return csv;
}

}  // namespace tuina::app
