// SPDX-License-Identifier: Apache-2.0
#include "tuina/tissue/curve_fit.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <optional>

#include "tuina/core/units.hpp"
#include "tuina/tissue/tangent_model.hpp"

namespace tuina::tissue {
namespace {

using Parameters = Eigen::Vector4d;  // ln alpha, ln beta, contact, offset
using Normal = Eigen::Matrix4d;

constexpr std::size_t min_samples = 20;
constexpr std::size_t max_samples = 30000;  // fitted in half a second
constexpr double min_touch_n = 1.0;
constexpr double steepest_angle = tangent_limit * pi / 2.0;
constexpr double robust_limit = 4.0;
constexpr int first_steps = 60, best_steps = 1000;  // from each start, and from the best of them

struct Foot {
  double residual;      // signed distance to the curve, in standard deviations
  Parameters gradient;  // of the residual
};

/// Foot point on the curve. There the distance is stationary along the curve, so its gradient is
/// that of the foot point projected onto the normal.
Foot foot_of(const Press& sample, const Parameters& p, const SensorNoise& noise) {
  const double alpha = std::exp(p(0)), beta = std::exp(p(1));
  const double sx = noise.position_m, sf = noise.force_n;
  const double x = (sample.depth_m - p(2)) / sx, y = (sample.force_n - p(3)) / sf;
  const double to_x = 1.0 / (beta * sx), to_y = alpha / sf;  // curve: (to_x angle, to_y tan(angle))
  // Start from the variable that is better determined here.
  const double by_force = std::atan(std::max(0.0, y) / to_y);
  const double slope_there = to_y / to_x * (1.0 + std::pow(std::max(0.0, y) / to_y, 2));
  double angle = slope_there > 1.0 ? by_force : std::clamp(x / to_x, 0.0, steepest_angle);
  for (int i = 0; i < 4; ++i) {
    const double tangent = std::tan(angle), secant2 = 1.0 + tangent * tangent;
    const double ex = to_x * angle - x, ey = to_y * tangent - y;
    const double first = ex * to_x + ey * to_y * secant2;
    const double gauss = to_x * to_x + to_y * to_y * secant2 * secant2;
    const double second = gauss + 2.0 * ey * to_y * secant2 * tangent;
    angle = std::clamp(angle - first / std::max(second, 0.5 * gauss), 0.0, steepest_angle);
  }
  const double tangent = std::tan(angle), secant2 = 1.0 + tangent * tangent;
  const double off_curve2 = std::pow(to_x * angle - x, 2) + std::pow(to_y * tangent - y, 2);
  // Above the skin the curve is the line of zero force.
  if (x < 0.0 && y * y <= off_curve2) return {y, Parameters(0.0, 0.0, 0.0, -1.0 / sf)};
  const double a = to_x, b = to_y * secant2, length = std::hypot(a, b);
  const double nx = -b / length, ny = a / length;
  return {nx * (x - to_x * angle) + ny * (y - to_y * tangent),
          -Parameters(ny * to_y * tangent, -nx * to_x * angle, nx / sx, ny / sf)};
}

struct Linearised {
  Normal information = Normal::Zero();
  Parameters pull = Parameters::Zero();
  double cost = 0.0;
};

Linearised linearise(std::span<const TimedPress> record, const Parameters& p,
                     const SensorNoise& noise) {
  Linearised sum;
  for (const TimedPress& sample : record) {
    const Foot foot = foot_of(sample.press, p, noise);
    const double far = std::abs(foot.residual);
    const double weight = far > robust_limit ? robust_limit / far : 1.0;
    sum.information += weight * foot.gradient * foot.gradient.transpose();
    sum.pull -= weight * foot.residual * foot.gradient;
    sum.cost += far > robust_limit ? robust_limit * (2.0 * far - robust_limit) : far * far;
  }
  return sum;
}

Parameters within_reason(Parameters p) {
  p(0) = std::clamp(p(0), std::log(0.05), std::log(1000.0));
  p(1) = std::clamp(p(1), std::log(min_beta_per_m), std::log(max_beta_per_m));
  return p;
}

struct Solution {
  Parameters at;
  Linearised sum;
  bool settled = false;
};

/// Levenberg-Marquardt from one start, so many steps at most.
Solution descend(std::span<const TimedPress> record, const SensorNoise& noise,
                 const Parameters& start, int max_steps) {
  Solution best{within_reason(start), {}};
  best.sum = linearise(record, best.at, noise);
  double damping = 1e-3;
  for (int i = 0; i < max_steps && !best.settled; ++i) {
    Normal damped = best.sum.information;
    damped.diagonal() *= 1.0 + damping;
    damped.diagonal().array() += 1e-12;
    const Parameters step = damped.ldlt().solve(best.sum.pull);
    if (!step.allFinite()) break;
    const Parameters to = within_reason(best.at + step);
    const Linearised there = linearise(record, to, noise);
    if (there.cost < best.sum.cost) {
      best = {to, there, best.sum.cost - there.cost < 1e-9 * best.sum.cost};
      damping = std::max(1e-9, damping * 0.2);
    } else {
      damping *= 8.0;
      best.settled = damping > 1e9;
    }
  }
  return best;
}

/// Force in free air: the level on which the shallow half of the positions agrees.
double free_air_force(std::span<const TimedPress> record) {
  double low_m = record.front().press.depth_m, high_m = low_m;
  for (const TimedPress& s : record) {
    low_m = std::min(low_m, s.press.depth_m);
    high_m = std::max(high_m, s.press.depth_m);
  }
  std::vector<double> shallow;
  for (const TimedPress& s : record) {
    if (s.press.depth_m <= low_m + 0.1 * (high_m - low_m)) shallow.push_back(s.press.force_n);
  }
  const auto middle = shallow.begin() + static_cast<long>(shallow.size() / 2);
  std::nth_element(shallow.begin(), middle, shallow.end());
  return *middle;
}

/// Evenly spaced samples of a long record: more know alpha and beta no better than the law holds.
std::vector<TimedPress> thinned(std::vector<TimedPress> record) {
  const std::size_t stride = (record.size() + max_samples - 1) / max_samples;
  if (stride < 2) return record;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < record.size(); i += stride) record[kept++] = record[i];
  record.resize(kept);
  return record;
}

/// Samples per independent error: one plus twice the sum of the autocorrelation.
double correlation_length(std::span<const double> residuals) {
  const std::size_t n = residuals.size();
  double power = 0.0;
  for (const double r : residuals) power += r * r;
  double length = 1.0;
  for (std::size_t lag = 1; lag < std::min<std::size_t>(n / 4, 500) && power > 0.0; ++lag) {
    double sum = 0.0;
    for (std::size_t i = lag; i < n; ++i) sum += residuals[i] * residuals[i - lag];
    if (sum < 0.02 * power) break;
    length += 2.0 * sum / power;
  }
  return length;
}

}  // namespace

