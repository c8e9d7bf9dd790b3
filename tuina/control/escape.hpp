// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

namespace tuina::control {

/// Escape from a person who comes closer: who starts up would be through the tissue before a gentle
/// law answers, so the arm pushes itself outward until contact nearly ends.
class Escape {
 public:
  /// When it begins and how hard it pushes.
  struct Options {
    /// Excess over the expected force that means the person comes closer. It is looked for in the
    /// force as it will be after `startle_ahead_s` at its present rate: so a person who starts up
    /// is noticed sooner than by the force alone, and a cough, which rises gently, later.
    double startle_n = 16.0, startle_ahead_s = 20e-3;
    /// Least force of a person who comes closer: an arm that swings in the air feels its own mass.
    double min_felt_n = 4.0;
    double push_out_n = 100.0;  ///< outward, without damping
    /// Outward speeds of the tool up to which the push is whole, and from which on none is left: a
    /// tool that leaves as fast needs no more, and a push that ends in one tick makes gears ring.
    double full_push_m_per_s = 0.5, max_m_per_s = 1.2;
    double sensor_lag_s = 4e-3;  ///< of the force that is felt
    double kept_n = 1.0;         ///< force at which contact counts as nearly ended
    /// Way of the tool after the push before anything slows it, as far as who sits up comes.
    double flight_m = 0.2;
  };

  /// What the arm presses with by itself, pressing positive.
  struct Expected {
    double force_n = 0.0;
    double rate_n_per_s = 0.0;  ///< at which its own motion makes it rise
  };

  Escape() = default;
  /// Of the given options, at rest.
  explicit Escape(const Options& options) noexcept : options_(options) {}

  /// Begins anew with the force that is felt, in newtons.
  void begin(double force_n) noexcept;
  /// True in each tick in which the arm is to push itself out with `push_n`. The force is what is
  /// felt, in newtons, pressing positive.
  [[nodiscard]] bool step(double force_n, const Expected& expected, double dt_s) noexcept;
  /// Push of a tool that goes outward at this speed, in newtons, outward positive.
  [[nodiscard]] double push_n(double outward_m_per_s) const noexcept;

  [[nodiscard]] bool startled() const noexcept { return startled_; }  ///< since it began
  [[nodiscard]] bool over() const noexcept {
    return startled_ && !pushing_;
  }  ///< the push has ended
  [[nodiscard]] const Options& options() const noexcept { return options_; }  ///< as given

 private:
  Options options_;
  std::array<double, 3> last_forces_n_ = {};  // newest first
  bool startled_ = false, pushing_ = false;
};

}  // namespace tuina::control
