// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <limits>

#include "tuina/core/contact.hpp"
#include "tuina/core/random.hpp"

namespace tuina::sim {

inline constexpr double rigid = std::numeric_limits<double>::infinity();

/// Elastic force over depth, of the person's own form but as high at 20 N as the tangent that is
/// the place's. Layers are skin with fat, which is used up first, and muscle, both exponential
/// ([fung1993]), one behind the other, over bone; no tangent is in them.
struct ElasticForm {
  /// The kind of curve.
  enum class Law : std::uint8_t { tangent, power, exponential, layers } law = Law::tangent;
  double shape = 1.0;                  ///< exponent of the power law, or of the exponential at 20 N
  double fat_share = 0.0;              ///< of the depth at 20 N
  double fat_n = 1.0, muscle_n = 7.0;  ///< at so much force a layer is twice as stiff as at none
  double bone_n_per_m = 45e3;
};
/// Draws a form of that law.
[[nodiscard]] ElasticForm draw_form(ElasticForm::Law law, Random& random);
/// Force at a depth; zero above the skin. No heap.
[[nodiscard]] double elastic_force_n(const ElasticForm& form, const TangentTissue& place,
                                     double depth_m) noexcept;

/// What of an elastic force is gone after a while: F = E - sum of g_i q_i, q_i' = (E - q_i) /
/// tau_i.
struct Relaxation {
  std::array<double, 3> tau_s = {1.0, 1.0, 1.0}, share = {}, force_n = {};

  /// Shares drawn for these times, `in_all` together.
  [[nodiscard]] static Relaxation draw(double in_all, const std::array<double, 3>& tau_s,
                                       Random& random);
  /// Force that is left; `renewed_per_s` of what lies under the tool is fresh, where it slides.
  double left(double elastic_n, double step_s, double renewed_per_s = 0.0) noexcept;
};

/// The body under the tissue: m y'' + c y' + k y = F.
struct Torso {
  double mass_kg = 0.0;  ///< zero: follows within 5 ms
  double n_per_m = rigid, n_s_per_m = 0.0;
  double at_m = 0.0, speed_m_per_s = 0.0;

  /// Of that stiffness; 1 is damped critically.
  [[nodiscard]] static Torso with(double mass_kg, double n_per_m, double damping_ratio) noexcept;
  /// A step of time under that force.
  void step(double force_n, double step_s) noexcept;
};

/// Share by which muscles are stiffer that a person tenses: within 0.3 s, kept for a while, gone
/// within a second.
[[nodiscard]] double tensed(double since_s, double kept_s) noexcept;

/// Tissue that relaxes, damps and lies on a torso:
///
///   F = max(0, s E(d) - sum of g_i q_i) max(0, 1 + mu v),
///
/// d the depth above the torso, v its rate, s how much stiffer the person is right now.
struct LivingTissue {
  ElasticForm form = {};
  Relaxation relaxation = {};
  Torso torso = {};
  double damping_s_per_m = 0.0;  ///< mu
  double depth_m = 0.0;          ///< of the last `press`

  /// Force on a tool `travel_m` below the resting skin, going inward with `m_per_s`; then a step of
  /// time passes. No heap.
  double press(const TangentTissue& place, double travel_m, double m_per_s, double stiffer,
               double step_s, double renewed_per_s = 0.0) noexcept;

  /// The tangent law of the first loading, at 10 mm/s up to a force, of rested tissue on a torso
  /// that does not yield: as deep as it at that force and at half of it. `stiffer` as in `press`.
  /// No heap.
  [[nodiscard]] TangentTissue first_loading(const TangentTissue& place, double stiffer,
                                            double force_n) const noexcept;

 private:
  /// A step of a torso that is lighter than what tissue damps within it: with the speed at its end,
  /// because with that at its beginning each step would answer the one before more strongly.
  double step_with_torso(double left_n, double m_per_s, double step_s) noexcept;
};

}  // namespace tuina::sim
