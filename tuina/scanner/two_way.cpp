// SPDX-License-Identifier: Apache-2.0
#include "tuina/scanner/two_way.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>

#include "tuina/core/decompositions.hpp"
#include "tuina/core/units.hpp"
#include "tuina/scanner/triangulation.hpp"

namespace tuina::scanner {
namespace {

constexpr float unlit = -1.0F;
constexpr double max_distance_px = 6.0;  // maximum difference of the same place between the ways

// One row of one frame of the way back against the way forth at the same yaw.
struct Sample {
  std::size_t pair = 0;        // index of the frame on the way back
  double difference_px = 0.0;  // column forth minus column back
  double px_per_rad = 0.0;     // derivative of the column by yaw
  double px_per_m = 0.0;       // derivative by motion of the person towards the scanner
  double weight = 0.0;
};

struct Pair {
  double forth_s = 0.0;
  double back_s = 0.0;
  std::size_t line = 0;
};

std::vector<float> columns_of(const LaserLine& line, int rows) {
  std::vector<float> columns(static_cast<std::size_t>(rows), unlit);
  for (const LinePoint& point : line.points) {
    if (point.row >= 0 && point.row < rows) {
      columns[static_cast<std::size_t>(point.row)] = point.column_px;
    }
  }
  return columns;
}

// Derivative of the line column when the surface approaches by a metre.
double px_per_m_towards(const ScannerCalibration& calibration, double column_px, double row) {
  const auto here = triangulate(calibration, column_px, row);
  const auto next = triangulate(calibration, column_px + 0.5, row);
  if (!here || !next) return 0.0;
  const double nearer_m = here->z() - next->z();
  return nearer_m != 0.0 ? 0.5 / nearer_m : 0.0;
}

struct Comparison {
  std::vector<Pair> pairs;
  std::vector<Sample> samples;
};

Comparison samples_of(std::span<const TimedLine> lines, std::span<const double> yaw_rad,
                      std::size_t turn, const ScannerCalibration& calibration) {
  Comparison comparison;
  const int rows = calibration.camera.height_px;
  std::vector<std::vector<float>> forth;
  for (std::size_t i = 0; i < turn; ++i) forth.push_back(columns_of(lines[i].line, rows));
  const double direction = yaw_rad[turn - 1] > yaw_rad[0] ? 1.0 : -1.0;
  for (std::size_t i = turn; i < lines.size(); ++i) {
    // Frames of the way forth on both sides of this yaw, which rises monotonically along it.
    const auto after = static_cast<std::size_t>(
        std::lower_bound(yaw_rad.begin(), yaw_rad.begin() + static_cast<std::ptrdiff_t>(turn),
                         yaw_rad[i],
                         [&](double a, double b) { return direction * a < direction * b; }) -
        yaw_rad.begin());
    if (after == 0 || after >= turn) continue;
    const std::size_t before = after - 1;
    const double step_rad = yaw_rad[after] - yaw_rad[before];
    if (std::abs(step_rad) < 1e-6) continue;
    const double part = (yaw_rad[i] - yaw_rad[before]) / step_rad;
    const Pair pair{
        .forth_s = lines[before].time_s + part * (lines[after].time_s - lines[before].time_s),
        .back_s = lines[i].time_s,
        .line = i};
    const Transform couch_from_camera = calibration.couch_from_camera_at(yaw_rad[i]);
    for (const LinePoint& seen : lines[i].line.points) {
      if (seen.row % 4 != 0 || seen.row < 0 || seen.row >= rows)
        continue;  // every fourth row suffices
      const auto row = static_cast<std::size_t>(seen.row);
      const float a = forth[before][row];
      const float b = forth[after][row];
      if (a == unlit || b == unlit || std::abs(b - a) > 4.0F) continue;
      const double column = static_cast<double>(a) + part * static_cast<double>(b - a);
      const double difference = column - static_cast<double>(seen.column_px);
      if (std::abs(difference) > max_distance_px) continue;
      const auto point = triangulate(calibration, column, seen.row);
      if (!point || (couch_from_camera * *point).z() < breathing_from_m) continue;
      comparison.samples.push_back({.pair = comparison.pairs.size(),
                                    .difference_px = difference,
                                    .px_per_rad = static_cast<double>(b - a) / step_rad,
                                    .px_per_m = px_per_m_towards(calibration, column, seen.row),
                                    .weight = 1.0});
    }
    comparison.pairs.push_back(pair);
  }
  return comparison;
}

struct Fit {
  double turn_rad = 0.0;  // yaw offset between the ways
  double turn_deviation_rad = 0.0;
  double own_share = 0.0;       // share of the yaw effect that no motion of the person explains
  std::vector<double> moved_m;  // motion of the person between forth and back, per pair
  std::vector<double> weight;   // per pair
};

// difference = px_per_rad * turn + px_per_m * moved(pair): the unknowns of the pairs are
// eliminated, the common turn remains.
Fit fit(Comparison& comparison) {
  Fit fit;
  const std::size_t n = comparison.pairs.size();
  for (int round = 0; round < 4; ++round) {
    std::vector<double> cc(n), cg(n), cr(n);
    double gg = 0.0, gr = 0.0;
    for (const Sample& s : comparison.samples) {
      cc[s.pair] += s.weight * s.px_per_m * s.px_per_m;
      cg[s.pair] += s.weight * s.px_per_m * s.px_per_rad;
      cr[s.pair] += s.weight * s.px_per_m * s.difference_px;
      gg += s.weight * s.px_per_rad * s.px_per_rad;
      gr += s.weight * s.px_per_rad * s.difference_px;
    }
    const double all_gg = gg;
    for (std::size_t k = 0; k < n; ++k) {
      if (cc[k] <= 0.0) continue;
      gg -= cg[k] * cg[k] / cc[k];
      gr -= cg[k] * cr[k] / cc[k];
    }
    fit.turn_rad = gg > 0.0 ? gr / gg : 0.0;
    fit.own_share = all_gg > 0.0 ? gg / all_gg : 0.0;
    fit.moved_m.assign(n, 0.0);
    for (std::size_t k = 0; k < n; ++k) {
      if (cc[k] > 0.0) fit.moved_m[k] = (cr[k] - cg[k] * fit.turn_rad) / cc[k];
    }
    fit.weight = cc;
    // Robust weights: edges and specks have large residuals.
    std::vector<double> residuals;
    residuals.reserve(comparison.samples.size());
    for (const Sample& s : comparison.samples) {
      residuals.push_back(std::abs(s.difference_px - s.px_per_rad * fit.turn_rad -
                                   s.px_per_m * fit.moved_m[s.pair]));
    }
    if (residuals.empty()) break;
    auto sorted = residuals;
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    std::nth_element(sorted.begin(), middle, sorted.end());
    const double scale = std::max(1e-3, 1.4826 * *middle);
    for (std::size_t i = 0; i < residuals.size(); ++i) {
      const double u = residuals[i] / (3.0 * scale);
      comparison.samples[i].weight = u < 1.0 ? (1.0 - u * u) * (1.0 - u * u) : 0.0;
    }
    fit.turn_deviation_rad = gg > 0.0 ? scale / std::sqrt(gg) : 0.0;
  }
  return fit;
}

struct Sine {
  double cosine_m = 0.0, sine_m = 0.0, hz = 0.0;
  double explained = 0.0;  // share of the motion between the ways
  [[nodiscard]] double at(double time_s) const {
    const double phase = 2.0 * pi * hz * time_s;
    return cosine_m * std::cos(phase) + sine_m * std::sin(phase);
  }
  [[nodiscard]] double amplitude_m() const { return std::hypot(cosine_m, sine_m); }
};

// Fits the breath as a sine from its differences between the two times of each pair, over 7 to 36
// breaths per minute.
Sine fit_breath(const std::vector<Pair>& pairs, const Fit& fit) {
  Sine best;
  double all2 = 0.0;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    all2 += fit.weight[k] * fit.moved_m[k] * fit.moved_m[k];
  }
  for (int step = 24; step < 120; ++step) {
    const double hz = 0.005 * step;
    Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
    Eigen::Vector2d rhs = Eigen::Vector2d::Zero();
    const auto row_of = [hz](const Pair& pair) {
      const double forth = 2.0 * pi * hz * pair.forth_s;
      const double back = 2.0 * pi * hz * pair.back_s;
      return Eigen::Vector2d(std::cos(forth) - std::cos(back), std::sin(forth) - std::sin(back));
    };
    for (std::size_t k = 0; k < pairs.size(); ++k) {
      const Eigen::Vector2d row = row_of(pairs[k]);
      normal += fit.weight[k] * row * row.transpose();
      rhs += fit.weight[k] * fit.moved_m[k] * row;
    }
    // Regularised: what the pairs hardly determine becomes zero.
    const Eigen::Matrix2d damped = normal + 3e-3 * normal.trace() * Eigen::Matrix2d::Identity();
    const Eigen::Vector2d found = solve_symmetric(damped, rhs);
    const double explained = all2 > 0.0 ? found.dot(rhs) / all2 : 0.0;
    if (explained > best.explained) best = {found.x(), found.y(), hz, explained};
  }
  return best;
}

}  // namespace

