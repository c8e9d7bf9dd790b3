// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "tuina/core/contact.hpp"
#include "tuina/tissue/press_segments.hpp"

namespace tuina::tissue {

/// What is known before the first press. The defaults suit a record of a press on a person who
/// hardly moves; a robot says what its own depth holds: the torso gives way, the person breathes,
/// the sensor lags.
struct PressEstimatorOptions {
  double force_noise_n = 0.2;  ///< one standard deviation of one sample
  double position_noise_m = 0.05e-3;
  double contact_sd_m =
      0.5e-3;  ///< how well the place of the skin is known: it is expected at position 0
  double force_delay_s = 0.0;  ///< of the force sensor against the position
  double timing_sd_s = 0.0;    ///< how well that delay is known
  double tool_mass_kg = 0.0;   ///< beyond the force sensor, which feels it being accelerated
  double torso_n_per_m = 0.0;  ///< stiffness in series with the tissue; 0 or infinity is rigid
  double torso_sd = 0.12;      ///< relative
  double breathing_m = 1e-3;   ///< how far the skin may move with the breath, peak to peak
  double breathing_hz = 0.25;
  double breath_damping = 0.15;      ///< how irregular it may be; 0 is a pure tone
  double skin_wander_m = 0.1e-3;     ///< of the skin at rest, in a second
  double model_sd_m = 0.06e-3;       ///< of a segment: what law, sensors and noise leave out
  double damping_sd_s_per_m = 10.0;  ///< of the Hunt-Crossley factor mu in F (1 + mu v)
  double converged_alpha =
      0.05;  ///< half-widths of the 95 % intervals, relative, to be called converged
  double converged_beta = 0.05;
  TangentTissue expected = {5.6, 215.0};  ///< Table 6-2 of [thesis]: the centre of its 21 rows
  double expected_alpha_sd = 0.5;         ///< of the logarithm
  double expected_beta_sd = 0.3;
};

/// What a robot's own presses need: its depth comes from joint angles, precise but on a torso that
/// gives way and breathes by 3 mm; the skin is known to 3 mm from a scan. Two presses of a second
/// then promise alpha to 8 % and beta to 5 %. Tuned on presses by the simulated arm with seeds
/// apart from those of tests and tables.
[[nodiscard]] PressEstimatorOptions pressed_by_robot(double torso_n_per_m,
                                                     double tool_mass_kg) noexcept;

/// Alpha and beta of F = alpha tan(beta x) from one person's presses, sample by sample.
///
/// The law is used the other way round, position = skin + breath + F / torso + atan(F / alpha) /
/// beta: it has no pole, and it is linear in all that moves. Segments of the last presses are
/// filtered again and again, each time linearised at the newest alpha and beta (Gauss-Newton with
/// the breath integrated out); old segments become the prior. One tick works on two segments at
/// most, so every tick costs about the same. No heap, no exception; finite and positive for any
/// input.
class PressEstimator {
 public:
  explicit PressEstimator(const PressEstimatorOptions& options = {}) noexcept;

  /// One sample: position along the inward normal (larger is deeper, the skin near zero) and the
  /// force onto the person. Time in seconds, of any origin, growing.
  void update(double time_s, const Press& sample) noexcept;

  [[nodiscard]] const TissueEstimate& estimate() const noexcept { return estimate_; }

  /// Normalised squared misfit: about 1 if the tangent law describes this tissue, above 4 it does
  /// not.
  [[nodiscard]] double chi() const noexcept { return chi_; }
  [[nodiscard]] double damping_s_per_m() const noexcept { return state_(mu); }
  [[nodiscard]] double tare_n() const noexcept { return segments_.tare_n(); }
  [[nodiscard]] double peak_force_n() const noexcept { return segments_.peak_force_n(); }

  /// Tangent stiffness of the tissue at a force, and its relative standard deviation: the best
  /// known output.
  [[nodiscard]] double stiffness_n_per_m(double force_n) const noexcept;
  [[nodiscard]] double stiffness_sd(double force_n) const noexcept;

  /// Forgets the person but not the options: for the next acupoint.
  void reset() noexcept;

 private:
  // `offset` is what the tare left of the force sensor's zero.
  // The breath is a damped oscillator driven by noise: breath and its speed. The skin at rest
  // wanders slowly.
  enum Index { log_alpha, log_beta, mu, compliance, offset, skin, breath, breath_speed, states };
  using State = Eigen::Matrix<double, states, 1>;
  using Covariance = Eigen::Matrix<double, states, states>;
  struct Belief {
    State mean;
    Covariance covariance;
    double time_s;
  };

  void begin_pass() noexcept;
  void advance(double time_s) noexcept;
  void learn(const PressSegment& segment) noexcept;
  void learn_near(const PressSegment& air) noexcept;
  void take(const State& H, double innovation, double R) noexcept;
  void tell_skin(std::size_t i) noexcept;
  void finish_pass() noexcept;
  void publish() noexcept;

  PressEstimatorOptions options_;
  PressSegments segments_;
  Belief prior_;  // what the segments before the window said
  Belief pass_;   // the running pass
  Belief fold_;   // the pass at the middle of the window
  State state_;   // result of the last pass; linearisation of the next
  Covariance covariance_;
  double alpha_ = 0.0, beta_ = 0.0;  // of the linearisation
  double sum_nis_ = 0.0, count_ = 0.0;
  Eigen::Vector2d last_step_;  // of ln alpha and ln beta
  double step_limit_ = 0.0;
  bool settled_ = false;
  std::size_t next_ = 0, pass_size_ = 0;
  int idle_passes_ = 0;
  long seen_blocks_ = 0;
  double chi_ = 1.0;
  TissueEstimate estimate_;
};

}  // namespace tuina::tissue
