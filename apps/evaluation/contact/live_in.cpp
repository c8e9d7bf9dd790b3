// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "apps/evaluation/contact/contact_experiment.hpp"
#include "apps/simulated/session_order.hpp"

namespace tuina::app {

void live_in(const session::Config& config, ContactExperiment& experiment) {
  const sim::WorldOptions world = world_options(config);
  experiment.skin_friction = world.skin_friction;
  experiment.living = world.living;
  experiment.tool_weight_error = world.arm_errors.tool_mass_share;
  experiment.devices.flaws = world.devices.flaws;
  const sim::Breathing before = experiment.breathing;
  experiment.breathing = world.breathing;
  if (config.simulation.realism != "ideal") {
    if (std::isfinite(experiment.torso_n_per_m)) experiment.torso_n_per_m = world.torso_n_per_m;
    if (before.amplitude_m <= 0.0) return;
  }
  experiment.breathing.amplitude_m = before.amplitude_m;
  experiment.breathing.frequency_hz = before.frequency_hz;
}

}  // namespace tuina::app
