// SPDX-License-Identifier: Apache-2.0
#include "tuina/tissue/press_record.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tuina/core/units.hpp"

namespace tuina::tissue {
namespace {

constexpr std::size_t saturated_run = 5;
// Floors for noise-free (calculated) records, whose weights would be meaningless.
constexpr double min_force_noise_n = 0.005, min_position_noise_m = 1e-6;

/// Noise over neighbours `stride` samples away; `value` selects the signal.
template <typename Value>
double noise_at(std::span<const TimedPress> record, std::size_t stride, Value value) {
  std::vector<double> errors;
  for (std::size_t i = stride; i + stride < record.size(); ++i) {
    const TimedPress &before = record[i - stride], &here = record[i], &after = record[i + stride];
    const double share = (here.time_s - before.time_s) / (after.time_s - before.time_s);
    if (!(share > 0.2 && share < 0.8)) continue;  // beside a dropout
    const double line = value(before) + share * (value(after) - value(before));
    const double factor = 1.0 + share * share + (1.0 - share) * (1.0 - share);
    errors.push_back(std::abs(value(here) - line) / std::sqrt(factor));
  }
  if (errors.empty()) return 0.0;
  const auto middle = errors.begin() + static_cast<long>(errors.size() / 2);
  std::nth_element(errors.begin(), middle, errors.end());
  return 1.4826 * *middle;
}

/// Step between the readings of a coarse sensor; 0 if they are no multiples of one.
template <typename Value>
double step_of(std::span<const TimedPress> record, Value value) {
  constexpr double rounded = 1e-3;
  double step = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < record.size(); ++i) {
    const double change = std::abs(value(record[i]) - value(record[i - 1]));
    if (change > 0.0) step = std::min(step, change);
  }
  for (std::size_t i = 1; i < record.size(); ++i) {
    const double steps = (value(record[i]) - value(record[i - 1])) / step;
    if (!(std::abs(steps - std::round(steps)) < rounded)) return 0.0;
  }
  return std::isfinite(step) ? step : 0.0;
}

/// Noise of one signal, at least what rounding alone makes.
template <typename Value>
double noise_of(std::span<const TimedPress> record, double min_noise, Value value) {
  // A sensor's low-pass correlates neighbours, so farther ones are compared too.
  return std::max({noise_at(record, 1, value), noise_at(record, 3, value),
                   step_of(record, value) / std::sqrt(12.0), min_noise});
}

/// Mean force of the rows between two shares of the way, in newtons; NaN without such rows.
double mean_force_n(std::span<const TimedPress> record, double from_m, double to_m) {
  double sum_n = 0.0, count = 0.0;
  for (const TimedPress& row : record) {
    if (row.press.depth_m < from_m || row.press.depth_m > to_m) continue;
    sum_n += row.press.force_n;
    count += 1.0;
  }
  return sum_n / count;
}

/// True where all forces lie below zero and grow less and less with the position: tissue stiffens
/// as it is pressed, so this is a press with both signs turned, not a sensor with an offset.
bool both_signs_turned(std::span<const TimedPress> record, const Press& low, const Press& high) {
  constexpr double below_zero = 4.0, middle_from = 0.4, middle_to = 0.6, bent_share = 0.6;
  if (-low.force_n < below_zero * std::abs(high.force_n)) return false;
  const double way_m = high.depth_m - low.depth_m;
  const double middle_n =
      mean_force_n(record, low.depth_m + middle_from * way_m, low.depth_m + middle_to * way_m);
  return middle_n - low.force_n > bent_share * (high.force_n - low.force_n);
}

}  // namespace

SensorNoise KnownNoise::over(SensorNoise otherwise) const {
  if (std::isfinite(force_n)) otherwise.force_n = force_n;
  if (std::isfinite(position_m)) otherwise.position_m = position_m;
  return otherwise;
}

std::string fault_of(const TimedPress& row, const TimedPress* before) {
  constexpr double max_position_m = 1.0, max_force_n = 10000.0;
  if (before != nullptr && !(row.time_s > before->time_s))
    return fmt::format("time_s goes from {} to {}, it must grow", before->time_s, row.time_s);
  if (std::abs(row.press.depth_m) > max_position_m || std::abs(row.press.force_n) > max_force_n) {
    return fmt::format("{:g} mm and {:g} N are no press; up to {:.0f} mm and {:.0f} N can be",
                       to_mm(row.press.depth_m), row.press.force_n, to_mm(max_position_m),
                       max_force_n);
  }
  return {};
}

