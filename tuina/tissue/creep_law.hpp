// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tuina/core/contact.hpp"
#include "tuina/tissue/press_segments.hpp"

namespace tuina::tissue {

/// The tangent law of tissue that relaxes, in the form that has no pole:
///   depth = s F + (atan(u) + r atan(c u)) / beta,   u = (F / (1 + mu v) + sum of j_i L_i) / alpha,
/// r the share of a softer layer above, as fat is over muscle, c how much softer it is, L_i the
/// force behind a low-pass of `memory_s[i]`. Quasi-linear viscoelastic tissue obeys it exactly, in
/// the air as well: its elastic force is F + sum of j_i L_i ([zheng1999]).
struct CreepLaw {
  TangentTissue tissue;  ///< of the elastic force, that of an infinitely fast press
  Memory creep = {};     ///< j_i
  double layer_share = 0.0, layer_softness = 1.0;  ///< r and c
  double compliance_m_per_n = 0.0;                 ///< s, of what lies beneath
  double damping_s_per_m = 0.0;                    ///< mu, Hunt and Crossley's
};

/// A force that lasted, and how fast the tool goes deeper.
struct Loading {
  double force_n = 0.0;
  Memory memory_n = {};
  double speed_m_per_s = 0.0;
};

/// Depth beneath the skin, and its change with the logarithms of alpha, beta, the three j_i, r, c
/// and s, with mu, and with the force.
struct CreepDepth {
  double depth_m = 0.0;
  double by_log_alpha = 0.0, by_log_beta = 0.0, by_log_compliance = 0.0, by_damping = 0.0;
  double by_log_share = 0.0, by_log_softness = 0.0;
  Memory by_log_creep = {};
  double m_per_n = 0.0;
};
/// The depth at a force, which the law gives in closed form.
[[nodiscard]] CreepDepth depth_of(const CreepLaw& law, const Loading& loading) noexcept;

/// The force at a depth, by Newton's method: the depth is a concave function of the force, so the
/// steps from zero never go too far. Zero without contact, `max_force_n` beyond the law's reach.
[[nodiscard]] double force_of(const CreepLaw& law, double depth_m, const Memory& memory_n,
                              double speed_m_per_s, double max_force_n) noexcept;

/// The tangent law of the first loading of rested tissue at 10 mm/s: it meets the creep law at the
/// force and at half of it.
[[nodiscard]] TangentTissue first_loading(const CreepLaw& law, double force_n) noexcept;

}  // namespace tuina::tissue
