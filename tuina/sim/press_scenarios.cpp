// SPDX-License-Identifier: Apache-2.0
#include "tuina/sim/press_scenarios.hpp"

#include <algorithm>
#include <cmath>

#include "tuina/core/units.hpp"
#include "tuina/tissue/tangent_model.hpp"

namespace tuina::sim {
namespace {

constexpr double step_s = 1e-3;

std::vector<PressScenario> make_scenarios() {
  using Shape = PressScenario::Shape;
  using TissueModel = PressScenario::TissueModel;
  std::vector<PressScenario> all = {
      {.name = "N0", .about = "nominal"},
      {.name = "N0_half_force", .about = "half of the force", .force_share = 0.5},
      {.name = "N0_0.5Hz", .about = "a press in two seconds", .press_hz = 0.5},
      {.name = "N0_1.5Hz", .about = "three presses in two seconds", .press_hz = 1.5},
      {.name = "N0_sigmoid",
       .about = "sigmoid with a hold, 0.5 Hz",
       .shape = Shape::sigmoid,
       .press_hz = 0.5},
      {.name = "N1",
       .about = "poor sensors",
       .force_noise_n = 0.5,
       .position_noise_m = 0.1_mm,
       .contact_sd_m = 1_mm},
      {.name = "N1_half_force",
       .about = "poor sensors, half of the force",
       .force_noise_n = 0.5,
       .position_noise_m = 0.1_mm,
       .contact_sd_m = 1_mm,
       .force_share = 0.5},
      {.name = "N2", .about = "damped tissue", .damping_s_per_m = 5.0},
      {.name = "N3", .about = "breathing, 2 mm peak to peak", .breath_m = 1_mm},
      {.name = "N4", .about = "force bias", .force_bias_sd_n = 0.3},
      {.name = "N5", .about = "coloured position error", .position_correlation_s = 0.02},
      {.name = "N6",
       .about = "damping, breathing, bias and coloured error",
       .position_correlation_s = 0.02,
       .damping_s_per_m = 3.0,
       .breath_m = 0.5_mm,
       .force_bias_sd_n = 0.15},
      {.name = "N7", .about = "random tissue", .tissue_spread = 1.0},
      {.name = "light",
       .about = "pressed to one alpha only: must not converge",
       .force_share = -1.0},
      {.name = "quadratic",
       .about = "tissue of another law, F ~ d^2",
       .law = TissueModel::quadratic},
      {.name = "hertz", .about = "tissue of another law, F ~ d^1.5", .law = TissueModel::hertz},
      {.name = "exponential",
       .about = "tissue of another law, F ~ e^d - 1",
       .law = TissueModel::exponential},
  };
  PressScenario loop{.name = "L0",
                     .about = "by a robot: torso, delay, 3 N kept; no breath",
                     .shape = Shape::force,
                     .force_noise_n = 0.05,
                     .position_noise_m = 0.02_mm,
                     .contact_sd_m = 3_mm,
                     .tissue_spread = 1.0,
                     .force_delay_s = 2.6e-3,
                     .torso_n_per_m = 35e3,
                     .duration_s = 8.0};
  all.push_back(loop);
  loop.name = "L1", loop.about = "by a robot, breathing 3 mm peak to peak", loop.breath_m = 1.5_mm;
  all.push_back(loop);
  loop.name = "L2", loop.about = "by a robot, breathing 3 mm at 0.4 Hz", loop.breath_hz = 0.4;
  all.push_back(loop);
  loop.name = "L3", loop.about = "by a robot, breathing 3 mm, a press in two seconds",
  loop.breath_hz = 0.25;
  loop.press_hz = 0.5;
  all.push_back(loop);
  return all;
}

/// Force and depth of the tissue law; the other laws agree with the tangent law at the peak.
struct Law {
  PressScenario::TissueModel kind;
  TangentTissue tissue;
  double peak_m, peak_n;

  [[nodiscard]] double force(double depth_m) const {
    if (depth_m <= 0.0) return 0.0;
    const double share = depth_m / peak_m;
    switch (kind) {
      case PressScenario::TissueModel::tangent:
        return tissue::force_at_depth(tissue, depth_m);
      case PressScenario::TissueModel::quadratic:
        return peak_n * share * share;
      case PressScenario::TissueModel::hertz:
        return peak_n * std::pow(share, 1.5);
      case PressScenario::TissueModel::exponential:
        return peak_n * std::expm1(3.0 * share) / std::expm1(3.0);
    }
    return 0.0;
  }
};

/// One period of a press as a share of its peak: up over 30 %, hold, down over 30 %.
double sigmoid_press(double phase_s, double period_s) {
  const double rise_s = 0.3 * period_s;
  const auto sigmoid = [rise_s](double t) {
    return 1.0 / (1.0 + std::exp(-20.0 / rise_s * (t - rise_s / 2.0)));
  };
  return std::min(sigmoid(phase_s), sigmoid(period_s - phase_s));
}

/// A force controller that wanders about its target by about one newton.
struct ForcePress {
  double wander_n = 0.0;
  static constexpr double touch_s = 0.4, kept_n = 3.0, first_s = 0.9;

