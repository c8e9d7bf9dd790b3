// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "tuina/massage/plan.hpp"
#include "tuina/tissue/depth_rules.hpp"
#include "tuina/tissue/press_estimator.hpp"

namespace tuina::session {

/// Force at which stiffness is compared between places and between visits: that of a light press,
/// enough to know most tissues.
inline constexpr double reference_force_n = 10.0;

/// The estimator of every session; another `tissue::SteeringEstimator` is plugged in here.
using SessionEstimator = tissue::PressEstimator;

/// One decision that the felt tissue led to, for the record. The rules are those of
/// tissue/depth_rules.hpp.
struct Decision {
  double time_s = 0.0;
  Arm arm = Arm::left;
  int path = 0;
  const char* rule = "";    ///< "A3"
  const char* reason = "";  ///< a sentence for people
  double from_n = 0.0;      ///< force before
  double to_n = 0.0;        ///< force after
};

/// Lets what the presses feel decide how hard they may be: probing presses first, a cap from the
/// estimate, less on a thin layer over bone, letting go when the person tenses, and no longer at a
/// place than it helps. It only lowers what the plan and its zones allow, but for the fifth that a
/// hard place gets. Real-time after construction.
class Steering {
 public:
  Steering(const massage::Plan& plan, const tissue::PressEstimatorOptions& presses, bool on);

  /// An arm goes down for a path: in the air the estimators learn the zero of the force sensor.
  void begin(Arm arm, int path, double time_s) noexcept;
  /// It has touched the skin.
  void touch(Arm arm, double time_s) noexcept {
    sides_[arm].probe_s = sides_[arm].touched_s = time_s;
  }
  /// The contact is over; what it has felt is kept for the place.
  void end(Arm arm) noexcept;
  /// One sample, in contact; `depth_m` beneath the believed skin.
  void feel(Arm arm, double time_s, const Press& press) noexcept;

  /// While a new place is probed: the force for it. Nothing when it is known well enough.
  [[nodiscard]] bool probing(Arm arm) const noexcept { return sides_[arm].probing; }
  [[nodiscard]] double probe_force_n(Arm arm, double time_s) noexcept;
  /// Force in place of a planned one.
  [[nodiscard]] double steered_n(Arm arm, double planned_n) const noexcept;
  /// The person tenses or has moved: the path should end.
  [[nodiscard]] bool alarmed(Arm arm) const noexcept { return sides_[arm].alarmed; }
  /// More presses here would not help: the path is done.
  [[nodiscard]] bool worked_enough(Arm arm) const noexcept { return sides_[arm].worked_enough; }
  /// Tissue as estimated from this contact so far.
  [[nodiscard]] const TissueEstimate& estimate(Arm arm) const noexcept {
    return sides_[arm].whole.estimate();
  }
  [[nodiscard]] double nis(Arm arm) const noexcept { return sides_[arm].whole.nis(); }
  [[nodiscard]] double stiffness_sd(Arm arm) const noexcept {
    return sides_[arm].whole.stiffness_sd(reference_force_n);
  }
  [[nodiscard]] const std::vector<Decision>& decisions() const noexcept { return decisions_; }

 private:
  static constexpr std::size_t max_sets = 8;  // of six presses; a path has twenty presses at most
  struct Place {
    bool felt = false;
    TissueEstimate estimate = {};
    double nis = 1.0;
  };
  struct Side {
    explicit Side(const tissue::PressEstimatorOptions& options)
        : whole(options), last(options), set(options) {}
    /// All presses of this contact, the last one alone, and those since the last set was complete.
    SessionEstimator whole, last, set;
    std::array<tissue::PressSet, max_sets> sets = {};
    std::size_t sets_felt = 0;
    int set_presses = 0;
    double touched_s = 0.0;
    int path = -1;
    bool presses = false, probing = false, alarmed = false, known = false;
    bool worked_enough = false;
    double probe_s = 0.0, peak_n = 0.0;
    double reference_n = 0.0;  ///< strongest force of the path as planned
    double cap_n = 0.0, scale = 1.0;
    int compared = 0;  ///< presses that have been compared with the first ones
    TissueEstimate reference = {};
    bool elsewhen =
        false;  ///< true when the reference is of an earlier contact, with the skin elsewhere
  };

  void judge(Arm arm, double time_s) noexcept;
  void watch(Arm arm, double time_s) noexcept;
  void begin_sets(Side& side) noexcept;
  void count_press(Arm arm, double time_s) noexcept;
  void decide(Arm arm, double time_s, const char* rule, const char* reason, double from_n,
              double to_n) noexcept;

  bool on_;
  PerArm<Side> sides_;
  std::vector<massage::PlannedPath> paths_;  // names and caps only
  std::vector<double> strongest_n_;
  std::vector<int> place_of_path_;
  std::vector<Place> places_;
  std::vector<double> betas_;  // of the places felt, for their median
  double sum_log_stiffness_ = 0.0;
  std::vector<Decision> decisions_;
};

}  // namespace tuina::session
