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
    /// Force above the expected one that means the person comes closer, where the present rise
    /// leads in this time: who starts up presses sooner, and who coughs more gently, than a force
    /// tells.
    double startle_n = 16.0, startle_ahead_s = 20e-3;
    double push_out_n = 100.0;   ///< outward, without damping
    double sensor_lag_s = 4e-3;  ///< of the force that is felt
    double kept_n = 1.0;         ///< force at which contact counts as nearly ended
  };

  Escape() = default;
  /// Of the given options, at rest.
  explicit Escape(const Options& options) noexcept : options_(options) {}

  /// Begins anew with the force that is felt, in newtons.
  void begin(double force_n) noexcept;
  /// True in each tick in which the arm is to push itself out with `push_out_n`. Of the force that
  /// is felt, `expected_n` is what the arm presses with by itself; both in newtons, pressing
  /// positive.
  [[nodiscard]] bool step(double force_n, double expected_n, double dt_s) noexcept;

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
