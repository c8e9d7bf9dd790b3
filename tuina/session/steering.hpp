// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "tuina/massage/plan.hpp"
#include "tuina/massage/technique/contact_path.hpp"
#include "tuina/session/earlier/known_tissue.hpp"
#include "tuina/tissue/creep_estimator.hpp"
#include "tuina/tissue/depth_rules.hpp"
#include "tuina/tissue/press_estimator.hpp"

namespace tuina::session {

/// Force at which stiffness is compared between places and between visits: that of a light press,
/// enough to know most tissues.
inline constexpr double reference_force_n = 10.0;

/// The estimator that decides forces in every session; another `tissue::SteeringEstimator` is
/// plugged in here.
using SessionEstimator = tissue::CreepEstimator;
static_assert(tissue::SteeringEstimator<SessionEstimator>);
/// The estimator that compares a press with others; another estimator of the tangent law alone is
/// plugged in here.
using ElasticEstimator = tissue::PressEstimator;

/// One decision that the felt tissue led to, for the record. The rules are those of
/// tissue/depth_rules.hpp.
struct Decision {
  double time_s = 0.0;
  Arm arm = Arm::left;
  int path = 0;
  const char* rule = "";    ///< "A2"
  const char* reason = "";  ///< a sentence for people
  const char* key = "";     ///< of that sentence, for who says it in another language
  double from_n = 0.0;      ///< force before
  double to_n = 0.0;        ///< force after
};

/// What a decision rests on: as in `Decision`.
struct Reason {
  const char* rule;
  const char* key;
  const char* words;
};

/// Lets what the presses feel decide how hard the next one may be: probing presses first, no jump
/// to a force that the felt tissue does not foretell, letting go when the person tenses, and no
/// longer at a place than it helps. It only lowers what the plan and its zones allow, and says so.
/// Real-time after construction.
class Steering {
 public:
  /// What the steering may do.
  struct Options {
    tissue::PressEstimatorOptions presses;
    bool on = true;        ///< false: the plan is left as it is
    bool cautious = true;  ///< A2; false only to see what it is good for
    /// Places that an earlier session has felt: one probing press that comes as known will do.
    std::vector<KnownPlace> known = {};
  };
  /// Takes all the memory that a plan needs.
  Steering(const massage::Plan& plan, const Options& options);

  /// An arm goes down for a path: in the air the estimators learn the zero of the force sensor.
  void begin(Arm arm, int path, double time_s) noexcept;
  /// It has touched the skin.
  void touch(Arm arm, double time_s) noexcept {
    sides_[arm].probe_s = sides_[arm].touched_s = time_s;
  }
  /// So long the tool stands in a pause; that is no part of a probing press.
  void stand_still(Arm arm, double lasting_s) noexcept { sides_[arm].probe_s += lasting_s; }
  /// The contact is over; what it has felt is kept for the place.
  void end(Arm arm) noexcept;
  /// One sample of an approach or a contact: depth beneath the believed skin, negative above it,
  /// and force onto the person. `commanded_n` is what the arm was to press with: more than that is
  /// a person who pushes, or a sensor that errs, and nothing that the place is known to bear.
  void feel(Arm arm, double time_s, const Press& press, double commanded_n) noexcept;
  /// Share of the planned forces that is wished for now; the wished ones are judged.
  void scale(double intensity) noexcept {
    intensity_ = intensity;
    for (Side& side : sides_.of) {
      if (side.path >= 0)
        side.reference_n = intensity * strongest_n_[static_cast<std::size_t>(side.path)];
    }
  }

