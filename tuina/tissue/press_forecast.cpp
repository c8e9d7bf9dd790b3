// SPDX-License-Identifier: Apache-2.0
#include "tuina/tissue/press_forecast.hpp"

#include <algorithm>
#include <cmath>

namespace tuina::tissue {
namespace {

/// A position without its noise, and its speed.
struct Motion {
  double position_m = 0.0, speed_m_per_s = 0.0;
};

/// The straight line through the positions around a row: positions are known beforehand, forces are
/// not.
Motion motion_at(std::span<const TimedPress> rows, std::size_t row) {
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

Result<std::vector<ForetoldForce>> foretell_press(CreepEstimator estimator, double begin_s,
                                                  double end_s, std::span<const TimedPress> rows) {
  if (rows.empty()) return fail(Fault::bad_input, "the later press has no rows");
  const double first_s = rows.front().time_s;
  if (first_s > begin_s && first_s <= end_s) {
    return fail(Fault::bad_input,
                "the first time_s, {}, lies within the record, which ends at {}; a next press "
                "begins later, or on a clock of its own from {} or earlier",
                first_s, end_s, begin_s);
  }
  if (std::none_of(rows.begin(), rows.end(),
                   [](const auto& row) { return std::isnan(row.press.force_n); })) {
    return fail(Fault::bad_input,
                "every row has a force_n; leave it empty where it is to be predicted");
  }
  // On a clock of its own the press is so much later that the tissue has forgotten the record.
  const double rested_s = 5.0 * memory_s.back();
  const double later_s = first_s > end_s ? 0.0 : end_s - first_s + rested_s;

  std::vector<ForetoldForce> all;
  CreepEstimator::Outlook outlook;
  bool told = false;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto& [time_s, press] = rows[i];
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
    const Motion motion = motion_at(rows, i);
    all.push_back({time_s, estimator.foretell(outlook, time_s + later_s, motion.position_m,
                                              motion.speed_m_per_s)});
  }
  return all;
}

}  // namespace tuina::tissue
