// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "tuina/core/contact.hpp"
#include "tuina/tissue/estimator.hpp"
#include "tuina/tissue/press_segments.hpp"

namespace tuina::tissue {

/// Prior and noise model. The defaults suit a record of presses on a person who hardly moves;
/// `pressed_by_robot` models the compliant torso, breath and sensor delay of a robot's own presses.
struct PressEstimatorOptions {
  double force_noise_n = 0.2;  ///< one standard deviation of one sample
  double position_noise_m = 0.05e-3;
  double contact_sd_m = 0.5e-3;  ///< standard deviation of the skin position about 0
  double untared_sd_n = 0.3;     ///< of the zero of the force, without free air to see it in
  double force_delay_s = 0.0;    ///< delay of the force sensor against the position
  double timing_sd_s = 0.0;      ///< standard deviation of that delay
  double tool_mass_kg = 0.0;     ///< mass beyond the force sensor, whose inertia it measures
  double torso_n_per_m = 0.0;    ///< stiffness in series with the tissue; 0 or infinity is rigid
  double torso_sd = 0.12;        ///< relative standard deviation of the torso compliance
  double breathing_m = 1e-3;     ///< peak-to-peak motion of the skin by breathing
  double breathing_hz = 0.25;
  double breath_damping = 0.15;   ///< damping ratio of the breath model; 0 is a pure sinusoid
  double skin_wander_m = 0.1e-3;  ///< random walk of the resting skin, in a second
  /// The tool follows the skin by its force, so breath in a press is no error of its force.
  bool follows_skin = false;
  double onset_n = 1.5;         ///< force from which a press is foretold: the skin is known there
  double model_sd_m = 0.06e-3;  ///< model error per segment: law, sensors, noise
  double damping_sd_s_per_m = 10.0;  ///< of the Hunt-Crossley factor mu in F (1 + mu v)
  double converged_alpha = 0.05;     ///< relative half-width of the 95 % interval at convergence
  double converged_beta = 0.05;
  TangentTissue expected = {5.6, 215.0};  ///< [thesis] Table 6-2: the centre of its 21 rows
  double expected_alpha_sd = 0.5;         ///< standard deviation of the logarithm
  double expected_beta_sd = 0.3;
};

/// Options for presses by the robot itself: depth from joint angles is precise, but on a compliant
/// torso that breathes by 3 mm; a scan knows the skin to 3 mm. Two presses of a second then give
/// alpha to 8 % and beta to 5 %. Tuned in simulation with other seeds than tests and tables.
[[nodiscard]] PressEstimatorOptions pressed_by_robot(double torso_n_per_m,
                                                     double tool_mass_kg) noexcept;
/// The same on a person of whom nothing is known, around the torso that is taken for granted: they
/// yield by 10 to 35 N/mm (docs/tissue.md).
[[nodiscard]] inline PressEstimatorOptions on_unknown_torso(PressEstimatorOptions options) {
  options.torso_sd = 0.35;  // of the logarithm: 95 % within a half and twice of it
  return options;
}
/// The same for presses of one person that are only compared with each other: the torso is alike in
/// all of them, so an error of it is no reason to know a change less well.
[[nodiscard]] inline PressEstimatorOptions on_same_torso(PressEstimatorOptions options) {
  options.torso_sd = 0.0;
  return options;
}

/// Recursive estimator of alpha and beta in F = alpha tan(beta x) from one person's presses.
///
/// It uses the inverse law, position = skin + breath + F / torso + atan(F / alpha) / beta, which
/// has no pole and is linear in everything that moves. The segments of the last presses are
/// filtered repeatedly, each pass linearised at the newest alpha and beta (Gauss-Newton with the
/// breath integrated out); old segments are marginalised into the prior. A tick processes at most
/// two segments, so all ticks cost about the same. No heap, no exceptions; the result is finite and
/// positive for any input.
class PressEstimator {
 public:
  /// What it knows beforehand of sensor, person and arm.
  using Options = PressEstimatorOptions;
  /// Before the first sample.
  explicit PressEstimator(const Options& options = {}) noexcept;

  /// Adds one sample: position along the inward normal (larger is deeper, the skin near zero) and
  /// force onto the person. Times increase, with any origin.
  void update(double time_s, const Press& sample) noexcept;

  /// As of the last sample.
  [[nodiscard]] const TissueEstimate& estimate() const noexcept { return estimate_; }

  /// Normalised innovation squared: about 1 if the tangent law describes the tissue, above
  /// `max_nis` if not.
  [[nodiscard]] double nis() const noexcept { return nis_; }
  [[nodiscard]] double damping_s_per_m() const noexcept { return state_(mu); }
  [[nodiscard]] double tare_n() const noexcept { return segments_.tare_n(); }
  [[nodiscard]] double peak_force_n() const noexcept { return segments_.peak_force_n(); }

  /// Tangent stiffness dF/dx of the tissue at a force: the best-known output.
  [[nodiscard]] double stiffness_n_per_m(double force_n) const noexcept;
  /// Relative standard deviation of that stiffness.
  [[nodiscard]] double stiffness_sd(double force_n) const noexcept;

  /// Forgets the person but not the options, for the next acupoint.
  void reset() noexcept;

 private:
  // `offset`: sensor offset left after taring. `breath`, `breath_speed`: damped oscillator driven
  // by noise. `skin`: slow random walk.
  enum Index { log_alpha, log_beta, mu, compliance, offset, skin, breath, breath_speed, states };
  using State = Eigen::Matrix<double, states, 1>;
  using Covariance = Eigen::Matrix<double, states, states>;
  struct Belief {
    State mean;
    Covariance covariance;
    double time_s;
  };

  void begin_pass() noexcept;
  void predict(double time_s) noexcept;
  void update_from(const PressSegment& segment) noexcept;
  void update_from_air(const PressSegment& air) noexcept;
  void fuse(const State& H, double innovation, double R) noexcept;
  void record_skin(std::size_t i) noexcept;
  void finish_pass() noexcept;
  void publish() noexcept;

  PressEstimatorOptions options_;
  PressSegments segments_;
  Belief prior_;   // information of the segments before the window
  Belief pass_;    // state of the running pass
  Belief middle_;  // state of the pass at the middle of the window
  State state_;    // result of the last pass, linearisation point of the next
  Covariance covariance_;
  double alpha_ = 0.0, beta_ = 0.0;  // linearisation point
  double sum_nis_ = 0.0, count_ = 0.0;
  Eigen::Vector2d last_step_;  // last step of ln alpha and ln beta
  double step_limit_ = 0.0;
  bool settled_ = false;
  std::size_t next_ = 0, pass_size_ = 0;
  int idle_passes_ = 0;
  long seen_blocks_ = 0;
  double nis_ = 1.0;
  TissueEstimate estimate_;
};
static_assert(Estimator<PressEstimator>);

}  // namespace tuina::tissue