Result<CurveFit> fit_curve(std::span<const TimedPress> raw, const SensorNoise& noise) {
  const std::vector<TimedPress> record = thinned(without_saturation(raw, noise));
  if (record.size() < min_samples) {
    return fail(Fault::bad_input, "{} usable samples, {} needed", record.size(), min_samples);
  }
  const double air_n = free_air_force(record);
  const double touching_n = std::max(min_touch_n, 5.0 * noise.force_n);
  double peak_n = -1e300, deepest_m = 0.0, first_m = 1e300;
  std::size_t touching = 0;
  for (const TimedPress& s : record) {
    const double force_n = s.press.force_n - air_n;
    if (force_n > peak_n) {
      peak_n = force_n;
      deepest_m = s.press.depth_m;
    }
    if (force_n > touching_n) {
      ++touching;
      first_m = std::min(first_m, s.press.depth_m);
    }
  }
  if (touching < min_samples) {
    return fail(Fault::not_found,
                "no contact found: {} samples above {:.2f} N, {} needed; the noise of the force "
                "counts as {:.2f} N, say so if it is less",
                touching, touching_n, min_samples, noise.force_n);
  }

  std::optional<Solution> best;
  for (const double alpha : {2.0, 6.0, 18.0, 60.0}) {
    // The first force seen lies a little below the skin; the peak then gives beta for this alpha.
    const double span_m = std::max(deepest_m - first_m, 2e-5);
    const double beta = (std::atan(peak_n / alpha) - std::atan(touching_n / alpha)) / span_m;
    const double contact_m = first_m - std::atan(touching_n / alpha) / beta;
    const Solution found = descend(
        record, noise, Parameters(std::log(alpha), std::log(beta), contact_m, air_n), first_steps);
    if (!best || found.sum.cost < best->sum.cost) best = found;
  }
  // A record without free air has a long flat valley, where alpha and the zero of the force hardly
  // differ in what they do.
  if (!best->settled) best = descend(record, noise, best->at, best_steps);

  CurveFit fit;
  fit.tissue = {std::exp(best->at(0)), std::exp(best->at(1))};
  fit.contact_m = best->at(2);
  fit.offset_n = best->at(3);
  fit.peak_force_n = peak_n;
  fit.samples = static_cast<int>(record.size());
  fit.settled = best->settled;
  std::vector<double> residuals;
  double squares = 0.0, count = 0.0;
  for (const TimedPress& s : record) {
    residuals.push_back(foot_of(s.press, best->at, noise).residual);
    const double tared_n = s.press.force_n - fit.offset_n;
    if (tared_n <= min_touch_n) continue;
    squares += std::pow(tared_n - force_at_depth(fit.tissue, s.press.depth_m - fit.contact_m), 2);
    count += 1.0;
  }
  fit.rmse_n = count > 0.0 ? std::sqrt(squares / count) : 0.0;
  fit.reduced_chi_square = best->sum.cost / std::max(1.0, static_cast<double>(record.size()) - 4.0);
  Normal information = best->sum.information;
  information.diagonal().array() += 1e-9;  // keeps undetermined directions finite
  const Normal covariance = information.ldlt().solve(Normal::Identity());
  const double scale =
      1.96 * std::sqrt(std::max(1.0, fit.reduced_chi_square) * correlation_length(residuals));
  fit.alpha_ci95_n = scale * fit.tissue.alpha_n * std::sqrt(std::max(0.0, covariance(0, 0)));
  fit.beta_ci95_per_m = scale * fit.tissue.beta_per_m * std::sqrt(std::max(0.0, covariance(1, 1)));
  fit.contact_ci95_m = scale * std::sqrt(std::max(0.0, covariance(2, 2)));
  return fit;
}

}  // namespace tuina::tissue
