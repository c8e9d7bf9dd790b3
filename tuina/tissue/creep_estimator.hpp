// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <limits>

#include "tuina/core/contact.hpp"
#include "tuina/tissue/creep_filter.hpp"
#include "tuina/tissue/estimator.hpp"

namespace tuina::tissue {

/// Recursive estimator for tissue that need not follow the tangent law: it learns relaxation, what
/// gives way beneath and damping with alpha and beta, and foretells the force of the next press.
///
/// Several filters of the creep law with different assumptions run side by side, each weighted by
/// its evidence. alpha and beta are those of the first loading at 10 mm/s. `converged` is said of
/// the force that will be met: at the strongest force so far the 95 % half-width of a next press is
/// at most 15 %, the last press kept to what was told within two standard deviations, the law
/// describes what is felt, and that comes twenty times a second or more. No heap, no exceptions.
class CreepEstimator {
 public:
  /// The same as the press estimator takes.
  using Options = PressEstimatorOptions;
  static constexpr std::size_t filters = 10;

  /// Before the first sample.
  explicit CreepEstimator(const Options& options = {}) noexcept;

  /// Adds one sample: position along the inward normal (larger is deeper, the skin near zero) and
  /// force onto the person. Times increase, with any origin.
  void update(double time_s, const Press& sample) noexcept;
  /// Ends the newest segment and passes the window until the parameters rest: for callers that may
  /// wait some milliseconds.
  void settle() noexcept;

  /// What is believed of the tissue.
  [[nodiscard]] const TissueEstimate& estimate() const noexcept { return estimate_; }
  /// Normalised innovation squared: about 1 if the law describes the tissue, above `max_nis` if
  /// not.
  [[nodiscard]] double nis() const noexcept { return nis_; }
  /// Relative standard deviation of the tangent stiffness at a force.
  [[nodiscard]] double stiffness_sd(double force_n) const noexcept;
  /// Covariance of ln alpha and ln beta for who compares them with another time. It lacks what no
  /// tangent describes, which is in the intervals: that is the same each time.
  [[nodiscard]] const Eigen::Matrix2d& covariance() const noexcept {
    return comparable_covariance_;
  }
  /// How much wider than the filters say bands are, by how well earlier presses were foretold.
  [[nodiscard]] double widening() const noexcept;
  /// Half-width of the 95 % band of the force that a next press meets at the depth which it needs
  /// for `force_n`, as a share of that force; infinite before the first press is over. The skin is
  /// found as the press begins. Unless the tool follows the skin, its breath until then counts too.
  [[nodiscard]] double force_half_width(double force_n) const noexcept {
    return next_press(force_n).half_width;
  }
  /// By how much that press is expected to bring the tool deeper than where it begins, as it first
  /// has its force.
  [[nodiscard]] double deepening_m(double force_n) const noexcept {
    return next_press(force_n).deeper_m;
  }
  /// True when the last press was foretold and came otherwise, by more than two standard
  /// deviations.
  [[nodiscard]] bool surprised() const noexcept { return seen_presses_ >= 2 && !as_told_; }
  /// True where most samples lie more than 50 ms apart: nothing converges then.
  [[nodiscard]] bool too_slow() const noexcept { return segments_.too_slow(); }
  /// False where neither free air before the first contact nor the caller tells the zero of the
  /// force: nothing converges then.
  [[nodiscard]] bool zero_known() const noexcept;
  /// False where the skin was found further from 0 than five standard deviations of what the caller
  /// knows of it: nothing converges then.
  [[nodiscard]] bool skin_as_told() const noexcept;
  /// Forgets the person but not the options.
  void reset() noexcept;
  /// Keeps of the presses so far what people have much alike all over, such as how their tissue
  /// relaxes and is layered, for the places that follow.
  void keep_person() noexcept;
  /// Another place: forgets this one. What was kept of the person is expected there, less surely.
  void next_place() noexcept;

  /// What is believed at one time, carried on without further forces.
  struct Outlook {
    std::array<CreepFilter::Belief, filters> beliefs;
    std::array<double, filters> weights = {};
    std::array<Memory, filters> memory_n = {};
    double time_s = 0.0;
  };
  /// What is believed now, to be carried on by `foretell`.
  [[nodiscard]] Outlook outlook() const noexcept;
  /// A foretold force and its 95 % band.
  struct ForceBand {
    double force_n = 0.0, low_n = 0.0, high_n = 0.0;  ///< 95 % lie between low and high
  };
  /// The reading of the force sensor at a later time, place and speed of the tool; the outlook
  /// remembers it.
  [[nodiscard]] ForceBand foretell(Outlook& outlook, double time_s, double position_m,
                                   double speed_m_per_s) const noexcept;

 private:
  void follow() noexcept;
  void watch_press(const PressSegment& segment) noexcept;
  void judge_press() noexcept;
  void begin_pass() noexcept;
  void pass(std::size_t turns) noexcept;
  void finish_pass() noexcept;
  void weigh() noexcept;
  void decide_convergence() noexcept;
  void publish() noexcept;
  struct NextPress {
    double deeper_m = 0.0, half_width = std::numeric_limits<double>::infinity();
  };
  [[nodiscard]] NextPress next_press(double force_n) const noexcept;
  /// The tangent of the first loading up to that share of the strongest force.
  [[nodiscard]] TangentTissue loading_of(const CreepFilter::State& state,
                                         double force_share = 1.0) const noexcept;

  Options options_;
  PressSegments segments_;
  std::array<CreepFilter, filters> unpressed_;  // of this person, before the first press
  std::array<CreepFilter, filters> filters_;
  std::array<double, filters> weights_ = {};
  std::size_t leader_ = 0;
  std::size_t followed_ = 0;  // segments that every filter has seen
  std::size_t next_ = 0;      // of the running pass
  bool passing_ = false, middle_kept_ = false;

  Outlook onset_;   // what was believed as the press of now began
  int press_ = -1;  // its number
  bool pressing_ = false;
  double press_over_s_ = 0.0;  // as the press before was over
  PressSegment rests_, peak_;  // of it: the last before the force rises, the first with all of it
  PressSegment rests_before_, strongest_;  // of the strongest press
  int seen_presses_ = 0;
  bool as_told_ = false;                  // the last press, within two standard deviations
  double surprise_ = 0.0, judged_ = 0.0;  // sum of squared normalised errors, and their number
  double kept_surprise_ = 0.0, kept_judged_ = 0.0;  // of the places before

  double nis_ = 1.0, published_s_ = 0.0;
  // Of ln alpha and ln beta of the first loading; as wide as their intervals, and for comparing.
  Eigen::Matrix2d loading_covariance_, comparable_covariance_;
  TissueEstimate estimate_;
};
static_assert(SteeringEstimator<CreepEstimator>);

}  // namespace tuina::tissue