  /// While a new place is probed, `probe_force_n` is the force for it.
  [[nodiscard]] bool probing(Arm arm) const noexcept { return sides_[arm].probing; }
  /// Whether the presses of this contact foretell one as strong as the strongest of the path.
  [[nodiscard]] bool well_foretold(Arm arm) const noexcept {
    return sides_[arm].foretold == tissue::Foretold::well;
  }
  /// By how much it is expected to bring the tool deeper.
  [[nodiscard]] double deepening_m(Arm arm) const noexcept { return sides_[arm].deepening_m; }
  /// Tissue of an earlier session, while this contact relies on it; null otherwise.
  [[nodiscard]] const TangentTissue* known(Arm arm) const noexcept {
    return sides_[arm].relies ? &sides_[arm].known : nullptr;
  }
  /// Force for the place that is probed, at this time.
  [[nodiscard]] double probe_force_n(Arm arm, double time_s) noexcept;
  /// Force in place of a planned one.
  [[nodiscard]] double steered_n(Arm arm, double planned_n) const noexcept;
  /// Limit of every force here, whatever is wished for: that of the probing press, or of the rules.
  [[nodiscard]] double max_n(Arm arm) const noexcept {
    const Side& side = sides_[arm];
    return side.probing ? std::max(side.peak_n, massage::kept_force_n) : side.cap_n;
  }
  /// The person tenses or has moved: the path should end.
  [[nodiscard]] bool alarmed(Arm arm) const noexcept { return sides_[arm].alarmed; }
  /// More presses here would not help: the path is done.
  [[nodiscard]] bool worked_enough(Arm arm) const noexcept { return sides_[arm].worked_enough; }
  /// Tissue as estimated from this contact so far.
  [[nodiscard]] const TissueEstimate& estimate(Arm arm) const noexcept {
    return sides_[arm].whole.estimate();
  }
  /// Misfit of the tissue model in this contact; about 1 is good.
  [[nodiscard]] double nis(Arm arm) const noexcept { return sides_[arm].whole.nis(); }
  /// Relative error of the stiffness at `reference_force_n`.
  [[nodiscard]] double stiffness_sd(Arm arm) const noexcept {
    return sides_[arm].whole.stiffness_sd(reference_force_n);
  }
  /// What was changed, in the order of time.
  [[nodiscard]] const std::vector<Decision>& decisions() const noexcept { return decisions_; }

 private:
  static constexpr std::size_t max_sets = 8;  // of six presses; a path has twenty presses at most
  struct Place {
    bool felt = false;
    double strongest_n = 0.0;      // force that it has felt
    TissueEstimate estimate = {};  // as it was felt last
    double nis = 1.0;
    TissueEstimate reference = {};  // what a later visit is compared with
    double reference_nis = 1.0;
    bool relies = false;  // on an earlier session
    TangentTissue known = {};
    double known_sd = 0.0;
  };
  struct Side {
    explicit Side(const tissue::PressEstimatorOptions& options)
        : whole(tissue::on_unknown_torso(options)),
          elastic(tissue::on_same_torso(options)),
          last(tissue::on_same_torso(options)),
          set(tissue::on_same_torso(options)) {}
    /// All presses of this contact.
    SessionEstimator whole;
    /// By the tangent law alone, which compares like with like: all presses of this contact, the
    /// last one, and those since the last set was complete.
    ElasticEstimator elastic, last, set;
    std::array<tissue::PressSet, max_sets> sets = {};
    std::size_t sets_felt = 0;
    int set_presses = 0;
    double touched_s = 0.0;
    int path = -1;
    bool presses = false, probing = false, alarmed = false, worked_enough = false;
    bool relies = false, came_as_known = false;
    TangentTissue known = {};
    double known_sd = 0.0;
    double probe_s = 0.0;  ///< when probing began, later by all pauses since
    double peak_n = 0.0;
    int probes = 0;            ///< probing presses that are over
    double reference_n = 0.0;  ///< strongest force of the path as planned
    double strongest_n = 0.0;  ///< that the place has felt
    double cap_n = 0.0;
    /// Of a press as strong as the strongest of the path, as of the end of the last press.
    tissue::Foretold foretold = tissue::Foretold::loosely;
    double deepening_m = 0.0;
    TissueEstimate reference = {};
    double reference_nis = 1.0;
    /// The reference is of an earlier contact, so its `contact_m` says nothing of the skin now.
    bool reference_is_earlier = false;
  };

  void judge(Arm arm, double time_s) noexcept;
  void foretell(Side& side) noexcept;
  void compare_with_known(Arm arm, double time_s) noexcept;
  [[nodiscard]] bool bone_by_spine(const Side& side) const noexcept;
  void lower(Side& side, Arm arm, double time_s, double cap_n, Reason reason) noexcept;
  void take_reference(Side& side) noexcept;
  void watch(Arm arm, double time_s) noexcept;
  void begin_sets(Side& side) noexcept;
  void count_press(Arm arm, double time_s) noexcept;
  void decide(Arm arm, double time_s, Reason reason, double from_n, double to_n) noexcept;

  Options options_;
  PerArm<Side> sides_;
  std::vector<massage::PlannedPath> paths_;  // names and caps only
  std::vector<double> strongest_n_;
  double intensity_ = 1.0;
  std::vector<int> place_of_path_;
  std::vector<Place> places_;
  std::vector<Decision> decisions_;
};

}  // namespace tuina::session