  double force(const PressScenario& s, double t, double peak_n, Random& random) {
    wander_n += -5.0 * step_s * wander_n + gaussian(random, 0.05);
    if (t < touch_s) return 0.0;
    if (t < touch_s + 0.1) return kept_n * (t - touch_s) / 0.1;
    const double period_s = 1.0 / s.press_hz;
    const double share =
        t < first_s ? 0.0 : sigmoid_press(std::fmod(t - first_s, period_s), period_s);
    return std::max(0.5, kept_n + (peak_n - kept_n) * share + wander_n);
  }
};

}  // namespace

const std::vector<PressScenario>& press_scenarios() {
  static const std::vector<PressScenario> all = make_scenarios();
  return all;
}

SimulatedPresses simulate_presses(const PressScenario& s, const TangentTissue& nominal,
                                  double peak_n, Random& random) {
  SimulatedPresses result;
  result.truth = {nominal.alpha_n * std::exp(gaussian(random, 0.15 * s.tissue_spread)),
                  nominal.beta_per_m * std::exp(gaussian(random, 0.08 * s.tissue_spread))};
  const double contact_m = gaussian(random, s.contact_sd_m),
               bias_n = gaussian(random, s.force_bias_sd_n);
  result.skin_m = contact_m;
  const double phase = uniform(random, 0.0, 2.0 * pi);
  peak_n = s.force_share < 0.0 ? -s.force_share * result.truth.alpha_n : s.force_share * peak_n;
  const double peak_m = tissue::depth_at_force(result.truth, peak_n);
  const Law law{s.law, result.truth, peak_m, peak_n};
  const double torso_m_per_n =
      s.torso_n_per_m > 0.0 ? (1.0 + uniform(random, -0.2, 0.2)) / s.torso_n_per_m : 0.0;

  // The press starts 1 mm and 2.5 standard deviations above the expected skin.
  const double above_m = 1_mm + 2.5 * s.contact_sd_m;
  const auto depth_of = [&](double t) {
    const double share = s.shape == PressScenario::Shape::sine
                             ? std::abs(std::sin(pi * s.press_hz * t))
                             : sigmoid_press(std::fmod(t, 1.0 / s.press_hz), 1.0 / s.press_hz);
    return -above_m - contact_m + (peak_m + above_m + contact_m) * share;
  };
  ForcePress controller;
  double coloured_m = 0.0;
  bool touched = false;
  const double memory =
      s.position_correlation_s > 0.0 ? std::exp(-step_s / s.position_correlation_s) : 0.0;
  std::vector<double> forces;
  for (int i = 0; i < static_cast<int>(s.duration_s / step_s); ++i) {
    const double t = i * step_s;
    const double skin_m =
        contact_m + s.breath_m * (std::sin(2.0 * pi * s.breath_hz * t + phase) - std::sin(phase));
    double position_m = 0.0, force_n = 0.0;
    if (s.shape == PressScenario::Shape::force) {
      force_n = controller.force(s, t, peak_n, random);
      const double in_m = force_n * torso_m_per_n + tissue::depth_at_force(result.truth, force_n);
      position_m = skin_m + (force_n > 0.0 ? in_m : -0.05 * (ForcePress::touch_s - t));
    } else {
      const double depth_m = depth_of(t), speed = (depth_of(t + 1e-6) - depth_m) / 1e-6;
      force_n = law.force(depth_m) * std::max(0.0, 1.0 + s.damping_s_per_m * speed);
      position_m = skin_m + depth_m;
    }
    if (!touched && force_n > 0.0) result.first_contact_s = t;
    touched = touched || force_n > 0.0;
    forces.push_back(force_n);
    // Sensor delay; between samples the true force is interpolated linearly.
    const double late = std::max(0.0, static_cast<double>(i) - s.force_delay_s / step_s);
    const auto before = static_cast<std::size_t>(late);
    const double share = late - static_cast<double>(before);
    const double felt_n =
        (1.0 - share) * forces[before] + share * forces[std::min(before + 1, forces.size() - 1)];
    coloured_m = memory * coloured_m +
                 gaussian(random, s.position_noise_m * std::sqrt(1.0 - memory * memory));
    result.record.push_back({t,
                             {.depth_m = position_m + coloured_m,
                              .force_n = felt_n + bias_n + gaussian(random, s.force_noise_n)}});
  }
  return result;
}

std::vector<tissue::TimedPress> simulate_thesis_presses(const TangentTissue& tissue,
                                                        double duration_s) {
  constexpr double M = 1.0, K = 100.0, h = 1e-3;
  const double D = 2.0 * 0.7 * std::sqrt(M * K);
  constexpr double w = 3.0 * pi, reach_m = 5_mm;
  struct State {
    double x, v;
  };
  // The target's speed jumps at the kinks of |sin|; the impulse of acceleration there is ignored.
  const auto slope = [&](double t, const State& y) {
    const double sine = std::sin(w * t), sign = sine >= 0.0 ? 1.0 : -1.0;
    const double x0 = reach_m * std::abs(sine), v0 = reach_m * w * std::cos(w * t) * sign;
    const double a0 = -w * w * x0;
    const double force_n = tissue.alpha_n * std::tan(tissue.beta_per_m * y.x);
    return State{y.v, a0 + (-force_n - D * (y.v - v0) - K * (y.x - x0)) / M};
  };
  const auto moved = [](const State& y, const State& k, double by) {
    return State{y.x + by * k.x, y.v + by * k.v};
  };
  std::vector<tissue::TimedPress> record;
  State y{0.0, 0.0};
  for (int i = 0; i < static_cast<int>(duration_s / h); ++i) {
    const double t = i * h, x = y.x;
    record.push_back(
        {t, {.depth_m = x, .force_n = tissue.alpha_n * std::tan(tissue.beta_per_m * x)}});
    const State k1 = slope(t, y), k2 = slope(t + h / 2, moved(y, k1, h / 2));
    const State k3 = slope(t + h / 2, moved(y, k2, h / 2)), k4 = slope(t + h, moved(y, k3, h));
    y.x += h / 6.0 * (k1.x + 2.0 * k2.x + 2.0 * k3.x + k4.x);
    y.v += h / 6.0 * (k1.v + 2.0 * k2.v + 2.0 * k3.v + k4.v);
  }
  return record;
}

}  // namespace tuina::sim
