// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "tuina/massage/plan.hpp"
#include "tuina/session/massage_step.hpp"
#include "tuina/sim/robot/back_contact.hpp"

namespace tuina::app {

/// Mean of a force while all of it is asked for.
class HeldForce {
 public:
  void add(double asked_n, double force_n) noexcept;
  [[nodiscard]] double mean_n() const noexcept { return samples_ > 0 ? sum_n_ / samples_ : 0.0; }
  [[nodiscard]] double asked_n() const noexcept { return asked_n_; }  ///< the largest

 private:
  double asked_n_ = 0.0, since_n_ = 0.0, sum_n_ = 0.0, samples_ = 0.0;
};

/// How much deeper one press brought the tool, and what that says of a depth which was told before.
class TrueDeepening {
 public:
  TrueDeepening() = default;
  /// Before the press: how far the tool is below the resting skin.
  explicit TrueDeepening(double travel_m) noexcept : from_m_(travel_m) {}
  /// One millisecond of it; `whole_n` is all of its force.
  void add(double whole_n, double force_n, double travel_m) noexcept;
  /// By how much more than `whole_n` is met at the depth that was told for it, as a share; none
  /// where the press never had all of its force.
  [[nodiscard]] std::optional<double> error(double told_m) const noexcept;

 private:
  double from_m_ = 0.0;
  std::optional<double> part_m_, whole_m_;  // as the force first passed a part of it, and all
  double sum_m_ = 0.0, sum_share_ = 0.0, samples_ = 0.0;  // while all of it was there
};

/// One press or tap as it was given, by the true force.
struct GivenPress {
  std::string place;  ///< acupoint
  Technique technique = Technique::press;
  int index = 0;  ///< of this technique at this place in the session, from 1, probes included
  bool probing = false;         ///< it only felt a new place
  bool foretold = false;        ///< what was felt before foretold one as strong as planned
  bool foretold_wrong = false;  ///< at the depth that was told the force is beyond what was said
  double planned_n = 0.0;       ///< strongest force of its path in the plan
  double asked_n = 0.0;         ///< largest force that was asked for
  double peak_n = 0.0;          ///< largest true force
  double held_n = 0.0;          ///< mean true force while all of it was asked for
  Arm arm = Arm::left;
  double contact_s = 0.0, end_s = 0.0;  ///< from when the tool was on the skin, until it was over

  /// Largest true force as a share of the plan.
  [[nodiscard]] double given() const { return peak_n / planned_n; }
};

/// Tells presses apart by the force that is asked for: one begins as that rises above the light
/// touch, and is over as it is back there.
class GivenPresses {
 public:
  /// One millisecond of one arm; `plan` is the plan that it carries out.
  void add(double time_s, Arm arm, const session::ArmView& seen, const sim::ContactTruth& truth,
           const massage::Plan& plan);
  [[nodiscard]] std::vector<GivenPress> take() { return std::move(done_); }

 private:
  struct Side {
    bool in_contact = false, open = false;
    GivenPress press = {};
    HeldForce held = {};
    TrueDeepening deepening;
    double told_m = 0.0, contact_s = 0.0;
  };
  void close(Side& side, double time_s);

  PerArm<Side> sides_ = {};
  std::map<std::pair<std::string, Technique>, int> count_;
  std::vector<GivenPress> done_;
};

}  // namespace tuina::app
