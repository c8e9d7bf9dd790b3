// SPDX-License-Identifier: Apache-2.0
#include "tuina/sim/tissue_worlds.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "tuina/core/units.hpp"

namespace tuina::sim {
namespace {

constexpr double sample_s = 1e-3;
constexpr int substeps = 4;
constexpr double step_s = sample_s / substeps;
constexpr double force_noise_n = 0.2, position_noise_m = 0.05_mm;

/// The elastic force over depth, of the person's own form but as high as the tangent at 20 N.
class ElasticCurve {
 public:
  ElasticCurve(TissueWorld::Elastic kind, const TangentTissue& tissue, Random& random)
      : kind_(kind),
        tissue_(tissue),
        meeting_m_(std::atan(meeting_n / tissue.alpha_n) / tissue.beta_per_m) {
    using Elastic = TissueWorld::Elastic;
    // Exponents of Hunt and Crossley's law for tissue: 1.3 to 2.2.
    if (kind == Elastic::power) form_ = uniform(random, 1.3, 2.2);
    if (kind == Elastic::exponential) form_ = uniform(random, 2.0, 3.5);
    if (kind == Elastic::layers) tabulate_layers(random);
  }

  [[nodiscard]] double force(double depth_m) const {
    if (depth_m <= 0.0) return 0.0;
    const double share = depth_m / meeting_m_;
    switch (kind_) {
      case TissueWorld::Elastic::tangent: {
        // Near its pole the law goes on as a straight line.
        const double angle = tissue_.beta_per_m * depth_m, last = 0.97 * pi / 2.0;
        const double u = std::tan(std::min(angle, last));
        return tissue_.alpha_n * (u + (1.0 + u * u) * std::max(0.0, angle - last));
      }
      case TissueWorld::Elastic::power:
        return meeting_n * std::pow(share, form_);
      case TissueWorld::Elastic::exponential:
        return meeting_n * std::expm1(form_ * share) / std::expm1(form_);
      case TissueWorld::Elastic::layers: {
        const auto above = std::upper_bound(depths_m_.begin(), depths_m_.end(), depth_m);
        if (above == depths_m_.end()) return table_step_n * static_cast<double>(depths_m_.size());
        const auto k = static_cast<std::size_t>(above - depths_m_.begin());
        const double before_m = depths_m_[k - 1];
        return table_step_n *
               (static_cast<double>(k - 1) + (depth_m - before_m) / (*above - before_m));
      }
    }
    return 0.0;
  }

 private:
  static constexpr double meeting_n = 20.0, table_step_n = 0.1;

  // Fat that is used up first, muscle, and bone that hardly gives way, one behind the other.
  void tabulate_layers(Random& random) {
    const double fat_n = uniform(random, 2.5, 3.7), fat_m = uniform(random, 3_mm, 6_mm);
    const double bone_n_per_m = uniform(random, 30e3, 60e3);
    for (double force_n = 0.0; force_n < 150.0; force_n += table_step_n) {
      depths_m_.push_back(fat_m * 2.0 / pi * std::atan(force_n / fat_n) +
                          std::atan(force_n / tissue_.alpha_n) / tissue_.beta_per_m +
                          force_n / bone_n_per_m);
    }
  }

  TissueWorld::Elastic kind_;
  TangentTissue tissue_;
  double meeting_m_, form_ = 0.0;
  std::vector<double> depths_m_;
};

/// Relaxation in three decades.
struct Relaxation {
  static constexpr std::array<double, 3> tau_s = {0.1, 1.0, 10.0};
  std::array<double, 3> share = {}, force_n = {};

  Relaxation(double in_all, Random& random) {
    double sum = 0.0;
    for (double& part : share) sum += part = uniform(random, 0.2, 1.0);
    for (double& part : share) part *= in_all / sum;
  }
  /// The force left of an elastic one.
  double left(double elastic_n) {
    double left_n = elastic_n;
    for (std::size_t i = 0; i < tau_s.size(); ++i) {
      force_n[i] += step_s / tau_s[i] * (elastic_n - force_n[i]);
      left_n -= share[i] * force_n[i];
    }
    return left_n;
  }
};

/// Breaths of which no two are alike.
struct Breathing {
  double peak_to_peak_m, depth_m = 0.0, rate_hz = 0.25, phase = 0.0;

