// SPDX-License-Identifier: Apache-2.0
#include "tuina/baselines/model_fits.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cassert>
#include <cmath>

#include "tuina/tissue/tangent_model.hpp"

namespace tuina::baselines {

using namespace tissue;
namespace {

using Parameters = Eigen::Vector4d;  // three of the law, as logarithms where positive; contact

struct LawShape {
  const char* name;
  int parameters;  // of the law, without the contact
  Parameters start;
};

// Depths of a centimetre and forces of tens of newtons; the damping starts at none.
LawShape shape_of(TissueLaw law) {
  switch (law) {
    case TissueLaw::linear:
      return {"linear", 1, {std::log(1e3), 0.0, 0.0, 0.0}};
    case TissueLaw::quadratic:
      return {"quadratic", 1, {std::log(1e5), 0.0, 0.0, 0.0}};
    case TissueLaw::hertz:
      return {"Hertz", 1, {std::log(1e4), 0.0, 0.0, 0.0}};
    case TissueLaw::exponential:
      return {"exponential", 2, {std::log(1.0), std::log(300.0), 0.0, 0.0}};
    case TissueLaw::tangent:
      return {"tangent", 2, {std::log(5.6), std::log(150.0), 0.0, 0.0}};
    case TissueLaw::kelvin_voigt:
      return {"Kelvin-Voigt", 2, {std::log(1e3), 0.0, 0.0, 0.0}};
    case TissueLaw::hunt_crossley:
      return {"Hunt-Crossley", 3, {std::log(1e5), std::log(2.0), 0.0, 0.0}};
  }
  return {};
}

double force_of(TissueLaw law, const Parameters& p, double position_m, double speed) {
  const double x = position_m - p(3);
  if (x <= 0.0) return 0.0;
  switch (law) {
    case TissueLaw::linear:
      return std::exp(p(0)) * x;
    case TissueLaw::quadratic:
      return std::exp(p(0)) * x * x;
    case TissueLaw::hertz:
      return std::exp(p(0)) * std::pow(x, 1.5);
    case TissueLaw::exponential:
      return std::exp(p(0)) * std::expm1(std::min(50.0, std::exp(p(1)) * x));
    case TissueLaw::tangent:
      return force_at_depth({std::exp(p(0)), std::exp(p(1))}, x);
    case TissueLaw::kelvin_voigt:
      return std::exp(p(0)) * x + p(1) * speed;
    case TissueLaw::hunt_crossley:
      return std::exp(p(0)) * std::pow(x, std::exp(p(1))) * (1.0 + p(2) * speed);
  }
  return 0.0;
}

std::vector<double> speeds_of(std::span<const TimedPress> record) {
  // Over ten samples to each side, so that the noise of the position hardly counts.
  std::vector<double> speeds(record.size());
  for (std::size_t i = 0; i < record.size(); ++i) {
    const TimedPress& before = record[i < 10 ? 0 : i - 10];
    const TimedPress& after = record[std::min(record.size() - 1, i + 10)];
    speeds[i] = (after.press.depth_m - before.press.depth_m) / (after.time_s - before.time_s);
  }
  return speeds;
}

}  // namespace

const char* name_of(TissueLaw law) noexcept {
  return shape_of(law).name;
}

LawFit fit_law(std::span<const TimedPress> record, TissueLaw law) {
  assert(record.size() >= 10);
  const LawShape shape = shape_of(law);
  const std::vector<double> speeds = speeds_of(record);
  const auto free = [&](int k) { return k == 3 || k < shape.parameters; };
  const auto cost_of = [&](const Parameters& p) {
    double cost = 0.0;
    for (std::size_t i = 0; i < record.size(); ++i) {
      const Press& press = record[i].press;
      cost += std::pow(press.force_n - force_of(law, p, press.depth_m, speeds[i]), 2);
    }
    return cost;
  };
  Parameters at = shape.start;
  double cost = cost_of(at), damping = 1e-2;
  for (int iteration = 0; iteration < 200 && damping < 1e12; ++iteration) {
    Eigen::Matrix4d information = Eigen::Matrix4d::Zero();
    Parameters pull = Parameters::Zero();
    for (std::size_t i = 0; i < record.size(); ++i) {
      const Press& press = record[i].press;
      const double force_n = force_of(law, at, press.depth_m, speeds[i]);
      Parameters slope = Parameters::Zero();
      for (int k = 0; k < 4; ++k) {
        if (!free(k)) continue;
        const double h = k == 3 ? 1e-8 : 1e-6;
        Parameters beside = at;
        beside(k) += h;
        slope(k) = (force_of(law, beside, press.depth_m, speeds[i]) - force_n) / h;
      }
      information += slope * slope.transpose();
      pull += slope * (press.force_n - force_n);
    }
    for (int k = 0; k < 4; ++k) {
      information(k, k) = free(k) ? information(k, k) * (1.0 + damping) + 1e-12 : 1.0;
    }
    const Parameters to = at + information.ldlt().solve(pull);
    const double there = to.allFinite() ? cost_of(to) : cost;
    if (there < cost) {
      const bool settled = cost - there < 1e-10 * cost;
      at = to;
      cost = there;
      damping = std::max(1e-9, 0.2 * damping);
      if (settled) break;
    } else {
      damping *= 5.0;
    }
  }
  const double n = static_cast<double>(record.size());
  LawFit fit{.contact_m = at(3), .rmse_n = std::sqrt(cost / n)};
  fit.aic = n * std::log(cost / n) + 2.0 * (shape.parameters + 1);
  fit.parameters = {std::exp(at(0)), law == TissueLaw::kelvin_voigt ? at(1) : std::exp(at(1)),
                    at(2)};
  return fit;
}

}  // namespace tuina::baselines
