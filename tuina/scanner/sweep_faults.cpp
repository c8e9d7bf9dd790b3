// SPDX-License-Identifier: Apache-2.0
#include "tuina/scanner/sweep_faults.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "tuina/core/units.hpp"
#include "tuina/scanner/two_way.hpp"

namespace tuina::scanner {
namespace {

double median_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// A gap of two frame times is one lost frame; the pause at the turn does not count.
Result<void> check_lost(std::span<const TimedLine> lines, std::size_t turn, double max_lost_share) {
  std::vector<double> gaps_s;
  for (std::size_t i = 1; i < lines.size(); ++i) {
    if (i != turn) gaps_s.push_back(lines[i].time_s - lines[i - 1].time_s);
  }
  const double usual_s = median_of(gaps_s);
  double lost = 0.0;
  for (const double gap_s : gaps_s) lost += std::max(0.0, std::round(gap_s / usual_s) - 1.0);
  const double all = lost + static_cast<double>(lines.size());
  if (lost <= max_lost_share * all) return {};
  return fail(
      Fault::bad_input,
      "{:.0f} of {:.0f} frames are lost ({:.0f} %, up to {:.0f} % can be borne): their times "
      "leave gaps; is the cable or the USB bus overloaded?",
      lost, all, 100.0 * lost / all, 100.0 * max_lost_share);
}

// Median shift of the line between two frames.
std::optional<double> moved_px(const LaserLine& a, const LaserLine& b) {
  std::vector<double> moves;
  auto other = b.points.begin();
  for (const LinePoint& point : a.points) {
    while (other != b.points.end() && other->row < point.row) ++other;
    if (other == b.points.end()) break;
    if (other->row != point.row) continue;
    moves.push_back(std::abs(static_cast<double>(point.column_px - other->column_px)));
  }
  if (moves.size() < 20) return {};
  return median_of(std::move(moves));
}

// In order, the line moves farther in two frames than in one; at a misplaced frame, the next but
// one is nearer than the next.
Result<void> check_order(std::span<const TimedLine> lines) {
  constexpr double seen_px = 0.3;  // smaller shifts are noise
  int compared = 0;
  int wrong = 0;
  for (std::size_t i = 2; i < lines.size(); ++i) {
    const auto next = moved_px(lines[i - 2].line, lines[i - 1].line);
    const auto next_but_one = moved_px(lines[i - 2].line, lines[i].line);
    if (!next || !next_but_one || std::max(*next, *next_but_one) < seen_px) continue;
    ++compared;
    wrong += *next_but_one < 0.7 * *next ? 1 : 0;
  }
  if (compared < 10 || 10 * wrong <= compared) return {};
  return fail(
      Fault::bad_input,
      "frames are not in the order in which they were taken: {} of {} times the line is back "
      "where it was two frames before",
      wrong, compared);
}

// A motor that stands for long, once or a few times within a turn, is stuck; in stop-and-shoot it
// stands for every frame.
Result<void> check_motor(std::span<const YawReading> readings, std::span<const double> yaw_rad) {
  const auto [low, high] = std::minmax_element(yaw_rad.begin(), yaw_rad.end());
  const double counts = (*high - *low) / yaw_count_rad;
  const double span_s = readings.back().time_s - readings.front().time_s;
  const double long_s = std::max(0.7, 8.0 * span_s / std::max(1.0, counts));
  int stops = 0;
  std::size_t first = 0;
  std::size_t stop_from = 0;
  std::size_t stop_to = 0;
  for (std::size_t i = 1; i <= readings.size(); ++i) {
    const bool moved =
        i == readings.size() ||
        std::abs(readings[i].yaw_rad - readings[first].yaw_rad) > 1.5 * yaw_count_rad;
    if (!moved) continue;
    const double yaw = readings[first].yaw_rad;
    const bool within = yaw > *low + 3.0 * yaw_count_rad && yaw < *high - 3.0 * yaw_count_rad;
    if (within && readings[i - 1].time_s - readings[first].time_s > long_s) {
      ++stops;
      stop_from = first;
      stop_to = i - 1;
    }
    first = i;
  }
  if (stops == 0 || stops > 3) return {};
  return fail(
      Fault::bad_input,
      "the motor stood still at {:.1f} degrees from {:.2f} to {:.2f} s within the turn: it is "
      "stalled or skips",
      to_deg(readings[stop_from].yaw_rad), readings[stop_from].time_s, readings[stop_to].time_s);
}

// A turn is even: between two readings the yaw moves as far as the time between them allows, give
// or take the motor's counts. A gear that slips, or a wrong byte, leaves a jump, and what is seen
// after it would lie beside what was seen before.
Result<void> check_skips(std::span<const YawReading> readings) {
  constexpr double window_s = 0.1;
  constexpr double rounding_rad = 3.0 * yaw_count_rad;
  std::vector<double> speeds;
  std::size_t from = 0;
  const auto each_window = [&](auto&& look) {
    from = 0;
    for (std::size_t i = 1; i < readings.size(); ++i) {
      while (from + 1 < i && readings[i].time_s - readings[from].time_s > window_s) ++from;
      const double apart_s = readings[i].time_s - readings[from].time_s;
      if (!look(readings[from], readings[i], apart_s)) return;
    }
  };
  each_window([&](const YawReading& a, const YawReading& b, double apart_s) {
    if (apart_s > 0.5 * window_s) speeds.push_back(std::abs(b.yaw_rad - a.yaw_rad) / apart_s);
    return true;
  });
  if (speeds.size() < 10) return {};
  // In stop and shoot the unit turns in a part of the time only, and in steps.
  const auto high = speeds.begin() + static_cast<std::ptrdiff_t>(speeds.size() * 9 / 10);
  std::nth_element(speeds.begin(), high, speeds.end());
  const double usual_rad_per_s = *high;
  Result<void> good;
  each_window([&](const YawReading& a, const YawReading& b, double apart_s) {
    const double turned_rad = std::abs(b.yaw_rad - a.yaw_rad);
    if (turned_rad <= 1.5 * usual_rad_per_s * apart_s + rounding_rad) return true;
    good =
        fail(Fault::bad_input,
             "the yaw jumps by {:.1f} degrees in {:.3f} s, from {:.1f} degrees at {:.2f} s, where "
             "the unit turns by {:.1f} degrees per second: the motor skips",
             to_deg(turned_rad), apart_s, to_deg(a.yaw_rad), a.time_s, to_deg(usual_rad_per_s));
    return false;
  });
  return good;
}

}  // namespace

Result<void> check_sequence(std::span<const TimedLine> lines, std::span<const YawReading> readings,
                            std::span<const double> yaw_rad, double max_lost_share) {
  if (lines.size() < 4) return {};
  const std::size_t turn = turning_point(lines, yaw_rad).value_or(0);
  if (auto good = check_lost(lines, turn, max_lost_share); !good) return good;
  if (auto good = check_order(lines); !good) return good;
  if (auto good = check_motor(readings, yaw_rad); !good) return good;
  return check_skips(readings);
}

}  // namespace tuina::scanner
