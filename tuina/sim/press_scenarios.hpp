// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "tuina/core/random.hpp"
#include "tuina/tissue/press_record.hpp"

namespace tuina::sim {

/// Simulated presses on one place, with disturbances. The model differs from the estimator's:
/// sinusoidal breath, coloured errors, other tissue laws.
struct PressScenario {
  std::string name;
  std::string about;
  enum class Shape : std::uint8_t {
    sine,     ///< |sin| in depth, the skin released between presses
    sigmoid,  ///< [thesis] (3.20) in depth, with a hold
    force     ///< force-controlled press on a compliant torso; 3 N between presses
  } shape = Shape::sine;
  enum class TissueModel : std::uint8_t {
    tangent,
    quadratic,
    hertz,
    exponential
  } law = TissueModel::tangent;
  double force_noise_n = 0.2;
  double position_noise_m = 0.05e-3;
  double position_correlation_s = 0.0;  ///< 0: white position noise
  double contact_sd_m = 0.5e-3;
  double press_hz = 1.0;
  double damping_s_per_m = 0.0;  ///< mu in F (1 + mu v)
  double breath_m = 0.0;         ///< amplitude, half of peak to peak
  double breath_hz = 0.25;
  double force_bias_sd_n = 0.0;
  double tissue_spread = 0.0;  ///< 1: alpha 15 %, beta 8 %
  double force_share = 1.0;    ///< share of the peak force
  double force_delay_s = 0.0;
  double torso_n_per_m = 0.0;  ///< as assumed; the true one differs by up to 20 %
  double duration_s = 6.0;
};

/// N0 to N7 and their variants (docs/tissue.md), then L0 to L3, presses as the robot makes them.
[[nodiscard]] const std::vector<PressScenario>& press_scenarios();

struct SimulatedPresses {
  TangentTissue truth;
  std::vector<tissue::TimedPress> record;
  double first_contact_s = 0.0;
  double skin_m = 0.0;  ///< position of the skin at the start
};

/// `peak_n`: force at the deepest point. Sampled at 1 kHz.
[[nodiscard]] SimulatedPresses simulate_presses(const PressScenario& scenario,
                                                const TangentTissue& tissue, double peak_n,
                                                Random& random);

/// [thesis] 6.3.1: an impedance of 1 kg, 100 N/m and 14 N s/m driven by 5 mm |sin(3 pi t)| against
/// the tissue, integrated by Runge-Kutta (6.21). Two misprints corrected: the tissue pushes back
/// (as printed in (6.18) it pulls and diverges within 0.1 s), and the damping is 2 x 0.7 sqrt(M K).
/// Depth from the skin, without noise.
[[nodiscard]] std::vector<tissue::TimedPress> simulate_thesis_presses(const TangentTissue& tissue,
                                                                      double duration_s);

}  // namespace tuina::sim
