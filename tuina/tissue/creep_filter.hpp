// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "tuina/tissue/creep_law.hpp"
#include "tuina/tissue/press_estimator.hpp"
#include "tuina/tissue/press_segments.hpp"

namespace tuina::tissue {

/// What one filter takes for granted; several with different ones run side by side.
struct CreepHypothesis {
  double creep = 0.0;           ///< expected j of each memory; 0: the tissue is elastic
  double breathing_m = 0.0;     ///< peak-to-peak motion of the skin
  double steadiness = 1.0;      ///< by which the breath is damped less than the caller expects
  double first_press_sd = 0.0;  ///< by which ln alpha differs in the first press
  /// Each new contact may be at another place: the skin moves, ln alpha differs by it.
  double landing_sd_m = 0.0, landing_sd = 0.0;
  double changing_sd = 0.0;  ///< of ln alpha within seconds: a person tenses, the tool slips
};

/// Gauss-Newton on the creep law with breath, skin and the zero of the force integrated out: a
/// Kalman filter over the segments of a window, passed again at the newest parameters. No heap.
class CreepFilter {
 public:
  /// Places in the state. `log_` are natural logarithms of SI values: alpha (N), beta (1/m), the j
  /// of each memory, share of the softer layer, compliance beneath (m/N), softness of the layer.
  /// `first_press` and `change` add to ln alpha, in the first press and for some seconds. `damping`
  /// is mu (s/m), `offset` the zero of the force (N), `skin` and `breath` are positions (m),
  /// `breath_speed` is in m/s. Those before `nonlinear` are linearised at the last pass.
  enum Index {
    log_alpha,
    log_beta,
    log_creep,
    log_share = log_creep + static_cast<int>(memory_s.size()),
    log_compliance,
    log_softness,
    first_press,
    damping,
    nonlinear,
    change = nonlinear,
    offset,
    skin,
    breath,
    breath_speed,
    states
  };
  /// @{
  /// The state by `Index`, and its covariance.
  using State = Eigen::Matrix<double, states, 1>;
  using Covariance = Eigen::Matrix<double, states, states>;
  /// @}
  /// What is believed after some segments.
  struct Belief {
    State mean = State::Zero();
    Covariance covariance = Covariance::Zero();
    double time_s = 0.0;
    int press = 0;              ///< of the newest segment
    double log_evidence = 0.0;  ///< of all segments fused so far
    double nis_sum = 0.0, nis_count = 0.0;
  };

  CreepFilter() = default;
  /// Before the first segment, under one hypothesis.
  CreepFilter(const PressEstimatorOptions& options, const CreepHypothesis& hypothesis) noexcept;

  /// A new segment goes into the newest belief, linearised as in the last pass.
  void follow(const PressSegment& segment) noexcept { fuse(now_, segment); }

  /// A pass over the window: begun, one segment after the other, ended.
  void begin_pass(double tare_sd_n) noexcept;
  /// @{
  /// Likewise: one segment, the belief to be kept as the new beginning, the end.
  void pass(const PressSegment& segment) noexcept { fuse(pass_, segment); }
  void keep_middle() noexcept { middle_ = pass_; }
  void finish_pass() noexcept;
  /// @}
  /// Before the first segment, after another place of the same person: what people have much alike
  /// all over is expected as it was found there, less surely.
  void expect_person(const Belief& elsewhere) noexcept;
  /// The segments before the kept middle leave the window.
  void forget_before_middle() noexcept { prior_ = middle_; }
  /// True when the parameters have left the place at which they were linearised.
  [[nodiscard]] bool moved() const noexcept;

  /// Belief after the newest segment.
  [[nodiscard]] const Belief& now() const noexcept { return now_; }
  /// Where the last pass was linearised.
  [[nodiscard]] const State& at() const noexcept { return at_; }
  /// The belief after one more segment.
  void fuse(Belief& belief, const PressSegment& segment) const noexcept;
  /// The belief at a later time without a new segment.
  void predict(Belief& belief, double time_s) const noexcept;

  /// Position of the tool under a force, linearised at `at`: its variance by what the belief does
  /// not know, and its change with the force.
  struct Expected {
    State H = State::Zero();
    double position_m = 0.0, variance_m2 = 0.0, m_per_n = 0.0;
  };
  /// What a belief lets expect of the tool's place under a force.
  [[nodiscard]] static Expected expect(const Belief& belief, const State& at, bool first_press,
                                       const Loading& loading) noexcept;
  /// The law of a state without what passes.
  [[nodiscard]] static CreepLaw law_at(const State& state) noexcept;

 private:
  void fuse(Belief& belief, const State& H, double innovation, double R) const noexcept;

  PressEstimatorOptions options_;
  CreepHypothesis hypothesis_;
  Belief prior_, pass_, middle_, now_;
  State at_ = State::Zero();         // linearisation point
  State last_step_ = State::Zero();  // of the last pass
  double wander_m_ = 0.0;            // random walk of the resting skin in a second
  double step_limit_ = 0.0;
};

}  // namespace tuina::tissue
