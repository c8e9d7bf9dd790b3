// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "tuina/core/decompositions.hpp"
#include "tuina/core/units.hpp"
#include "tuina/scanner/sweep.hpp"

namespace tuina::scanner {
namespace {

constexpr double slack_s = 0.15;  // maximum time of a frame outside the readings
constexpr std::size_t enough_for_a_fit = 8;
constexpr double max_distance_rad = from_deg(360.0);
// No AX-12A turns faster than 114 rpm.
constexpr double max_speed_rad_per_s = from_deg(6.0 * 114.0);
constexpr double jitter_s = 0.01;  // jitter of the time stamps, and a few counts

struct Line {
  double at_s = 0.0;
  double yaw_rad = 0.0;
  double rad_per_s = 0.0;
  [[nodiscard]] double at(double time_s) const { return yaw_rad + rad_per_s * (time_s - at_s); }
};

// Weighted least squares of a straight line.
template <typename Weight>
Line fit(std::span<const YawReading> readings, Weight&& weight) {
  double w = 0.0;
  double t = 0.0;
  double y = 0.0;
  for (const YawReading& reading : readings) {
    const double wi = weight(reading.time_s);
    w += wi;
    t += wi * reading.time_s;
    y += wi * reading.yaw_rad;
  }
  t /= w;
  y /= w;
  double tt = 0.0;
  double ty = 0.0;
  for (const YawReading& reading : readings) {
    const double wi = weight(reading.time_s);
    tt += wi * (reading.time_s - t) * (reading.time_s - t);
    ty += wi * (reading.time_s - t) * (reading.yaw_rad - y);
  }
  return {t, y, tt > 0.0 ? ty / tt : 0.0};
}

std::span<const YawReading> between(std::span<const YawReading> readings, double from_s,
                                    double to_s) {
  const auto before = [](const YawReading& reading, double time_s) {
    return reading.time_s < time_s;
  };
  const auto first = std::lower_bound(readings.begin(), readings.end(), from_s, before);
  const auto last = std::lower_bound(first, readings.end(), to_s, before);
  return {first, last};
}

// True for residuals of rounding (up to half a count, 0.29 counts RMS) and a little clock jitter.
bool straight(std::span<const YawReading> readings, const Line& line) {
  double sum = 0.0;
  for (const YawReading& reading : readings) {
    const double error = reading.yaw_rad - line.at(reading.time_s);
    if (std::abs(error) > 0.8 * yaw_count_rad) return false;
    sum += error * error;
  }
  return std::sqrt(sum / static_cast<double>(readings.size())) < 0.36 * yaw_count_rad;
}

// Local parabola around one time, weighted by nearness, over several counts so that rounding
// averages out.
double local_yaw(std::span<const YawReading> readings, double time_s) {
  for (double half_s = 0.5;; half_s *= 1.3) {
    const auto near = between(readings, time_s - half_s, time_s + half_s);
    const bool all = near.size() == readings.size();
    if (near.size() < enough_for_a_fit && !all) continue;
    const double span_rad =
        near.empty() ? 0.0 : std::abs(near.back().yaw_rad - near.front().yaw_rad);
    if (span_rad < 4.0 * yaw_count_rad && half_s < 0.8 && !all) continue;
    Matrix3 sums = Matrix3::Zero();
    Vector3 moments = Vector3::Zero();
    for (const YawReading& reading : near) {
      const double u = std::clamp((reading.time_s - time_s) / half_s, -1.0, 1.0);
      const double weight = std::pow(1.0 - std::abs(u * u * u), 3) + 1e-6;
      const Vector3 place(1.0, u, u * u);
      sums += weight * place * place.transpose();
      moments += weight * reading.yaw_rad * place;
    }
    if (near.size() < enough_for_a_fit) sums(2, 2) += 1.0;  // with too few readings a straight line
    sums.diagonal().array() += 1e-9;
    return solve_symmetric(sums, moments)(0);
  }
}

// A uniform turn, or its two ways, each straight; else nothing.
struct EvenTurn {
  double until_s = 0.0;
  Line line;
};

std::vector<EvenTurn> even_turns(std::span<const YawReading> readings) {
  if (readings.size() < enough_for_a_fit) return {};
  constexpr double forever_s = std::numeric_limits<double>::infinity();
  const auto alike = [](double) { return 1.0; };
  const Line whole = fit(readings, alike);
  if (straight(readings, whole)) return {{forever_s, whole}};
  const auto farthest = std::max_element(readings.begin(), readings.end(),
                                         [&](const YawReading& a, const YawReading& b) {
                                           return std::abs(a.yaw_rad - readings.front().yaw_rad) <
                                                  std::abs(b.yaw_rad - readings.front().yaw_rad);
                                         });
  // At the turning point the motor may slow down, so readings within a count of it are ignored.
  const auto near_turn = [&](const YawReading& reading) {
    return std::abs(reading.yaw_rad - farthest->yaw_rad) < 1.5 * yaw_count_rad;
  };
  std::vector<YawReading> forth;
  std::vector<YawReading> back;
  for (const YawReading& reading : readings) {
    if (near_turn(reading)) continue;
    (reading.time_s < farthest->time_s ? forth : back).push_back(reading);
  }
  if (forth.size() < enough_for_a_fit || back.size() < enough_for_a_fit) return {};
  const Line there = fit(forth, alike);
  const Line here = fit(back, alike);
  if (!straight(forth, there) || !straight(back, here)) return {};
  const double meet_s = there.rad_per_s == here.rad_per_s
                            ? farthest->time_s
                            : (here.at(0.0) - there.at(0.0)) / (there.rad_per_s - here.rad_per_s);
  return {{meet_s, there}, {forever_s, here}};
}

// Stop and shoot: the motor is constant around each frame and differs between frames. Uniform turns
// change within the window if fast, and have many frames per count if slow. A few frames may be
// early or repeated.
std::optional<std::vector<double>> at_rest(std::span<const double> frame_times_s,
                                           std::span<const YawReading> readings, double latency_s) {
  constexpr double window_s = 0.03;
  constexpr double max_share = 0.05;
  const double most = max_share * static_cast<double>(frame_times_s.size());
  std::vector<double> yaw;
  int restless = 0;
  int stayed = 0;
  for (const double time_s : frame_times_s) {
    const double motor_s = time_s - latency_s;
    const auto near = between(readings, motor_s - window_s, motor_s + window_s);
    const bool rests = near.size() >= 2 && near.front().yaw_rad == near.back().yaw_rad;
    restless += rests ? 0 : 1;
    if (!yaw.empty() && rests) stayed += near.front().yaw_rad == yaw.back() ? 1 : 0;
    if (restless > most || stayed > most) return {};
    yaw.push_back(rests ? near[near.size() / 2].yaw_rad : local_yaw(readings, motor_s));
  }
  return yaw;
}

}  // namespace

Result<std::vector<double>> yaw_at(std::span<const double> frame_times_s,
                                   std::span<const YawReading> readings, double latency_s) {
  if (readings.size() < 2) {
    return fail(Fault::bad_input, "{} yaw readings, at least 2 are needed", readings.size());
  }
  for (std::size_t i = 0; i < readings.size(); ++i) {
    if (!std::isfinite(readings[i].time_s) || !std::isfinite(readings[i].yaw_rad)) {
      return fail(Fault::bad_input, "yaw reading {} is not finite", i);
    }
    if (i > 0 && readings[i].time_s < readings[i - 1].time_s) {
      return fail(Fault::bad_input, "yaw reading {} at {:.4f} s comes after one at {:.4f} s", i,
                  readings[i].time_s, readings[i - 1].time_s);
    }
    if (std::abs(readings[i].yaw_rad) > max_distance_rad) {
      return fail(Fault::bad_input, "yaw reading {} at {:.4f} s is {:.4g} deg; up to {:.0f} can be",
                  i, readings[i].time_s, to_deg(readings[i].yaw_rad), to_deg(max_distance_rad));
    }
    // A lost byte on the serial line gives an impossible reading, which would bend the cloud
    // unnoticed.
    if (i == 0) continue;
    const double turned_rad = std::abs(readings[i].yaw_rad - readings[i - 1].yaw_rad);
    const double max_rad =
        max_speed_rad_per_s * (readings[i].time_s - readings[i - 1].time_s + jitter_s);
    if (turned_rad > max_rad) {
      return fail(
          Fault::bad_input,
          "yaw reading {} at {:.4f} s is {:.2f} deg from the one before; the motor turns at "
          "most {:.2f} in that time",
          i, readings[i].time_s, to_deg(turned_rad), to_deg(max_rad));
    }
  }
  if (frame_times_s.empty()) return std::vector<double>{};

  const double first_s = readings.front().time_s + std::min(0.0, latency_s) - slack_s;
  const double last_s = readings.back().time_s + std::max(0.0, latency_s) + slack_s;
  for (std::size_t i = 0; i < frame_times_s.size(); ++i) {
    const double time_s = frame_times_s[i];
    if (!(time_s >= first_s && time_s <= last_s)) {
      return fail(
          Fault::bad_input,
          "frame {} at {:.3f} s lies outside the yaw readings, which last from {:.3f} to {:.3f} s",
          i, time_s, readings.front().time_s, readings.back().time_s);
    }
  }

  const auto [earliest, latest] = std::minmax_element(frame_times_s.begin(), frame_times_s.end());
  const auto turning = between(readings, *earliest - latency_s - 1e-9, *latest - latency_s + 1e-9);
  if (auto resting = at_rest(frame_times_s, readings, latency_s)) return *resting;
  const std::vector<EvenTurn> turns = even_turns(turning);
  std::vector<double> yaw;
  yaw.reserve(frame_times_s.size());
  for (const double time_s : frame_times_s) {
    const double motor_s = time_s - latency_s;
    const auto turn = std::find_if(turns.begin(), turns.end(),
                                   [motor_s](const EvenTurn& t) { return motor_s <= t.until_s; });
    yaw.push_back(turn != turns.end() ? turn->line.at(motor_s) : local_yaw(readings, motor_s));
  }
  return yaw;
}

}  // namespace tuina::scanner