std::optional<std::size_t> turning_point(std::span<const TimedLine> lines,
                                         std::span<const double> yaw_rad) {
  if (yaw_rad.size() < 3) return {};
  std::size_t turn = 0;
  for (std::size_t i = 0; i < yaw_rad.size(); ++i) {
    if (std::abs(yaw_rad[i] - yaw_rad[0]) > std::abs(yaw_rad[turn] - yaw_rad[0])) turn = i;
  }
  const double forth_rad = std::abs(yaw_rad[turn] - yaw_rad[0]);
  const double back_rad = std::abs(yaw_rad[turn] - yaw_rad.back());
  if (turn < 2 || back_rad < 0.5 * forth_rad || back_rad < 1.0_deg) return {};
  // The last frame forth and the first one back have the same yaw, with a pause between.
  std::size_t first_back = turn + 1;
  const auto pause_s = [&](std::size_t i) { return lines[i].time_s - lines[i - 1].time_s; };
  for (const std::size_t i : {turn, turn + 2}) {
    if (i < lines.size() && pause_s(i) > 1.5 * pause_s(first_back)) first_back = i;
  }
  return first_back;
}

TwoWay compare_ways(std::span<const TimedLine> lines, std::span<const double> yaw_rad,
                    std::size_t turn, const ScannerCalibration& calibration) {
  TwoWay two;
  two.breath_at_m.assign(lines.size(), 0.0);
  Comparison comparison = samples_of(lines, yaw_rad, turn, calibration);
  if (comparison.samples.size() < 1000) return two;
  const Fit found = fit(comparison);
  // A latency error makes the yaw late on the way forth and early on the way back.
  const double forth_rad_per_s =
      (yaw_rad[turn - 1] - yaw_rad[0]) / (lines[turn - 1].time_s - lines[0].time_s);
  const double back_rad_per_s =
      (yaw_rad.back() - yaw_rad[turn]) / (lines.back().time_s - lines[turn].time_s);
  const double apart_rad_per_s = forth_rad_per_s - back_rad_per_s;
  two.compared.latency_error_s = -found.turn_rad / apart_rad_per_s;
  two.compared.latency_deviation_s = std::abs(found.turn_deviation_rad / apart_rad_per_s);

  // On a flat wall a turn and a step look alike (share 0.02; backs have 0.2 and more); then neither
  // is estimated.
  constexpr double min_own_share = 0.08;
  if (found.own_share < min_own_share) {
    two.compared.latency_error_s = 0.0;
    return two;
  }
  const Sine breath = fit_breath(comparison.pairs, found);
  constexpr double min_breath_m = 0.2_mm;
  constexpr double max_breath_m = 15.0_mm;
  const bool breathes = breath.explained > 0.6 && breath.amplitude_m() > min_breath_m &&
                        breath.amplitude_m() < max_breath_m;
  if (breathes) {
    two.compared.breath_m = 2.0 * breath.amplitude_m();
    two.compared.breath_hz = breath.hz;
    for (std::size_t i = 0; i < lines.size(); ++i) {
      two.breath_at_m[i] = breath.at(lines[i].time_s) + breath.amplitude_m();
    }
  }
  double before2 = 0.0, after2 = 0.0, weights = 0.0;
  for (std::size_t k = 0; k < comparison.pairs.size(); ++k) {
    const Pair& pair = comparison.pairs[k];
    const double moved_m = found.moved_m[k];
    const double left_m =
        breathes ? moved_m - breath.at(pair.forth_s) + breath.at(pair.back_s) : moved_m;
    before2 += found.weight[k] * moved_m * moved_m;
    after2 += found.weight[k] * left_m * left_m;
    weights += found.weight[k];
  }
  if (weights > 0.0) {
    two.compared.disagreement_m = std::sqrt(before2 / weights);
    two.compared.remaining_m = std::sqrt(after2 / weights);
  }
  return two;
}

}  // namespace tuina::scanner
