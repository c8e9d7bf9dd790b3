// SPDX-License-Identifier: Apache-2.0
// What does a press feel? A tool is pressed onto hard muscle three times and watched by the
// estimator, which knows neither the tissue nor where exactly the skin is; the sensors are noisy.
// Alpha and beta of F = alpha tan(beta x) come out, each with the half-width of its 95 % interval.
#include <fmt/core.h>

#include "tuina/core.hpp"
#include "tuina/sim.hpp"
#include "tuina/tissue.hpp"

using namespace tuina;

int main() {
  constexpr TangentTissue truth = {.alpha_n = 9.786, .beta_per_m = 185.4};  // [thesis] 6.1
  constexpr double torso_n_per_m = 35e3;
  constexpr double tool_radius_m = 17_mm;
  constexpr double skin_error_m = 0.4_mm;  // the skin lies so much deeper than believed
  constexpr double force_noise_n = 0.2, position_noise_m = 0.05_mm;

  const Mesh skin = sim::make_patch({.centre_in_couch = Vector3(0.0, -skin_error_m, 0.0)});
  sim::BackContact person(skin, std::vector<TangentTissue>(skin.vertices.size(), truth),
                          {.tool_radius_m = tool_radius_m, .torso_n_per_m = torso_n_per_m});
  tissue::PressEstimator estimator({.force_noise_n = force_noise_n,
                                    .position_noise_m = position_noise_m,
                                    .torso_n_per_m = torso_n_per_m,
                                    .breathing_m = 0.0});
  Random noise = make_random(1, "sensors");

  fmt::print("  time     tool    force    alpha           beta\n");
  constexpr double air_m = 2_mm, deepest_m = 9_mm, press_s = 1.0;
  for (int tick = 0; tick <= 3000; ++tick) {
    // Three presses of a second: out of the air, 9 mm past the believed skin, and back.
    const double time_s = 1e-3 * tick;
    const double phase = 2.0 * pi * time_s / press_s;
    const double position_m = -air_m + (deepest_m + air_m) * 0.5 * (1.0 - std::cos(phase));
    const double speed = (deepest_m + air_m) * pi / press_s * std::sin(phase);
    const Vector3 centre_in_couch(0.0, tool_radius_m - position_m, 0.0);
    const sim::ContactTruth& touch =
        person.touch(Arm::left, time_s, centre_in_couch, Vector3(0.0, -speed, 0.0));

    estimator.update(time_s, {.depth_m = position_m + gaussian(noise, position_noise_m),
                              .force_n = touch.force_n + gaussian(noise, force_noise_n)});
    if (tick % 250 != 0) continue;
    const TissueEstimate& felt = estimator.estimate();
    fmt::print("{:5.2f} s {:5.1f} mm {:5.1f} N  {:5.2f} +- {:4.2f} N  {:.4f} +- {:.4f} /mm{}\n",
               time_s, to_mm(position_m), touch.force_n, felt.tissue.alpha_n, felt.alpha_ci95_n,
               1e-3 * felt.tissue.beta_per_m, 1e-3 * felt.beta_ci95_per_m,
               felt.converged ? "  converged" : "");
  }
  fmt::print("    the truth           {:5.2f}         N  {:.4f}           /mm\n", truth.alpha_n,
             1e-3 * truth.beta_per_m);
  return estimator.estimate().converged ? 0 : 1;
}
