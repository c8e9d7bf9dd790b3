// SPDX-License-Identifier: Apache-2.0
#include "tuina/sim/tissue_worlds.hpp"

#include <algorithm>
#include <cmath>

#include "tuina/core/units.hpp"
#include "tuina/sim/person/breath.hpp"
#include "tuina/sim/robot/sensor_axis.hpp"

namespace tuina::sim {
namespace {

constexpr double sample_s = 1e-3;
constexpr int substeps = 4;
constexpr double substep_s = sample_s / substeps;
constexpr double force_noise_n = 0.2, position_noise_m = 0.05_mm;

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

/// Skin that moves with breaths of which no two are alike, from wherever in a breath.
struct BreathingSkin {
  Breathing usual;
  Breath breath;
  double phase;

  BreathingSkin(double peak_to_peak_m, Random& random)
      : usual{.amplitude_m = peak_to_peak_m, .variation = 1.0, .sigh_share = 0.1},
        breath{},
        phase(uniform(random, 0.0, 1.0)) {
    breath = draw_breath(usual, random);
  }
  /// Towards the tool as the person breathes in: the skin goes to smaller positions.
  double step(Random& random) {
    phase += breath.rate_hz * substep_s;
    if (phase >= 1.0) {
      phase -= 1.0;
      breath = draw_breath(usual, random);
    }
    return -breath.depth_m * breath_share(phase).at;
  }
};

Torso draw_torso(bool there, Random& random) {
  const double mass_kg = uniform(random, 3.0, 10.0), n_per_m = uniform(random, 10e3, 35e3);
  return Torso::with(mass_kg, there ? n_per_m : rigid, uniform(random, 0.2, 0.4));
}

/// The force sensor of such a world; one that is not poor has noise only.
struct ForceSensor {
  bool poor;
  SensorAxis axis;
  double crosstalk;

  ForceSensor(bool is_poor, Random& random)
      : poor(is_poor),
        axis{.drift_per_s = uniform(random, -1.0, 1.0) * 0.5 / 60.0, .hysteresis = 0.01},
        crosstalk(uniform(random, -0.01, 0.01)) {}
  double read(double time_s, double force_n, Random& random) {
    if (force_n <= 0.0) axis.strongest = 0.0;
    const double read_n =
        poor ? axis.lag(force_n) * (1.0 + crosstalk) + axis.drift_per_s * time_s : force_n;
    return read_n + gaussian(random, force_noise_n);
  }
};

std::vector<TissueWorld> make_worlds() {
  using Elastic = ElasticForm::Law;
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
  const TangentTissue here{tissue.alpha_n * std::exp(gaussian(random, 0.15)),
                           tissue.beta_per_m * std::exp(gaussian(random, 0.08))};
  return press_in_world(world, pressing, here, {random, random, random});
}

WorldPresses press_in_world(const TissueWorld& world, Pressing pressing, TangentTissue here,
                            const WorldDraws& draws) {
  Random& random = draws.day;
  LivingTissue living{
      .form = draw_form(world.elastic, draws.place),
      .relaxation = Relaxation::draw(world.relaxing_share, {0.1, 1.0, 10.0}, draws.place)};
  BreathingSkin breathing(world.breath_m, random);
  living.torso = draw_torso(world.on_torso, draws.place);
  ForceSensor sensor(world.poor_sensor, draws.sensor);
  living.damping_s_per_m = world.damping_s_per_m * uniform(draws.place, 0.67, 1.33);
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
    }
    if (press + 1 == plan.presses) out.last_press = out.record.size();
    const int samples = static_cast<int>(std::lround(plan.duration_s() / sample_s));
    for (int sample = 0; sample < samples; ++sample) {
      const double since_s = sample * sample_s;
      const double wanted_n = strongest_n * plan.wanted(since_s);
      for (int i = 0; i < substeps; ++i) {
        const double stiffer =
            1.0 + (press == 0 ? world.first_press_stiffer : 0.0) +
            (tenses ? world.tensing_share * tensed(since_s - tense_s, tense_for_s) : 0.0);
        const double travel_m = tool_m - skin_m - breathing.step(random);
        force_n = living.press(here, travel_m, speed_m_per_s, stiffer, substep_s);
        // A force controller of some 10 Hz; between presses it waits 2 mm above.
        constexpr double m_per_ns = 0.004, max_m_per_s = 50_mm, approach_m_per_s = 8_mm;
        const bool waits = wanted_n < 0.05 && force_n <= 0.0;
        double wanted_m_per_s =
            waits ? 20.0 * (skin_m - 2_mm - tool_m) : m_per_ns * (wanted_n - force_n);
        if (!waits && force_n <= 0.0) wanted_m_per_s += approach_m_per_s;
        wanted_m_per_s = std::clamp(wanted_m_per_s, -max_m_per_s, max_m_per_s);
        constexpr double lag_s = 5e-3;
        speed_m_per_s += substep_s / lag_s * (wanted_m_per_s - speed_m_per_s);
        tool_m += substep_s * speed_m_per_s;
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