  Breathing(double peak_to_peak, Random& random)
      : peak_to_peak_m(peak_to_peak), phase(uniform(random, 0.0, 1.0)) {
    inhale(random);
  }
  void inhale(Random& random) {
    // [tobin1988]: the depth varies by 33 %, the rate by 21 %. A sigh is twice as deep.
    depth_m = peak_to_peak_m * std::max(0.2, 1.0 + gaussian(random, 0.33));
    if (uniform(random, 0.0, 1.0) < 0.1) depth_m *= 2.0;
    rate_hz = 0.25 * std::max(0.5, 1.0 + gaussian(random, 0.21));
  }
  /// Towards the tool as the person breathes in: the skin goes to smaller positions.
  double step(Random& random) {
    phase += rate_hz * step_s;
    if (phase >= 1.0) {
      phase -= 1.0;
      inhale(random);
    }
    return -0.5 * depth_m * (1.0 - std::cos(2.0 * pi * phase));
  }
};

struct Torso {
  bool there;
  double mass_kg, n_per_m, n_s_per_m, at_m = 0.0, speed_m_per_s = 0.0;

  Torso(bool is_there, Random& random)
      : there(is_there),
        mass_kg(uniform(random, 3.0, 10.0)),
        n_per_m(uniform(random, 10e3, 35e3)),
        n_s_per_m(2.0 * uniform(random, 0.2, 0.4) * std::sqrt(mass_kg * n_per_m)) {}
  void step(double force_n) {
    if (!there) return;
    speed_m_per_s += step_s / mass_kg * (force_n - n_per_m * at_m - n_s_per_m * speed_m_per_s);
    at_m += step_s * speed_m_per_s;
  }
};

/// A share by which muscles are stiffer: within 0.3 s, kept for a while, gone within a second.
double tensed(double since_s, double kept_s) {
  if (since_s < 0.0) return 0.0;
  if (since_s < 0.3) return since_s / 0.3;
  return std::clamp(1.0 - (since_s - 0.3 - kept_s), 0.0, 1.0);
}

struct ForceSensor {
  bool poor;
  double drift_n_per_s, crosstalk, held_n = 0.0, strongest_n = 0.0;

  ForceSensor(bool is_poor, Random& random)
      : poor(is_poor),
        drift_n_per_s(uniform(random, -1.0, 1.0) * 0.5 / 60.0),
        crosstalk(uniform(random, -0.01, 0.01)) {}
  double read(double time_s, double force_n, Random& random) {
    double read_n = force_n;
    if (poor) {
      // Hysteresis of 1 %: the reading lags by half of that of the strongest force of the press.
      strongest_n = force_n > 0.0 ? std::max(strongest_n, force_n) : 0.0;
      const double play_n = 0.005 * strongest_n;
      held_n = std::clamp(held_n, force_n - play_n, force_n + play_n);
      read_n = held_n * (1.0 + crosstalk) + drift_n_per_s * time_s;
    }
    return read_n + gaussian(random, force_noise_n);
  }
};

/// The force wanted: one press of its way, `share` of its duration gone.
struct PressPlan {
  double rise_s, hold_s, pause_s;
  int presses;