std::string fault_of(std::span<const TimedPress> record) {
  // Breath alone changes a force by less; nobody is pressed harder; no press is as slow.
  constexpr double clear_press_n = 5.0, min_way_m = 0.1_mm, opposed = -0.5;
  constexpr double max_rise_n = 1000.0, max_mean_step_s = 0.5;
  if (record.empty()) return {};
  Press low = record.front().press, high = low, mean = {0.0, 0.0};
  for (const TimedPress& row : record) {
    low = {std::min(low.depth_m, row.press.depth_m), std::min(low.force_n, row.press.force_n)};
    high = {std::max(high.depth_m, row.press.depth_m), std::max(high.force_n, row.press.force_n)};
    mean.depth_m += row.press.depth_m / static_cast<double>(record.size());
    mean.force_n += row.press.force_n / static_cast<double>(record.size());
  }
  const double way_m = high.depth_m - low.depth_m, rise_n = high.force_n - low.force_n;
  if (rise_n > max_rise_n)
    return fmt::format("force_n changes by {:.0f} in all: are these grams? Newtons are wanted",
                       rise_n);
  const double lasts_s = record.back().time_s - record.front().time_s;
  if (lasts_s > max_mean_step_s * static_cast<double>(record.size()))
    return fmt::format(
        "{} rows take {:.0f} s: are these milliseconds? time_s wants seconds, and a press some "
        "hundred rows a second",
        record.size(), lasts_s);
  if (rise_n < clear_press_n || way_m == 0.0) return {};
  if (way_m < min_way_m)
    return fmt::format(
        "position_mm changes by {:.3g} in all, the force by {:.3g} N: are these metres? "
        "Millimetres are wanted",
        to_mm(way_m), rise_n);
  double both = 0.0, way = 0.0, force = 0.0;
  for (const TimedPress& row : record) {
    const double off_m = row.press.depth_m - mean.depth_m, off_n = row.press.force_n - mean.force_n;
    both += off_m * off_n;
    way += off_m * off_m;
    force += off_n * off_n;
  }
  if (both < opposed * std::sqrt(way * force))
    return "the force falls as position_mm grows; a larger position must be a deeper one";
  if (both_signs_turned(record, low, high))
    return "all forces lie below zero and are strongest where position_mm is least: both signs are "
           "turned; a larger position must be a deeper one, and a force that presses above zero";
  return {};
}

std::string fault_of_next(std::span<const TimedPress> record, std::span<const TimedPress> next) {
  constexpr double min_share = 0.01;
  const auto way_m = [](std::span<const TimedPress> rows) {
    const auto shallower = [](const TimedPress& a, const TimedPress& b) {
      return a.press.depth_m < b.press.depth_m;
    };
    const auto [low, high] = std::minmax_element(rows.begin(), rows.end(), shallower);
    return rows.empty() ? 0.0 : high->press.depth_m - low->press.depth_m;
  };
  const double way = way_m(next), before = way_m(record);
  if (way == 0.0 || way > min_share * before) return {};
  return fmt::format(
      "position_mm changes by {:.3g} in all, in the record by {:.3g}: are these metres? "
      "Millimetres are wanted",
      to_mm(way), to_mm(before));
}

SensorNoise estimate_noise(std::span<const TimedPress> record) {
  const auto force = [](const TimedPress& s) { return s.press.force_n; };
  const auto position = [](const TimedPress& s) { return s.press.depth_m; };
  return {.force_n = noise_of(record, min_force_noise_n, force),
          .position_m = noise_of(record, min_position_noise_m, position)};
}

std::vector<TimedPress> without_saturation(std::span<const TimedPress> record,
                                           const SensorNoise& noise) {
  double max_n = 0.0;
  for (const TimedPress& sample : record) max_n = std::max(max_n, sample.press.force_n);
  std::size_t run = 0, max_run = 0;
  for (const TimedPress& sample : record) {
    run = sample.press.force_n == max_n ? run + 1 : 0;
    max_run = std::max(max_run, run);
  }
  if (max_run < saturated_run) return {record.begin(), record.end()};
  std::vector<TimedPress> kept;
  for (const TimedPress& sample : record) {
    if (sample.press.force_n < max_n - 4.0 * noise.force_n) kept.push_back(sample);
  }
  return kept;
}

}  // namespace tuina::tissue