  [[nodiscard]] double duration_s() const { return 2.0 * rise_s + hold_s + pause_s; }
  [[nodiscard]] double wanted(double time_s) const {
    const double from_end_s = 2.0 * rise_s + hold_s - time_s;
    const double in_s = std::clamp(std::min(time_s, from_end_s), 0.0, rise_s);
    return 0.5 * (1.0 - std::cos(pi * in_s / rise_s));
  }
};

PressPlan plan_of(Pressing pressing) {
  switch (pressing) {
    case Pressing::swells:
      return {.rise_s = 0.5, .hold_s = 0.0, .pause_s = 0.6, .presses = 6};
    case Pressing::holds:
      return {.rise_s = 1.6, .hold_s = 0.6, .pause_s = 0.6, .presses = 4};
    case Pressing::sinusoid:
      return {.rise_s = 0.6, .hold_s = 0.0, .pause_s = 0.0, .presses = 10};
  }
  return {};
}

std::vector<TissueWorld> make_worlds() {
  using Elastic = TissueWorld::Elastic;
  return {
      {.name = "control", .about = "the tangent law"},
      {.name = "qlv15", .about = "relaxes by 15 %", .relaxing_share = 0.15},
      {.name = "qlv30", .about = "relaxes by 30 %", .relaxing_share = 0.3},
      {.name = "qlv50", .about = "relaxes by 50 %", .relaxing_share = 0.5},
      {.name = "hunt_crossley",
       .about = "power law with damping",
       .elastic = Elastic::power,
       .damping_s_per_m = 12.0},
      {.name = "fung", .about = "exponential", .elastic = Elastic::exponential},
      {.name = "layered", .about = "fat over muscle over bone", .elastic = Elastic::layers},
      {.name = "torso", .about = "mass, spring and damper beneath", .on_torso = true},
      {.name = "precondition",
       .about = "the first press meets a fifth more",
       .first_press_stiffer = 0.2},
      {.name = "guarding",
       .about = "tenses by half at times",
       .tensing_share = 0.5,
       .tensing_presses = 0.6},
      {.name = "breathing", .about = "1.3 mm, no breath like the other, sighs", .breath_m = 1.3_mm},
      {.name = "sensor", .about = "drift, crosstalk, hysteresis", .poor_sensor = true},
      {.name = "tilt_slip", .about = "the tool slips to another place", .slipping = 1.0},
      {.name = "everything",
       .about = "all of it, milder",
       .relaxing_share = 0.25,
       .damping_s_per_m = 5.0,
       .on_torso = true,
       .first_press_stiffer = 0.1,
       .tensing_share = 0.3,
       .tensing_presses = 0.2,
       .breath_m = 0.7_mm,
       .poor_sensor = true,
       .slipping = 0.5},
  };
}

}  // namespace

const std::vector<TissueWorld>& tissue_worlds() {
  static const std::vector<TissueWorld> all = make_worlds();
  return all;
}

WorldPresses press_in_world(const TissueWorld& world, Pressing pressing,
                            const TangentTissue& tissue, Random& random) {
  TangentTissue here{tissue.alpha_n * std::exp(gaussian(random, 0.15)),
                     tissue.beta_per_m * std::exp(gaussian(random, 0.08))};
  ElasticCurve elastic(world.elastic, here, random);
  Relaxation relaxation(world.relaxing_share, random);
  Breathing breathing(world.breath_m, random);
  Torso torso(world.on_torso, random);
  ForceSensor sensor(world.poor_sensor, random);
  const double damping = world.damping_s_per_m * uniform(random, 0.67, 1.33);
  const PressPlan plan = plan_of(pressing);
  const double usual_n = uniform(random, 14.0, 25.0);
  double skin_m = gaussian(random, 0.5_mm), tool_m = -3_mm, speed_m_per_s = 0.0, force_n = 0.0;

  WorldPresses out;
  double time_s = 0.0;
  for (int press = 0; press < plan.presses; ++press) {
    const double strongest_n =
        pressing == Pressing::sinusoid ? usual_n : uniform(random, 10.0, 25.0);
    const bool tenses = uniform(random, 0.0, 1.0) < world.tensing_presses;
    const double tense_s = uniform(random, 0.1, 0.5) * plan.duration_s();
    const double tense_for_s = uniform(random, 0.3, 1.0);
    if (world.slipping > 0.0 && press > 0 && uniform(random, 0.0, 1.0) < 0.3) {
      here.alpha_n *= std::exp(gaussian(random, 0.1 * world.slipping));
      here.beta_per_m *= std::exp(gaussian(random, 0.04 * world.slipping));
      skin_m += gaussian(random, 0.5_mm * world.slipping);
      elastic = ElasticCurve(world.elastic, here, random);
    }
    if (press + 1 == plan.presses) out.last_press = out.record.size();
    for (double since_s = 0.0; since_s < plan.duration_s(); since_s += sample_s) {
      const double wanted_n = strongest_n * plan.wanted(since_s);
      for (int i = 0; i < substeps; ++i) {
        const double stiffer =
            1.0 + (press == 0 ? world.first_press_stiffer : 0.0) +
            (tenses ? world.tensing_share * tensed(since_s - tense_s, tense_for_s) : 0.0);
        const double depth_m = tool_m - skin_m - breathing.step(random) - torso.at_m;
        const double into_m_per_s = speed_m_per_s - torso.speed_m_per_s;
        force_n = std::max(0.0, relaxation.left(stiffer * elastic.force(depth_m))) *
                  std::max(0.0, 1.0 + damping * into_m_per_s);
        torso.step(force_n);
        // A force controller of some 10 Hz; between presses it waits 2 mm above.
        constexpr double m_per_ns = 0.004, max_m_per_s = 50_mm, approach_m_per_s = 8_mm;
        const bool waits = wanted_n < 0.05 && force_n <= 0.0;
        double wanted_m_per_s =
            waits ? 20.0 * (skin_m - 2_mm - tool_m) : m_per_ns * (wanted_n - force_n);
        if (!waits && force_n <= 0.0) wanted_m_per_s += approach_m_per_s;
        wanted_m_per_s = std::clamp(wanted_m_per_s, -max_m_per_s, max_m_per_s);
        constexpr double lag_s = 5e-3;
        speed_m_per_s += step_s / lag_s * (wanted_m_per_s - speed_m_per_s);
        tool_m += step_s * speed_m_per_s;
      }
      out.truth.push_back({time_s, {.depth_m = tool_m, .force_n = force_n}});
      out.record.push_back({time_s,
                            {.depth_m = tool_m + gaussian(random, position_noise_m),
                             .force_n = sensor.read(time_s, force_n, random)}});
      time_s += sample_s;
    }
  }
  return out;
}

}  // namespace tuina::sim
